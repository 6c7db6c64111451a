// Integrate a pendulum in doubles by Taylor series of its momentum form (emitted.py). A motion is kept as the states at
// which its steps begin; the series of a step is made again when it is evaluated. Pure functions, without the page.
"use strict";

const ULP = 2 ** -52;
const MOST_STEPS = 1_500_000;
const REPORTED = 4096; // steps from one report of the progress to the next
const CAUTION = 4; // times the difference of two runs, which may be small by chance
const NO_SIGN = 2 ** -44; // of the fastest rate: a smaller rate at the release is rounding

class Unsolvable extends Error {}

// The coefficient of degree k of the product of two series.
function product(a, b, k) {
  let sum = 0;
  for (let i = 0; i <= k; i += 1) sum += a[i] * b[k - i];
  return sum;
}

// Sine and cosine of an angle in degrees, exact where they are 0 or 1.
function circle(degrees) {
  const quarter = Math.round(degrees / 90);
  const angle = ((degrees - 90 * quarter) * Math.PI) / 180;
  const sin = Math.sin(angle);
  const cos = Math.cos(angle);
  const turned = [[sin, cos], [cos, -sin], [-sin, -cos], [-cos, sin]];
  return turned[((quarter % 4) + 4) % 4].map((value) => value + 0);
}

const norm = (vector) => Math.hypot(...vector);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

// turnNorth, turnUp, pullNorth and pullUp of a scene, whose fields are numbers.
function constantsOf({ pendulum, site }) {
  const [sin, cos] = circle(site.latitude);
  const flattening = 1 / site.inverse_flattening;
  const constants = site.gravity_is === "effective" ? constantsOfEffectiveGravity : constantsOfGravityAlone;
  const { gravity, rotation_rate: rate, equatorial_radius: radius, altitude } = site;
  return constants(pendulum.length, gravity, rate, radius, flattening, altitude, sin, cos);
}

// The distance of the suspension from the Earth's axis, in m.
function axisDistanceOf({ site }) {
  const [distance] = axisDistance(site.equatorial_radius, 1 / site.inverse_flattening, site.altitude, ...circle(site.latitude));
  return distance;
}

// Position in m and velocity in m/s at t = 0: [x, y, z, vx, vy, vz].
function releaseOf({ pendulum, release }) {
  const { length } = pendulum;
  if (release.angle !== undefined) {
    const radians = (degrees = 0) => (degrees * Math.PI) / 180;
    const [angleSin, angleCos] = circle(release.angle);
    const [azimuthSin, azimuthCos] = circle(release.azimuth);
    const angleRate = radians(release.angle_rate);
    const azimuthRate = radians(release.azimuth_rate);
    return releaseAtAngles(length, angleSin, angleCos, angleRate, azimuthSin, azimuthCos, azimuthRate);
  }
  const { x, y, vx = 0, vy = 0 } = release;
  const aside = Math.hypot(x, y);
  const z = -Math.sqrt((length - aside) * (length + aside));
  return [x, y, z, vx, vy, -(x * vx + y * vy) / z];
}

// What is integrated. Lengths are divided by the cord's, and time by a unit, a power of two, in which the fastest rate is
// about 1. Each constant and the release are moved by `moved` units in the last place: the drag the other way, since a bob
// that creeps feels only the quotient of pull and drag.
function problemOf(scene, moved = 0) {
  const factor = 1 + moved * ULP;
  const { length, drag } = scene.pendulum;
  const constants = constantsOf(scene).map((value) => value * factor);
  const released = releaseOf(scene).map((value) => (value / length) * factor);
  const [turnNorth, turnUp, pullNorth, pullUp] = constants;

  const swing = Math.sqrt(Math.hypot(pullNorth, pullUp));
  const fastest = swing + norm(released.slice(3)) + Math.hypot(turnNorth, turnUp) + drag;
  const unit = fastest > 0 ? 2 ** -Math.round(Math.log2(fastest)) : scene.run.t_end;

  const n = released.slice(0, 3);
  const v = released.slice(3).map((value) => value * unit);
  const turn = [turnNorth * unit, turnUp * unit];
  const pull = [pullNorth * unit ** 2, pullUp * unit ** 2];
  const momentum = momentumOf(...n, ...v, ...turn);
  return {
    length,
    unit,
    swing,
    constants: drag ? [...turn, ...pull, (drag / factor) * unit] : [...turn, ...pull],
    fill: drag ? seriesWithDrag : seriesWithoutDrag,
    start: [...n, ...momentum],
    velocity: v,
    end: scene.run.t_end / unit,
  };
}

// The Taylor series of the six variables about a state.
function seriesAt({ fill, constants }, state, order) {
  const series = Array.from(state, (value) => [value]);
  fill(series, constants, order);
  return series;
}

const sizeOfDegree = (series, k) => series.reduce((most, coefficients) => Math.max(most, Math.abs(coefficients[k])), 0);

