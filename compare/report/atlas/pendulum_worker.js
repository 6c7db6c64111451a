// Solve a pendulum, judge files by it and print it, in a worker, so that the page can be used meanwhile. Needs solving.js,
// describing.js and answering.js.
"use strict";

if (typeof WorkerGlobalScope !== "undefined") {
  let solution = null;

  const sent = ({ starts, states, order }) => ({ starts, states, order });

  function begun({ texts, fields }) {
    try {
      const { steps, facts } = firstSwings(sceneOf(texts, fields));
      return { facts, steps: sent(steps) };
    } catch (error) {
      if (!(error instanceof Unsolvable)) throw error;
      return { refused: error.message };
    }
  }

  function solved({ texts, fields, words }, report) {
    try {
      solution = solve(sceneOf(texts, fields), words, report);
    } catch (error) {
      if (!(error instanceof Unsolvable)) throw error;
      return { refused: error.message };
    }
    return { facts: solution.facts, steps: sent(solution.steps) };
  }

  const judged = async ({ files, tolerance }) => answerBy(solution, await textsOf(files), tolerance);

  const printed = ({ step }) => csvOf(solution, step);

  serve({ begin: begun, solve: solved, judge: judged, print: printed });
}
