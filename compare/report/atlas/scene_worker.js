// Judge files by the golden data of a scene, in a worker, so that the page can be used meanwhile. Needs answering.js.
"use strict";

if (typeof WorkerGlobalScope !== "undefined") {
  let truth = null;

  function know({ data, goldenFunction }) {
    truth = unpacked(data, goldenFunction);
  }

  const judge = async ({ files, tolerance }) => answer(await textsOf(files), tolerance, truth);

  serve({ know, judge });
}