// The length of a step: its last two terms are this small beside the motion.
function stepOf(series, order, truncation) {
  const size = Math.max(sizeOfDegree(series, 1), sizeOfDegree(series, 2));
  if (size === 0) return Infinity; // at rest
  const lengths = [order - 1, order].map((k) => ((truncation * size) / sizeOfDegree(series, k)) ** (1 / k));
  return Math.min(...lengths);
}

function sumOf(coefficients, time) {
  let sum = 0;
  for (let k = coefficients.length - 1; k >= 0; k -= 1) sum = sum * time + coefficients[k];
  return sum;
}

function slopeOf(coefficients, time) {
  let sum = 0;
  for (let k = coefficients.length - 1; k > 0; k -= 1) sum = sum * time + k * coefficients[k];
  return sum;
}

// A state with n as a unit vector: roundings would add up to another length of the cord.
function onSphere([nx, ny, nz, ...momentum]) {
  const factor = 1.5 - dot([nx, ny, nz], [nx, ny, nz]) / 2; // 1/|n|, where |n| is about 1
  return [nx * factor, ny * factor, nz * factor, ...momentum];
}

// Rows of doubles that grow.
class Rows {
  constructor(width) {
    this.width = width;
    this.count = 0;
    this.values = new Float64Array(1024 * width);
  }

  add(row) {
    const first = this.count * this.width;
    if (first === this.values.length) {
      const larger = new Float64Array(2 * first);
      larger.set(this.values);
      this.values = larger;
    }
    this.values.set(row, first);
    this.count += 1;
  }

  all() {
    return this.values.slice(0, this.count * this.width);
  }
}

// The steps of a run: {problem, order, starts, states}. `step` is called with each step's series, start and length; it is
// all that `zerosOf` needs. Throws Unsolvable.
function integrate(problem, order, truncation, { step = () => {}, report = () => {} } = {}) {
  const { start, end, unit } = problem;
  const starts = new Rows(1);
  const states = new Rows(6);
  let state = start;
  let time = 0;
  while (time < end) {
    const series = seriesAt(problem, state, order);
    const next = Math.min(time + stepOf(series, order, truncation), end);
    if (!(next > time) || starts.count === MOST_STEPS) {
      const most = MOST_STEPS.toLocaleString("en");
      const reached = (time * unit).toPrecision(6);
      throw new Unsolvable(`The page makes at most ${most} steps, which reach t = ${reached} s of ${end * unit} s.`);
    }
    const length = next - time; // exact
    step(series, time, length);
    starts.add([time]);
    states.add(state);
    state = onSphere(series.map((coefficients) => sumOf(coefficients, length)));
    time = next;
    if (starts.count % REPORTED === 0) report(time / end);
  }
  return { problem, order, starts: starts.all(), states: states.all() };
}

// The function that returns [x, y, z, vx, vy, vz] in m and m/s at a time in s.
function motionOf({ problem, order, starts, states }) {
  const { unit, length, end } = problem;
  let place = -1;
  let series = null;
  return function at(seconds) {
    const time = Math.min(Math.max(seconds / unit, 0), end);
    const index = lastBefore(starts, time);
    if (index !== place) {
      series = seriesAt(problem, states.subarray(6 * index, 6 * index + 6), order);
      place = index;
    }
    const since = time - starts[index];
    const position = series.slice(0, 3).map((coefficients) => length * sumOf(coefficients, since));
    const velocity = series.slice(0, 3).map((coefficients) => (length / unit) * slopeOf(coefficients, since));
    return [...position, ...velocity];
  };
}

// The index of the last of some increasing numbers that is at most a value.
function lastBefore(values, value) {
  let low = 0;
  let high = values.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (values[middle] <= value) low = middle;
    else high = middle;
  }
  return low;
}

// Zeros of a polynomial.

const CUTS = [0.4871, 0.5129]; // of an interval: not in the middle, where symmetry may put a zero
const NARROWEST = 2 ** -40; // of a step: two zeros that are closer are none
const binomials = new Map();

// The factors that turn coefficients of powers into those of Bernstein's polynomials: row j has C(j, i)/C(degree, i).
function factorsOf(degree) {
  if (binomials.has(degree)) return binomials.get(degree);
  const rows = [];
  for (let j = 0; j <= degree; j += 1) {
    const row = [1];
    for (let i = 1; i <= j; i += 1) row.push((row[i - 1] * (j - i + 1)) / (degree - i + 1));
    rows.push(row);
  }
  binomials.set(degree, rows);
  return rows;
}

// The Bernstein coefficients on [0, 1] of a polynomial.
function bernsteinOf(coefficients) {
  return factorsOf(coefficients.length - 1).map((row, j) => {
    let sum = 0;
    for (let i = 0; i <= j; i += 1) sum += row[i] * coefficients[i];
    return sum;
  });
}

// The polynomial of a part of the step's length, without its first zeros at the start.
function scaled(rate, skipped, length) {
  const coefficients = [];
  let power = length ** skipped;
  for (let k = skipped; k < rate.length; k += 1) {
    coefficients.push(rate[k] * power);
    power *= length;
  }
  return coefficients;
}

