// Judge a trajectory at the golden times as `foucault score` does (compare/score); pure functions, without the page.
// `truth` is what parts.py embeds: columns as doubles in base64, bounds, scales and words. Needs reading.js.
"use strict";

const SAME_TIME = 1e-6; // rad of the swing: a row that is this near to a golden time is judged there
const EXPLAINED = 0.02; // part of the error that a suspected mistake may leave
const MOST_EXTRA = 1000; // extra transits that are looked at one by one
const POSITION = ["x", "y", "z"];

function doubles(base64) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  return Float64Array.from({ length: bytes.length / 8 }, (_, i) => view.getFloat64(8 * i, true));
}

// Unpack the numbers once.
function unpacked(truth) {
  const grid = Object.fromEntries(Object.entries(truth.grid).map(([name, text]) => [name, doubles(text)]));
  const transits = truth.transits && { t: doubles(truth.transits.t), weight: doubles(truth.transits.weight) };
  return { ...truth, grid, transits };
}

// Index of the number in an increasing array that is nearest to a value.
function nearest(values, value) {
  let [low, high] = [0, values.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (values[middle] <= value) low = middle;
    else high = middle;
  }
  return Math.abs(values[high] - value) < Math.abs(values[low] - value) ? high : low;
}

const ratio = ([above, below]) => above / below;

// Which rows are at golden times: [[row, golden row], …].
function matches(t, { grid, grid_step: step, omega }) {
  const within = SAME_TIME * Math.min(step, omega ? 1 / omega : step);
  const found = [];
  t.forEach((time, row) => {
    const at = nearest(grid.t, time);
    if (Math.abs(time - grid.t[at]) <= within && !(found.length && found[found.length - 1][1] === at)) found.push([row, at]);
  });
  return found;
}

// The same, or throws Unreadable where no row after t = 0 is at a golden time, with what may be the reason.
function pairs(columns, truth) {
  const { grid, t_end: end, grid_step: step, words } = truth;
  const { t } = columns;
  const last = t[t.length - 1];
  if (last > end + step) {
    const unit = words.FINER.find((one) => last * ratio(words.TIMES[one]) <= end * (1 + words.SAME) && last > words.FAR * end);
    const advice = unit ? `They look like ${words.LONG_NAMES[unit]}: name the column t (${unit}).` : "Leave later rows out.";
    throw new Unreadable(`The last time is ${last} s, and the scene ends at ${end} s. ${advice}`);
  }
  const found = matches(t, truth);
  if (!found.some(([, at]) => grid.t[at] > 0)) {
    const within = SAME_TIME * Math.min(step, truth.omega ? 1 / truth.omega : step);
    const offsets = t.filter((time) => time > 0).map((time) => time - grid.t[nearest(grid.t, time)]);
    const shift = offsets[0] ?? 0;
    const shifted = offsets.length > 1 && offsets.every((offset) => Math.abs(offset - shift) <= within);
    const why = shifted ? ` All are ${Math.abs(shift).toPrecision(3)} s ${shift > 0 ? "after" : "before"} one: is the clock shifted?` : "";
    const golden = [...grid.t.slice(0, 3)].join(", ");
    const unit = unitOfTime(columns, truth).map((text) => ` ${text}`).join("");
    throw new Unreadable(`No row after t = 0 is at a golden time (${golden} … s).${why}${unit} Print rows there, or use foucault score, which judges at any time.`);
  }
  return found;
}

// Errors of the rows at golden times: candidate minus truth, the truth moved on by its velocity to the row's own time.
function errorsOf(columns, matched, truth) {
  const names = allColumns(truth.words).filter((name) => name !== "t" && name in columns);
  const rates = { x: "vx", y: "vy", z: "vz" };
  const components = {};
  for (const name of names) {
    components[name] = matched.map(([row, at]) => {
      const rate = rates[name] ? truth.grid[rates[name]][at] * (columns.t[row] - truth.grid.t[at]) : 0;
      return columns[name][row] - truth.grid[name][at] - rate;
    });
  }
  const present = POSITION.filter((name) => name in columns);
  const position = matched.map((_, i) => Math.hypot(...present.map((name) => components[name][i])));
  return { components, position, t: matched.map(([row]) => columns.t[row]) };
}

const largest = (values) => values.reduce((best, value, i) => (Math.abs(value) > Math.abs(values[best]) ? i : best), 0);

