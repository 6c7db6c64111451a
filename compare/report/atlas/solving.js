// Solve a pendulum twice and make of it what judging.js takes for the truth; the difference of the runs estimates the
// error. Needs integrating.js, leaving.js, swinging.js, answering.js and
// claims.js. Pure functions, without the page.
"use strict";

const FIRST = { order: 20, truncation: 2 ** -50, moved: 0 };
const SECOND = { order: 24, truncation: 2 ** -54, moved: 1 }; // other steps; constants moved by a unit in the last place
const SAMPLES = 1000; // times at which the two runs are compared
const FIRST_SWINGS = 10; // that are shown before the whole run is there
const MOST_ROWS = 20_000; // of the grid that shows how far the bob swings

// One run: its steps, the function of its motion, its transits and the zeros of its rate of falling.
function runOf(scene, { order, truncation, moved }, report) {
  const problem = problemOf(scene, moved);
  const transits = zerosOf(rateOfX, zeroAtRelease(problem));
  const falls = zerosOf(rateOfFall(problem), zeroOfFall(problem));
  const step = (...of) => {
    transits.step(...of);
    falls.step(...of);
  };
  const steps = integrate(problem, order, truncation, { step, report });
  transits.end();
  falls.end();
  return { problem, steps, at: motionOf(steps), transits: transits.zeros, falls: falls.zeros };
}

// How far the bob gets: {amplitude, wide, fastest}, by the rows of a motion.
function reachOf({ x, y, z, vx, vy, vz }, length) {
  const most = (values) => values.reduce((best, value) => Math.max(best, value), 0);
  return {
    amplitude: most(x.map((value, i) => Math.hypot(value, y[i]))) || length,
    wide: z.some((height) => height > -0.7 * length),
    fastest: most(vx.map((value, i) => Math.hypot(value, vy[i], vz[i]))),
  };
}

// The first swings of a scene, which are there at once: its steps, and what a player needs to know.
function firstSwings(scene) {
  const { swing, length } = problemOf(scene);
  const end = Math.min(scene.run.t_end, (FIRST_SWINGS * 2 * Math.PI) / swing);
  const problem = problemOf({ ...scene, run: { ...scene.run, t_end: end } });
  const steps = integrate(problem, FIRST.order, FIRST.truncation);
  return { steps, facts: { end, ...reachOf(gridOf(motionOf(steps), end, end / 1000), length) } };
}

// The estimated error of the position in m, as a function of the time; it never decreases. Besides the difference of the
// two runs it has what the roundings of the steps may add up to, which both may have in the same direction.
function errorOf(first, second, end) {
  const { length, swing, unit } = first.problem;
  const rounding = (time) => ULP * length * (4 + Math.sqrt(lastBefore(first.steps.starts, time / unit)));
  const errors = [rounding(0)];
  for (let i = 1; i <= SAMPLES; i += 1) {
    const time = (end * i) / SAMPLES;
    const state = first.at(time);
    const otherState = second.at(time);
    const gaps = state.map((value, k) => value - otherState[k]);
    const phase = swing ? norm(gaps.slice(3)) / swing : 0; // of a bob at its highest point
    const gap = norm(gaps.slice(0, 3)) + phase;
    errors.push(Math.max(errors[i - 1], rounding(time) + CAUTION * gap));
  }
  return (time) => errors[Math.min(Math.ceil((SAMPLES * time) / end), SAMPLES)];
}

// The time up to which the error is at most so large.
function knownUntil(error, end, allowed) {
  let count = SAMPLES;
  while (count > 0 && error((end * count) / SAMPLES) > allowed) count -= 1;
  return (end * count) / SAMPLES;
}

// Rows of a motion at each step and at the end: {t, x, y, z, vx, vy, vz}.
function gridOf(at, end, step) {
  const count = Math.floor((end / step) * (1 + 2 ** -50));
  const t = Array.from({ length: count + 1 }, (_, i) => i * step);
  if (end - t[count] > step * 2 ** -30) t.push(end);
  else t[count] = end;
  const states = t.map(at);
  const columns = ["x", "y", "z", "vx", "vy", "vz"].map((name, k) => [name, Float64Array.from(states, (state) => state[k])]);
  return { t: Float64Array.from(t), ...Object.fromEntries(columns) };
}

