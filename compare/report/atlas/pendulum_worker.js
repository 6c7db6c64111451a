// Solve a pendulum, judge files by it and print it, in a worker, so that the page can be used meanwhile. Needs solving.js,
// describing.js and answering.js.
"use strict";

if (typeof WorkerGlobalScope !== "undefined") {
  let solution = null;

  function solved({ texts, fields, words }, report) {
    try {
      solution = solve(numbersOf(texts, fields), words, report);
    } catch (error) {
      if (!(error instanceof Unsolvable)) throw error;
      return { refused: error.message };
    }
    const { starts, states, order } = solution.steps;
    return { facts: solution.facts, steps: { starts, states, order } };
  }

  const judged = async ({ files, tolerance }) => answerBy(solution, await textsOf(files), tolerance);

  const printed = ({ step }) => csvOf(solution, step);

  serve({ solve: solved, judge: judged, print: printed });
}
