// How far the bob of a pendulum is off if its equations leave something out. Each such model is integrated by the
// classical Runge-Kutta method, and so are the full equations: most errors of the steps cancel. Needs integrating.js and
// the functions of emitted.py.
"use strict";

const STEPS_A_SWING = 50;
const MOST_SWINGS = 1000; // of a longer run, the first

// The rates of [n, v] by the forces of a model: its constants, and the tension of the cord where the angle counts as small.
function ratesOf({ turnNorth, turnUp, pull, drag, centrifugal, tension }) {
  return ([x, y, z, vx, vy, vz]) => {
    const n = [x, y, tension ? -1 : z];
    const v = [vx, vy, tension ? 0 : vz];
    const force = forceOn(...n, ...v, turnNorth, turnUp, ...pull, drag, ...centrifugal);
    const along = tension ?? dot(v, v) + dot(n, force);
    const rates = force.map((value, i) => value - along * n[i]);
    return tension ? [vx, vy, 0, rates[0], rates[1], 0] : [...v, ...rates];
  };
}

function stepBy(rates, state, step) {
  const moved = (slope, part) => state.map((value, i) => value + part * step * slope[i]);
  const first = rates(state);
  const second = rates(moved(first, 0.5));
  const third = rates(moved(second, 0.5));
  const fourth = rates(moved(third, 1));
  return state.map((value, i) => value + (step / 6) * (first[i] + 2 * second[i] + 2 * third[i] + fourth[i]));
}

// The largest distance in m, seen from above, of each model from the full equations, by its name: {until in s, sizes}; null
// if the swing is wide, or there is no gravity.
function leftOut(scene, wide, lastTime) {
  const { length, unit, swing, start, velocity, constants } = problemOf(scene);
  if (wide || !swing) return null;
  const swings = Math.min(MOST_SWINGS, (swing * lastTime) / (2 * Math.PI));
  const until = swings < MOST_SWINGS ? lastTime : Number(((2 * Math.PI * swings) / swing).toPrecision(3));
  const count = Math.ceil(STEPS_A_SWING * swings);
  const end = until / unit;

  const [turnNorth, turnUp, pullNorth, pullUp, drag = 0] = constants;
  const centrifugal = centrifugalProducts(Math.hypot(turnNorth, turnUp), turnNorth, turnUp);
  const full = { turnNorth, turnUp, pull: [pullNorth, pullUp], drag, centrifugal };
  const models = {
    sphere: { ...full, tension: -pullUp },
    coriolis: { ...full, turnNorth: 0 },
    centrifugal: { ...full, centrifugal: [0, 0, 0, 0] },
  };
  const runs = Object.values(models).map((model) => ({ rates: ratesOf(model), state: [...start.slice(0, 3), ...velocity], farthest: 0 }));
  const rates = ratesOf(full);
  let state = [...start.slice(0, 3), ...velocity];
  for (let i = 0; i < count; i += 1) {
    state = stepBy(rates, state, end / count);
    for (const run of runs) {
      run.state = stepBy(run.rates, run.state, end / count);
      run.farthest = Math.max(run.farthest, Math.hypot(run.state[0] - state[0], run.state[1] - state[1]));
    }
  }
  const sizes = Object.fromEntries(Object.keys(models).map((name, i) => [name, length * runs[i].farthest]));
  return { until, sizes };
}