const isNegative = (value) => value < 0; // zero counts as positive: a zero where two steps meet is found once

function changesOf(values) {
  let changes = 0;
  for (let i = 1; i < values.length; i += 1) if (isNegative(values[i]) !== isNegative(values[i - 1])) changes += 1;
  return changes;
}

// The two halves of Bernstein coefficients, cut at a part of the interval: de Casteljau's algorithm.
function cutAt(values, part) {
  const left = [];
  const right = [];
  let row = values;
  while (row.length) {
    left.push(row[0]);
    right.unshift(row[row.length - 1]);
    row = row.slice(1).map((value, i) => (1 - part) * row[i] + part * value);
  }
  return [left, right];
}

// The intervals [low, high] of a step, 0 to 1, that hold one zero each, and whether it rises there. By Descartes' rule
// Bernstein coefficients change their sign at least as often as the polynomial.
function isolated(values, low = 0, high = 1) {
  const changes = changesOf(values);
  const crosses = isNegative(values[0]) !== isNegative(values[values.length - 1]);
  if (changes === 0) return [];
  if (changes === 1 || high - low < NARROWEST) return crosses ? [{ low, high, rises: isNegative(values[0]) }] : [];
  const pairs = CUTS.map((part) => ({ part, halves: cutAt(values, part) }));
  const { part, halves } = pairs.find(({ halves: [, right] }) => right[0] !== 0) ?? pairs[0];
  const middle = low + part * (high - low);
  return [...isolated(halves[0], low, middle), ...isolated(halves[1], middle, high)];
}

// The zero of a polynomial between two places, by Newton's method within a bisection.
function zeroWithin(coefficients, { low, high, rises }) {
  let place = (low + high) / 2;
  let [below, above] = [low, high];
  for (let round = 0; round < 100; round += 1) {
    const value = sumOf(coefficients, place);
    if (value === 0) return place;
    if (value < 0 === rises) below = place;
    else above = place;
    const next = place - value / slopeOf(coefficients, place);
    const inside = next > below && next < above;
    const better = inside ? next : (below + above) / 2;
    if (Math.abs(better - place) <= ULP * Math.abs(place) || better === below || better === above) return better;
    place = better;
  }
  return place;
}

// Collect the zeros of a rate over the steps of a run. `rateOf` returns the coefficients of the rate from a series;
// `atRelease` of them are zero at t = 0. A step waits for the next one, whose rate at its start is that at its end.
function zerosOf(rateOf, atRelease) {
  const zeros = []; // { time, rises, slope }, the slope being the derivative of the rate
  let waiting = null;

  function find(end) {
    const { rate, time, length } = waiting;
    const skipped = time === 0 ? Math.min(atRelease, rate.length - 1) : 0;
    const coefficients = scaled(rate, skipped, length);
    const values = bernsteinOf(coefficients);
    if (end !== null) values[values.length - 1] = end;
    for (const interval of isolated(values)) {
      const place = zeroWithin(coefficients, interval);
      const slope = (place ** skipped * slopeOf(coefficients, place)) / length;
      zeros.push({ time: time + length * place, rises: interval.rises, slope });
    }
  }

  return {
    zeros,
    step(series, time, length) {
      const rate = rateOf(series);
      if (waiting) find(rate[0]);
      waiting = { rate, time, length };
    },
    end() {
      if (waiting) find(null);
    },
  };
}

function derivative(coefficients) {
  const rate = [];
  for (let k = 1; k < coefficients.length; k += 1) rate.push(k * coefficients[k]);
  return rate;
}

const rateOfX = ([nx]) => derivative(nx);

// The rate at which the bob falls along the plumb line.
function rateOfFall({ constants: [, , pullNorth, pullUp] }) {
  return ([, ny, nz]) => derivative(ny.map((value, k) => pullNorth * value + pullUp * nz[k]));
}

// How often this rate is zero at t = 0: it is, but for rounding, where the bob is at rest or is pushed sideways.
function zeroOfFall({ velocity: [, vy, vz], constants: [, , pullNorth, pullUp] }) {
  return Math.abs(pullNorth * vy + pullUp * vz) <= NO_SIGN * Math.hypot(pullNorth, pullUp) ? 1 : 0;
}

const cancel = (a, b) => Math.abs(a + b) <= NO_SIGN * (Math.abs(a) + Math.abs(b));

// How often xdot is zero at t = 0, as `zero_at_release` of reference/model/start.py.
function zeroAtRelease({ start, velocity, constants: [turnNorth, turnUp, pullNorth] }) {
  const [nx, ny, nz] = start;
  const [vx, vy, vz] = velocity;
  const atPole = turnNorth === 0 && pullNorth === 0;
  if (vx !== 0) return 0;
  if (vy !== 0 || vz !== 0) return nx === 0 && cancel(turnNorth * vz, -turnUp * vy) ? 2 : 1;
  if (nx === 0) return cancel(turnNorth * ny, turnUp * nz) ? 4 : 2;
  return nz === 0 && (atPole || ny === 0) ? 3 : 1;
}
