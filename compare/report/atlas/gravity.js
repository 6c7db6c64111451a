// The other meaning of g: its residual in a file, by the tests of compare/diagnosis/claims.py. `truth.otherGravity`
// returns {is, at}, that meaning and the motion with it; `truth.axis_m` is the suspension's distance from the Earth's axis.
// Needs observing.js and claims.js.
"use strict";

const AXIS_DIGITS = 10; // of the distance from the Earth's axis: a millimetre

const distancesOf = (columns) => columns[0].map((_, row) => Math.hypot(...columns.map((values) => values[row])));

// What is to be said if the meaning explains the file, or the residual is a small part of the error: {text, advice, residual_m, isNamed,
// explains, helps}, where `helps` says that the residual is smaller with it; null if the page knows no motion with it.
function gravityTrial({ names, times, printed, golden, allowed, resolution }, truth) {
  const other = truth.otherGravity?.();
  if (!other) return null;
  const states = times.map((time) => other.at(Math.min(time, truth.end)));
  const errors = names.map((name) => lessThan(printed[name], golden[name]));
  const residuals = names.map((name) => {
    const place = POSITION.indexOf(name);
    return lessThan(printed[name], states.map((state) => state[place]));
  });

  const error = rootMeanSquare(distancesOf(errors));
  const distances = distancesOf(residuals);
  const residual = rootMeanSquare(distances);
  const largestResidual = farthest(distances);
  const explains = largestResidual <= allowed;
  const leavesLittle = explains || NEEDED ** 2 * residual <= error;
  const isHarmless = residuals.every((values, i) => farthest(values) <= RIVAL * Math.max(farthest(errors[i]), resolution));
  const growth = error / Math.max(residual, resolution); // factor by which the residual grows without it

  const { said, advice } = MEANINGS_OF_G[other.is];
  const hedge = growth < NEEDED ? LIKE_ONE_THAT : "";
  return {
    text: `Your program ${hedge}${said}: ${correctedTo(largestResidual, allowed)}`,
    advice: advice.replace("{axis}", shortNumber(truth.axis_m, AXIS_DIGITS)),
    residual_m: largestResidual,
    isNamed: leavesLittle && isHarmless && growth >= RIVAL,
    explains,
    helps: growth >= RIVAL,
  };
}
