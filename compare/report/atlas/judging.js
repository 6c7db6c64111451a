// Judge a trajectory as `foucault score` does (compare/score); pure functions, without the page. Rows are judged at any
// time where the dataset has a golden function, else at the golden times. `truth` is what parts.py embeds: columns as
// doubles in base64, bounds, scales and words. Needs evaluator (docs/readers/function.mjs), reading.js and
// observing.js.
"use strict";

const SAME_TIME = 1e-6; // rad of the swing: a row that is this near to a time at which the truth is known is judged there
const EXPLAINED = 0.02; // part of the error that a suspected mistake may leave
const MOST_EXTRA = 1000; // extra transits that are looked at one by one
const SAMPLE = 1000; // rows that show whether a suspicion is worth a look at all
const POSITION = ["x", "y", "z"];
const STATE = [...POSITION, "vx", "vy", "vz"];

function numbersOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i += 1) bytes[i] = text.charCodeAt(i);
  return new DataView(bytes.buffer);
}

function doubles(base64) {
  const view = numbersOf(base64);
  return Float64Array.from({ length: view.byteLength / 8 }, (_, i) => view.getFloat64(8 * i, true));
}

// Unpack the numbers once, and those of the golden function; null where only the rows are known.
function unpacked(truth, goldenFunction = truth.function) {
  const grid = Object.fromEntries(Object.entries(truth.grid).map(([name, text]) => [name, doubles(text)]));
  const transits = truth.transits && { t: doubles(truth.transits.t), weight: doubles(truth.transits.weight) };
  return { ...truth, grid, transits, ...functionOf(goldenFunction) };
}

