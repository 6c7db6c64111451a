// Period and precession of a run from its highest points, as reference/solver/swing.py has them; where the bob hangs.
// Needs integrating.js. `reasons` are the sentences of that module that say why a number is missing.
"use strict";

const CLEAR = 16; // a swing is this many times as wide as the rest position is off the plumb line
const LEAST_BEND = 1e-6; // of a highest point: below it the bob circles on a cone
const HOUR = 3600; // s
const NEWTON = 40; // rounds at most
const NO_SWING = { period: null, precession: null, turn: null };

const degrees = (radians) => (radians * 180) / Math.PI;

// The angle in radians by which the rest position is off the vertical, positive to the north; null if there is none.
function tiltOf(constants) {
  const [turnNorth, turnUp, pullNorth, pullUp] = constants;
  const force = (angle) => tangentialForce(Math.sin(angle), Math.cos(angle), ...constants)[0];
  if (pullNorth === 0 && turnNorth * turnUp === 0) return pullUp === 0 && turnNorth === 0 ? null : 0;

  let angle = Math.atan2(pullNorth, -pullUp);
  const slope = (at) => (force(at + 1e-6) - force(at - 1e-6)) / 2e-6;
  for (let round = 0; round < NEWTON; round += 1) {
    const step = force(angle) / slope(angle);
    angle -= step;
    if (Math.abs(step) <= ULP * Math.abs(angle)) break;
  }
  return slope(angle) < 0 && Number.isFinite(angle) ? angle : null;
}

// The highest points of a run, as they are seen along the plumb line at the pivot.
function apsesOf({ at, falls, problem }) {
  const { length, unit, constants } = problem;
  const [, , pullNorth, pullUp] = constants;
  const strength = Math.hypot(pullNorth, pullUp);
  return falls.filter(({ rises }) => rises).map(({ time, slope }) => {
    const [x, y, z] = at(time * unit).map((value) => value / length);
    const along = (pullNorth * z - pullUp * y) / strength;
    const across = Math.hypot(x, along);
    const drop = 1 - (pullNorth * y + pullUp * z) / strength;
    return {
      time: time * unit,
      azimuth: Math.atan2(along, x),
      distance: Math.hypot(across, drop),
      bent: slope > LEAST_BEND * (strength * across) ** 2,
    };
  });
}

const turnsBetween = (apses) => apses.slice(1).map(({ azimuth }, i) => azimuth - apses[i].azimuth);

// {hz, precession in degrees an hour or null}, or {reason}; `reason` beside hz says why there is no precession.
function swingOf(run, reasons) {
  const apses = apsesOf(run);
  if (apses.length < 2 || !apses.every(({ bent }) => bent)) return { reason: reasons.NO_SWING };
  const { unit, constants } = run.problem;
  const [turnNorth, turnUp, pullNorth, pullUp] = constants;

  const tilt = tiltOf(constants);
  const lean = tilt === null ? 0 : Math.abs(Math.sin(tilt - Math.atan2(pullNorth, -pullUp)));
  const nearest = apses.reduce((least, { distance }) => Math.min(least, distance), Infinity);
  const offset = (CLEAR * lean) / nearest;
  if (offset > 1) return { reason: reasons.LEAN };

  const span = apses[apses.length - 1].time - apses[0].time;
  const swing = { hz: (apses.length - 1) / 2 / span, precession: null };
  const longest = apses.slice(1).reduce((most, { time }, i) => Math.max(most, time - apses[i].time), 0);
  if ((Math.hypot(turnNorth, turnUp) / unit) * longest >= Math.PI / 2) return { ...swing, reason: reasons.FAST };

  const halves = turnsBetween(apses).map((turn) => Math.round(turn / Math.PI));
  if (halves.some((half) => half % 2 === 0)) return { reason: reasons.ONE_SIDE };
  const half = halves.reduce((sum, value) => sum + value, 0);
  const turn = apses[apses.length - 1].azimuth - apses[0].azimuth - half * Math.PI;
  if (offset > Math.abs(turn)) return { ...swing, reason: reasons.SMALL };
  return { ...swing, precession: (degrees(turn) / span) * HOUR };
}

// The largest difference of what two runs have at each highest point, as a part of the span from the first to the last.
function shareOf(apses, others, differenceOf) {
  const span = apses[apses.length - 1].time - apses[0].time;
  const differences = apses.map((apsis, i) => Math.abs(differenceOf(apsis, others[i])));
  return (2 * CAUTION * differences.reduce((most, value) => Math.max(most, value), 0)) / span;
}

const turnFrom = (one, other) => Math.sin(one.azimuth - other.azimuth); // a small angle, whatever turns lie between
const estimated = (value, error) => ({ value, error: error + 2 * ULP * Math.abs(value) });

// Period in s, precession in degrees an hour and full turn in h, each {value, error} or null, and the reason for null. The
// errors are estimated from the second run.
function swingFacts(first, second, reasons) {
  const swing = swingOf(first, reasons);
  if (swing.hz === undefined) return { ...NO_SWING, reason: swing.reason };
  const apses = apsesOf(first);
  const others = apsesOf(second);
  if (apses.length !== others.length) return { ...NO_SWING, reason: reasons.UNDECIDED };

  const late = shareOf(apses, others, (one, other) => one.time - other.time);
  const period = estimated(1 / swing.hz, late / swing.hz);
  if (swing.precession === null) return { ...NO_SWING, period, reason: swing.reason };

  const turned = HOUR * degrees(shareOf(apses, others, turnFrom));
  const precession = estimated(swing.precession, turned + late * Math.abs(swing.precession));
  const size = Math.abs(precession.value);
  if (size <= precession.error) return { ...NO_SWING, period, precession, reason: reasons.STILL };
  return { period, precession, turn: estimated(360 / size, (360 * precession.error) / size ** 2), reason: "" };
}