// Judge a candidate {columns or null, transits or null, notes}; `tolerance` in m, null for a millionth of the amplitude.
function judge(candidate, truth, tolerance = null) {
  const allowance = tolerance ?? truth.words.TOLERANCE * truth.amplitude_m;
  const allowed = allowance + truth.bound_m;
  const verdict = { tolerance_m: allowance, bound_m: truth.bound_m, notes: [...candidate.notes], path: null, transits: null };
  let until = Math.min(truth.t_end, candidate.transits?.at(-1) ?? 0); // later transits are not missed
  if (candidate.columns) {
    const matched = pairs(candidate.columns, truth);
    const errors = errorsOf(candidate.columns, matched, truth);
    verdict.path = { ...pathVerdict(candidate.columns, matched, errors, truth, allowed), errors };
    until = errors.t[errors.t.length - 1];
    const apart = candidate.columns.t.length - matched.length;
    if (apart) verdict.notes.push(`${apart} of ${candidate.columns.t.length} rows are not at golden times and were not judged.`);
    if (verdict.path.max_error_m > allowed) {
      const found = suspicions(candidate.columns, matched, errors, truth);
      verdict.notes.push(...(found.length ? found : unitOfTime(candidate.columns, truth)));
    }
  }
  if (candidate.transits && truth.transits) {
    verdict.transits = transitErrors(candidate.transits, truth, until, allowance);
  } else if (candidate.transits) {
    if (!candidate.columns) throw new Unreadable(`${truth.no_transits}: drop a trajectory.`);
    verdict.notes.push(`${truth.no_transits}: its transits were not judged.`);
  }
  const { path, transits } = verdict;
  const right = !path || path.max_error_m <= allowed;
  const timely = !transits || !(transits.missed.length || transits.extra.length || transits.max_conditioned_error_m > allowed);
  return { ...verdict, verdict: right && timely ? "agrees" : "disagrees" };
}

function pathVerdict(columns, matched, errors, truth, allowed) {
  const { components, position, t } = errors;
  const row = largest(position);
  const component = POSITION.filter((name) => name in columns).reduce((best, name) =>
    Math.abs(components[name][row]) > Math.abs(components[best][row]) ? name : best);
  const top = position[row];
  const [mine, golden] = matched[row];
  const wrong = position.findIndex((error) => error > allowed);
  const last = t[t.length - 1];
  return {
    rows: t.length,
    covered: last >= truth.t_end * (1 - truth.words.WHOLE) ? 1 : last / truth.t_end,
    covered_s: [t[0], last],
    max_error_m: top,
    rms_error_m: top && top * Math.sqrt(position.reduce((sum, error) => sum + (error / top) ** 2, 0) / position.length),
    end_error_m: position[position.length - 1],
    digits: -Math.log10(Math.max(top, truth.bound_m) / truth.amplitude_m),
    worst: { t: t[row], component, expected: truth.grid[component][golden], got: columns[component][mine], difference: components[component][row] },
    wrong_from_s: wrong < 0 ? null : t[wrong],
  };
}

// The place after the point of the first digit of a number that an error makes wrong, by half a unit or more.
function firstWrongPlace(error) {
  return Math.floor(-Math.log10(2 * Math.abs(error))) + 1;
}

// What plain mistakes explain, and what they leave: another unit, axes turned round or exchanged, a clock that is late.
function suspicions(columns, matched, errors, truth) {
  const { words } = truth;
  const top = errors.position.reduce((most, error) => Math.max(most, error), 0);
  const enough = EXPLAINED * Math.min(top, truth.amplitude_m);
  const told = (texts, rest) => (rest <= enough ? [`${texts.filter(Boolean).join(", and ")}: put right, ${rest.toPrecision(2)} m are left.`] : []);
  const rows = matched.map(([row, at]) => [columns.x[row], columns.y[row], truth.grid.x[at], truth.grid.y[at]]);
  for (const [size, unit] of [[1, ""], ...Object.entries(words.LENGTHS_SAID).map(([unit, text]) => [ratio(words.LENGTHS[unit]), text])]) {
    for (const [first, second, xSign, ySign, axes] of words.AXES_SAID) {
      if (!unit && !axes) continue;
      const left = rows.map((row) => Math.hypot(xSign * size * row[first] - row[2], ySign * size * row[second] - row[3]));
      const found = told([unit && `Your file ${unit}`, axes && `${unit ? "it" : "Your file"} ${axes}`], left.reduce((most, one) => Math.max(most, one), 0));
      if (found.length) return found;
    }
  }
  const [vx, vy] = ["vx", "vy"].map((name) => matched.map(([, at]) => truth.grid[name][at]));
  const { x: ex, y: ey } = errors.components;
  const square = vx.reduce((sum, one, i) => sum + one ** 2 + vy[i] ** 2, 0);
  const late = -vx.reduce((sum, one, i) => sum + one * ex[i] + vy[i] * ey[i], 0) / square;
  const rest = vx.reduce((most, one, i) => Math.max(most, Math.hypot(ex[i] + late * one, ey[i] + late * vy[i])), 0);
  return square ? told([`Your clock is ${Math.abs(late).toPrecision(4)} s ${late > 0 ? "slow" : "fast"}`], rest) : [];
}