function functionOf(goldenFunction) {
  if (!goldenFunction) return { at: null };
  const { record, coefficients, end } = goldenFunction;
  return { at: evaluator(record, numbersOf(coefficients)), end, bounds: record.bounds };
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
const most = (values) => values.reduce((best, value) => Math.max(best, value), 0);
const picked = (columns, rows) => Object.fromEntries(Object.entries(columns).map(([name, of]) => [name, rows.map((row) => of[row])]));

// The truth at those of some times at which it is known: {rows: their indices, golden: columns}. A row that is a little
// off such a time has the state there, moved on by its velocity.
function truthAt(t, { grid, grid_step: step, omega, at, end }) {
  const within = SAME_TIME * Math.min(step, omega ? 1 / omega : step);
  const rows = [];
  const golden = Object.fromEntries(STATE.map((name) => [name, []]));
  let before = -1;
  t.forEach((time, row) => {
    const i = at ? row : nearest(grid.t, time);
    const goldenTime = at ? Math.min(time, end) : grid.t[i];
    const gap = time - goldenTime;
    if (Math.abs(gap) > within || i === before) return;
    const state = at ? at(goldenTime) : STATE.map((name) => grid[name][i]);
    STATE.forEach((name, k) => golden[name].push(k < 3 && gap ? state[k] + gap * state[k + 3] : state[k]));
    rows.push(row);
    before = i;
  });
  return { rows, golden };
}

// The same of a candidate, or throws Unreadable where it says nothing of the motion, with what may be the reason.
function judgedRows(columns, truth) {
  const { grid, t_end: end, grid_step: step, words } = truth;
  const { t } = columns;
  const last = t[t.length - 1];
  if (last > end + step) {
    const first = t.length > 1 ? t[0] : 0; // one row alone says nothing of a clock's start
    const span = last - first;
    const unit = words.FINER.find((finer) => span * ratio(words.TIMES[finer]) <= end * (1 + words.SAME) && span > words.FAR * end);
    const clock = first > 0 && span <= end ? ` Did the clock start before the release? ${words.SUBTRACT}` : "";
    const advice = unit ? `They look like ${words.LONG_NAMES[unit]}: name the column t (${unit}).` : `Leave later rows out.${clock}`;
    throw new Unreadable(`The last time is ${last} s, and the scene ends at ${end} s. ${advice}`);
  }
  const judged = truthAt(t, truth);
  const within = SAME_TIME * Math.min(step, truth.omega ? 1 / truth.omega : step);
  if (judged.rows.some((row) => t[row] > (truth.at ? 0 : within))) return judged;
  if (truth.at) throw new Unreadable("No row after t = 0: the file says nothing of the motion.");
  const offsets = t.filter((time) => time > 0).map((time) => time - grid.t[nearest(grid.t, time)]);
  const shift = offsets[0] ?? 0;
  const shifted = offsets.length > 1 && offsets.every((offset) => Math.abs(offset - shift) <= within);
  const why = shifted ? ` All are ${Math.abs(shift).toPrecision(3)} s ${shift > 0 ? "after" : "before"} one: is the clock shifted?` : "";
  const golden = [...grid.t.slice(0, 3)].join(", ");
  const unit = unitOfTime(columns, truth).map((text) => ` ${text}`).join("");
  throw new Unreadable(`No row after t = 0 is at a golden time (${golden} … s).${why}${unit} Print rows there, or use foucault score, which judges at any time.`);
}

// Errors of these rows: candidate minus truth.
function errorsOf(columns, { rows, golden }) {
  const components = {};
  for (const name of STATE.filter((column) => column in columns)) {
    components[name] = Float64Array.from(rows, (row, i) => columns[name][row] - golden[name][i]);
  }
  const present = POSITION.filter((name) => name in columns).map((name) => components[name]);
  const position = Float64Array.from(rows, (_, i) => Math.hypot(...present.map((error) => error[i])));
  return { components, position, t: Float64Array.from(rows, (row) => columns.t[row]) };
}

// The end of a sentence on a mistake: the error without it, in tolerances too if it is more than one.
function correctedTo(residual, allowed) {
  const beyond = residual > allowed ? `, ${shortNumber(residual / allowed, 2)} tolerances: something else is wrong too` : "";
  return `corrected, the error is ${residual.toPrecision(2)} m${beyond}.`;
}

const largest = (values) => values.reduce((best, value, i) => (Math.abs(value) > Math.abs(values[best]) ? i : best), 0);
const reach = (xs, ys) => xs.reduce((best, x, i) => Math.max(best, Math.hypot(x, ys[i])), 0);

// How far the truth of a file's position columns may be off, in m.
function boundOf(columns, { bounds, bound_m: bound }) {
  if (!bounds) return bound;
  return Math.hypot(...POSITION.filter((name) => !columns || name in columns).map((name) => Number(bounds[name])));
}

// What a clock showed, for people: with the date if it counts from 1970.
function shownBy(seconds, { words }) {
  const text = `${seconds} s`;
  if (!(seconds >= words.UNIX[0] && seconds < words.UNIX[1])) return text;
  return `${text} since 1970, ${new Date(1000 * Math.floor(seconds)).toISOString().slice(0, 19).replace("T", " ")} UTC`;
}

// A candidate with times since the release: those of a clock that did not start there are counted from the first row, if
// this is the release, as compare/score/clock_start.py does.
function countedFromRelease(candidate, truth, tolerance) {
  const { columns, transits, clock } = candidate;
  if (!columns) return candidate;
  const { t, x, y } = columns;
  const end = truth.t_end + truth.grid_step;
  const elsewhere = t.length > 1 && t[0] > end && t[t.length - 1] - t[0] <= end;
  const start = clock ?? (elsewhere ? t[0] : null);
  if (start === null) return candidate;
  const [east, north] = [truth.grid.x[0], truth.grid.y[0]];
  const distance = Math.hypot(x[0] - east, y[0] - north);
  if (distance > (tolerance ?? truth.words.TOLERANCE * Math.hypot(east, north))) {
    throw new Unreadable(`The clock showed ${shownBy(start, truth)} in the first row, which is ${distance.toPrecision(3)} m from the release. ${truth.words.SUBTRACT}`);
  }
  const note = `Reading: the clock showed ${shownBy(start, truth)} in the first row, which is at the release: times are counted from it.`;
  return {
    columns: clock === null || clock === undefined ? { ...columns, t: since(start, t) } : columns,
    transits: transits && since(start, transits),
    notes: [...candidate.notes, note],
  };
}

// Judge a candidate {columns or null, transits or null, notes}; `tolerance` in m, null for a millionth of the amplitude,
// or of what a candidate reaches that swings far less.
function judge(given, truth, tolerance = null) {
  const candidate = countedFromRelease(given, truth, tolerance);
  const { columns, transits: times } = candidate;
  const judged = columns && judgedRows(columns, truth);
  const amplitude = judged && truth.at ? Math.max(truth.amplitude_m, reach(judged.golden.x, judged.golden.y)) : truth.amplitude_m;
  const part = judged ? reach(columns.x, columns.y) / reach(judged.golden.x, judged.golden.y) : 1;
  const swingsLess = part > 0 && part < truth.words.SMALL;
  const allowance = tolerance ?? truth.words.TOLERANCE * amplitude * (swingsLess ? part : 1);
  const bound = boundOf(columns, truth);
  const allowed = allowance + bound;
  const verdict = { tolerance_m: allowance, tolerance_of: toleranceOf(tolerance, swingsLess), bound_m: bound, amplitude_m: amplitude, at_any_time: Boolean(truth.at), notes: [...candidate.notes], explained: false, isNamed: false, gravity: null, path: null, transits: null };
  let until = Math.min(truth.t_end, times?.at(-1) ?? 0); // later transits are not missed
  if (columns) {
    const errors = errorsOf(columns, judged);
    verdict.path = { ...pathVerdict(columns, judged, errors, truth, { allowed, amplitude, bound }), errors };
    until = errors.t[errors.t.length - 1];
    const apart = columns.t.length - judged.rows.length;
    if (apart) verdict.notes.push(`${apart} of ${columns.t.length} rows are ${truth.at ? "after the scene's end" : "not at golden times"} and were not judged.`);
    if (verdict.path.max_error_m > allowed) {
      const { notes, explained, isNamed = false, gravity = null } = mistakesIn(columns, judged, errors, truth, allowed);
      verdict.notes.push(...notes);
      Object.assign(verdict, { explained, isNamed, gravity });
    }
  }
  if (times && truth.transits) {
    if (!columns && times[0] > truth.t_end) throw new Unreadable(`The first transit is at ${times[0]} s, and the scene ends at ${truth.t_end} s. ${truth.words.SUBTRACT}`);
    const goesOn = !columns || times.at(-1) > columns.t.at(-1);
    verdict.transits = transitErrors(times, truth, until, allowance, goesOn ? truth.t_end : Math.min(columns.t.at(-1), truth.t_end));
  } else if (times) {
    if (!columns) throw new Unreadable(`${truth.no_transits}: drop a trajectory.`);
    verdict.notes.push(`${truth.no_transits}: its transits were not judged.`);
  }
  const { path, transits } = verdict;
  const right = !path || path.max_error_m <= allowed;
  const timely = !transits || !(transits.missed.length || transits.extra.length || transits.max_conditioned_error_m > allowed);
  return { ...verdict, verdict: right && timely ? "agrees" : "disagrees" };
}

// Where a tolerance comes from: typed, or a millionth of the truth's amplitude, or of that of the rows.
function toleranceOf(tolerance, swingsLess) {
  if (tolerance !== null) return "typed";
  return swingsLess ? "rows" : "amplitude";
}

// What explains the error, the plainest first: {notes, explained, isNamed, gravity}: whether nothing is left of it, whether
// a clock or a map of columns is named, and what was found of the other meaning of g if it was tried.
function mistakesIn(columns, judged, errors, truth, allowed) {
  const plain = suspicions(columns, judged, errors, truth, allowed);
  if (plain.length) return { notes: plain, explained: true };
  const unit = unitOfTime(columns, truth, allowed);
  return unit.length ? { notes: unit, explained: true } : observed(columns, judged, truth, allowed);
}

function pathVerdict(columns, { rows, golden }, errors, truth, { allowed, amplitude, bound }) {
  const { components, position, t } = errors;
  const row = largest(position);
  const component = POSITION.filter((name) => name in columns).reduce((best, name) =>
    Math.abs(components[name][row]) > Math.abs(components[best][row]) ? name : best);
  const top = position[row];
  const wrong = position.findIndex((error) => error > allowed);
  const last = t[t.length - 1];
  return {
    rows: t.length,
    covered: last >= truth.t_end * (1 - truth.words.WHOLE) ? 1 : last / truth.t_end,
    covered_s: [t[0], last],
    max_error_m: top,
    rms_error_m: top && top * Math.sqrt(position.reduce((sum, error) => sum + (error / top) ** 2, 0) / position.length),
    end_error_m: position[position.length - 1],
    digits: -Math.log10(Math.max(top, bound) / amplitude),
    worst: { t: t[row], component, expected: golden[component][row], got: columns[component][rows[row]], difference: components[component][row] },
    wrong_from_s: wrong < 0 ? null : t[wrong],
  };
}

// The place after the point of the first digit of a number that an error makes wrong, by half a unit or more.
function firstWrongPlace(error) {
  return Math.floor(-Math.log10(2 * Math.abs(error))) + 1;
}

// What plain mistakes explain, and what they leave: another unit, axes turned round or exchanged, a clock that is late.
function suspicions(columns, { rows, golden }, errors, truth, allowed) {
  const { words } = truth;
  const enough = EXPLAINED * Math.min(most(errors.position), truth.amplitude_m);
  function explained(texts, residual) {
    if (!(residual <= enough)) return [];
    return [`${texts.filter(Boolean).join(", and ")}: ${correctedTo(residual, allowed)}`];
  }
  for (const [size, unit] of [[1, ""], ...Object.entries(words.LENGTHS_SAID).map(([unit, text]) => [ratio(words.LENGTHS[unit]), text])]) {
    for (const [first, second, xSign, ySign, axes] of words.AXES_SAID) {
      if (!unit && !axes) continue;
      const plane = [columns.x, columns.y];
      const residual = (row, i) => Math.hypot(xSign * size * plane[first][row] - golden.x[i], ySign * size * plane[second][row] - golden.y[i]);
      if (rows.some((row, i) => residual(row, i) > enough)) continue;
      return explained([unit && `Your file ${unit}`, axes && `${unit ? "it" : "Your file"} ${axes}`], most(rows.map(residual)));
    }
  }
  const { vx, vy, vz } = golden;
  const { x: ex, y: ey } = errors.components;
  const square = vx.reduce((sum, u, i) => sum + u ** 2 + vy[i] ** 2, 0);
  const late = -vx.reduce((sum, u, i) => sum + u * ex[i] + vy[i] * ey[i], 0) / square;
  const ez = errors.components.z;
  const height = (i) => (ez ? ez[i] + late * vz[i] : 0);
  const residual = most(vx.map((u, i) => Math.hypot(ex[i] + late * u, ey[i] + late * vy[i], height(i))));
  return square ? explained([`Your clock is ${Math.abs(late).toPrecision(4)} s ${late > 0 ? "slow" : "fast"}`], residual) : [];
}

// The unit in which times are meant: the rows, their times in it, are within 2 % of the truth; a sentence or none.
function unitOfTime(columns, truth, allowed = Infinity) {
  const { words, amplitude_m: amplitude } = truth;
  const each = Math.ceil(columns.t.length / SAMPLE);
  for (const [unit, text] of Object.entries(words.TIMES_SAID)) {
    const residualOf = (rows) => {
      const mine = picked(columns, rows);
      mine.t = mine.t.map((time) => time * ratio(words.TIMES[unit]));
      if (mine.t[mine.t.length - 1] > truth.t_end + truth.grid_step) return Infinity;
      const judged = truthAt(mine.t, truth);
      return judged.rows.length > 2 ? most(errorsOf(mine, judged).position) : Infinity;
    };
    const all = [...columns.t.keys()];
    if (each > 1 && truth.at && residualOf(all.filter((i) => i % each === 0)) > EXPLAINED * amplitude) continue;
    const residual = residualOf(all);
    if (residual <= EXPLAINED * amplitude) return [`Your file ${text}: ${correctedTo(residual, allowed)}`];
  }
  return [];
}

// Match transits in order; name the missed and the extra ones, as compare/score/transit_matching.py does.
function transitErrors(times, truth, until, tolerance, endOfRun) {
  const possible = (time) => truth.possible.some(([from, to]) => time >= from && time <= to);
  const mine = times.filter((time) => time > 0 && time <= endOfRun && !possible(time));
  const all = truth.transits;
  const among = (_, k) => all.t[k] <= endOfRun || (all.t[k] - endOfRun) * all.weight[k] <= tolerance; // of those after the run none
  const [t, weight] = [all.t.filter(among), all.weight.filter(among)];
  const owner = owners(mine, t);
  const used = new Set(owner.filter((i) => i >= 0));
  const matched = [...t.keys()].filter((k) => owner[k] >= 0);
  const errors = matched.map((k) => mine[owner[k]] - t[k]);
  const conditioned = matched.map((k, i) => errors[i] * weight[k]);
  const missed = [...t.keys()].filter((k) => owner[k] < 0 && t[k] <= until);
  const excused = vanishing(missed, t, weight, until, tolerance);
  const extra = mine.filter((_, i) => !used.has(i));
  // xdot as the function has it, else near a transit ax times the distance; what stands there twice is no transit at all
  const tangent = (time) => (t.length ? Math.abs(time - t[nearest(t, time)]) * weight[nearest(t, time)] : Infinity);
  const near = (time) => (truth.at ? Math.abs(truth.at(Math.min(time, truth.end))[3]) / truth.omega : tangent(time)) <= tolerance;
  const excusable = extra.length <= MOST_EXTRA; // of more, none is excused
  const spurious = extra.map((time) => excusable && near(time) && mine.filter((other) => other === time).length === 1);
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