// Transits with the weight |ax|/ω that turns an error of time into one of position; null if the two runs do not agree.
function transitsOf(first, second, omega) {
  const { length, unit } = first.problem;
  if (first.transits.length !== second.transits.length) return null;
  const acceleration = length / unit ** 2;
  const late = (one, other) => CAUTION * unit * Math.abs(one.time - other.time);
  return {
    t: Float64Array.from(first.transits, ({ time }) => time * unit),
    weight: Float64Array.from(first.transits, ({ slope }) => (omega ? (acceleration * Math.abs(slope)) / omega : 0)),
    error: first.transits.reduce((most, transit, i) => Math.max(most, late(transit, second.transits[i])), 0),
  };
}

// A scene's motion if its g has the other meaning, {is, at}; null if it cannot be computed.
function withOtherGravity(scene) {
  const is = MEANINGS_OF_G[scene.site.gravity_is].other;
  try {
    const problem = problemOf({ ...scene, site: { ...scene.site, gravity_is: is } });
    return { is, at: motionOf(integrate(problem, FIRST.order, FIRST.truncation)) };
  } catch (error) {
    if (error instanceof Unsolvable) return null;
    throw error;
  }
}

// The motion of a scene, whose fields are numbers. Throws Unsolvable.
function solve(scene, words, report = () => {}) {
  const end = scene.run.t_end;
  const first = runOf(scene, FIRST, (share) => report(share / 2));
  const second = runOf(scene, SECOND, (share) => report((1 + share) / 2));
  const error = errorOf(first, second, end);
  const grid = gridOf(first.at, end, Math.max(scene.run.grid_step, end / MOST_ROWS));

  const { length, swing, unit, constants } = first.problem;
  const { amplitude, wide, fastest } = reachOf(grid, length);
  const omega = Math.max(swing, fastest / length);
  const tilt = tiltOf(constants);
  const until = knownUntil(error, end, words.TOLERANCE * amplitude);
  const transits = until < end ? null : transitsOf(first, second, omega);
  let other;
  const otherGravity = () => {
    if (other === undefined) other = withOtherGravity(scene); // null if it cannot be solved
    return other;
  };
  return {
    scene,
    steps: first.steps,
    at: first.at,
    error,
    facts: {
      ...(until < end ? { ...NO_SWING, reason: words.REASONS.UNDECIDED } : swingFacts(first, second, words.REASONS)),
      error: error(end),
      until,
      end,
      amplitude,
      wide,
      pull: (Math.hypot(constants[2], constants[3]) / unit ** 2) * length,
      tilt: tilt === null ? null : degrees(tilt),
      hangs: tilt === null ? null : length * Math.sin(tilt),
      transits: transits && transits.t.length,
      transitError: transits && transits.error,
    },
    truth: {
      t_end: end,
      grid_step: scene.run.grid_step,
      length_m: length,
      amplitude_m: amplitude,
      omega,
      grid,
      transits,
      no_transits: transits ? null : words.UNDECIDED_TRANSITS,
      possible: [],
      at: first.at,
      end,
      bound_m: error(end),
      axis_m: axisDistanceOf(scene),
      otherGravity,
      words,
    },
  };
}

// A motion as CSV with all digits of its doubles.
function csvOf({ at, scene }, step) {
  const rows = gridOf(at, scene.run.t_end, step);
  const names = Object.keys(rows);
  const lines = Array.from(rows.t, (_, i) => names.map((name) => String(rows[name][i])).join(","));
  return `${names.join(",")}\n${lines.join("\n")}\n`;
}

// The verdict on files by a motion; if an error stays unexplained, also how much each term of the equations matters. A
// motion whose own error exceeds the tolerance judges nothing.
function answerBy({ scene, truth, facts }, files, tolerance) {
  const result = answer(files, tolerance, truth);
  if (result.refused) return result;
  if (result.tolerance_m >= facts.error) {
    const isOpen = result.path && result.verdict === "disagrees" && !result.explained;
    return { ...result, leftOut: isOpen ? leftOut(scene, facts.wide, result.path.covered_s[1]) : null };
  }
  const accuracy = `${facts.error.toPrecision(3)} m`;
  const allowed = `${result.tolerance_m.toPrecision(3)} m`;
  const reason = `This page knows the motion to ${accuracy} only, and the tolerance is ${allowed}.`;
  return { refused: `${reason} Shorten the run, or use the command.` };
}