// The unit in which times are meant: rows at golden times in it are within 2 % of the truth there; a sentence or none.
function unitOfTime(columns, truth) {
  for (const [unit, text] of Object.entries(truth.words.TIMES_SAID)) {
    const t = columns.t.map((time) => time * ratio(truth.words.TIMES[unit]));
    if (t[t.length - 1] > truth.t_end + truth.grid_step) continue;
    const matched = matches(t, truth);
    const { position } = errorsOf({ ...columns, t }, matched, truth);
    const rest = position.reduce((most, error) => Math.max(most, error), 0);
    if (matched.length > 2 && rest <= EXPLAINED * truth.amplitude_m) return [`Your file ${text}: put right, ${rest.toPrecision(2)} m are left.`];
  }
  return [];
}

// Match transits in order; name the missed and the extra ones, as compare/score/transit_matching.py does.
function transitErrors(times, truth, until, tolerance) {
  const possible = (time) => truth.possible.some(([from, to]) => time >= from && time <= to);
  const mine = times.filter((time) => time > 0 && time <= truth.t_end && !possible(time));
  const { t, weight } = truth.transits;
  const owner = owners(mine, t);
  const used = new Set(owner.filter((i) => i >= 0));
  const matched = [...t.keys()].filter((k) => owner[k] >= 0);
  const errors = matched.map((k) => mine[owner[k]] - t[k]);
  const conditioned = matched.map((k, i) => errors[i] * weight[k]);
  const missed = [...t.keys()].filter((k) => owner[k] < 0 && t[k] <= until);
  const excused = vanishing(missed, t, weight, until, tolerance);
  const extra = mine.filter((_, i) => !used.has(i));
  // the truth's xdot near a transit is ax times the distance; a time that stands there twice is no transit of any motion
  const near = (time) => t.length > 0 && Math.abs(time - t[nearest(t, time)]) * weight[nearest(t, time)] <= tolerance;
  const few = extra.length <= MOST_EXTRA; // of more, none is excused
  const spurious = extra.map((time) => few && near(time) && mine.filter((other) => other === time).length === 1);
  const size = (values) => values.reduce((best, value) => Math.max(best, Math.abs(value)), 0);
  return {
    matched: matched.length,
    missed: missed.filter((_, i) => !excused[i]).map((k) => t[k]),
    extra: extra.filter((_, i) => !spurious[i]),
    undecided: missed.filter((_, i) => excused[i]).length + spurious.filter(Boolean).length,
    max_error_s: size(errors),
    max_conditioned_error_m: size(conditioned),
  };
}

// For each transit of the truth the index of the candidate's that matches it, -1 if none does.
function owners(times, t) {
  const owner = Array(t.length).fill(-1);
  if (!t.length || !times.length) return owner;
  const gaps = [...t].map((time, k) => time - (k ? t[k - 1] : 0)).sort((a, b) => a - b);
  const middle = gaps.length >> 1;
  const window = 0.5 * (gaps.length % 2 ? gaps[middle] : (gaps[middle - 1] + gaps[middle]) / 2);
  if (times.length <= t.length && times.every((time, i) => Math.abs(time - t[i]) <= window)) {
    times.forEach((_, i) => { owner[i] = i; }); // one to one, in order, however close a pair
    return owner;
  }
  const cell = times.map((time) => nearest(t, time));
  const distance = times.map((time, i) => Math.abs(time - t[cell[i]]));
  const order = [...times.keys()].sort((i, j) => distance[i] - distance[j] || i - j);
  for (const i of order) if (distance[i] <= window && owner[cell[i]] < 0) owner[cell[i]] = i;
  return owner;
}

// Mark the missed transits that an error within the tolerance takes away in a pair, or moves beyond the end.
function vanishing(missed, t, weight, until, tolerance) {
  const excused = missed.map((k) => (until - t[k]) * weight[k] <= tolerance);
  for (let i = 0; i + 1 < missed.length; i += 1) {
    const k = missed[i];
    if (missed[i + 1] === k + 1 && (weight[k] * (t[k + 1] - t[k])) / 4 <= tolerance) {
      excused[i] = excused[i + 1] = true; // a parabola between two zeros, no deeper than the tolerance
    }
  }
  return excused;
}

if (typeof module !== "undefined") module.exports = { judge, meaning, readTrajectory, readTransits, unpacked, Unreadable };
