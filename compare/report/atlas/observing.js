// The observation: how a right motion became the columns of a file, as compare/diagnosis/observed.py. Maps are fitted to the
// truth; one whose residual is larger than is allowed is not named. Needs judging.js, and claims.js, which emitted_claims.py writes.
"use strict";

const MAPPED = 4000; // rows at most
const LATE_ROWS = [1, -1, 2, -2]; // by which a column may be late
const MAP_DIGITS = 10; // of a fitted number at most
const FIRST_ROWS = 16; // to which a clock is fitted before it is to more
const CLOCK_STEPS = 6;
const FEWEST_VALUES = 20; // of fewer numbers nobody can tell how they are rounded
const MOST_DECIMALS = 8; // that count as rounded
const HEIGHT_DIGITS = 6; // of a height

const mean = (values) => values.reduce((total, value) => total + value, 0) / values.length;
const rootMeanSquare = (values) => Math.sqrt(values.reduce((total, value) => total + value ** 2, 0) / values.length);
const farthest = (values) => values.reduce((best, value) => Math.max(best, Math.abs(value)), 0);
const lessThan = (values, others) => values.map((value, i) => value - others[i]);
const inProduct = (values, others) => values.reduce((total, value, i) => total + value * others[i], 0);

// A number as people write it: 1.5, 1e-7.
function shortNumber(value, digits) {
  return String(Number(value.toPrecision(digits))).replace(/e([+-])(\d)$/, "e$10$2");
}

// The shortest decimal within a doubt: {text, digits}.
function shortestDecimal(value, doubt) {
  for (let digits = 1; digits < 12; digits += 1) {
    if (Math.abs(Number(value.toPrecision(digits)) - value) <= doubt) return { value: Number(value.toPrecision(digits)), digits };
  }
  return { value: Number(value.toPrecision(12)), digits: 12 };
}

// Whether a number is round: it has as few digits as a person types, and its shortest decimal within a doubt is no accident.
function hasFewDigits(value, uncertainty) {
  const doubt = Math.max(uncertainty, 2 ** -50 * Math.abs(value));
  if (Math.abs(value) <= doubt) return true;
  const { digits } = shortestDecimal(value, doubt);
  const unit = 10 ** (Math.floor(Math.log10(Math.abs(value))) - digits + 1);
  return digits <= MOST_DIGITS && 2 * doubt < CHANCE * unit;
}

// A fitted number: its text, and its price, which is 0 if it is round, and 1 if it is arbitrary.
function fittedNumber(value, uncertainty) {
  const text = shortNumber(shortestDecimal(value, uncertainty).value, MAP_DIGITS);
  return { text, price: hasFewDigits(value, uncertainty) ? 0 : 1 };
}

// The number of decimals that x and y are printed with; null if they are more than programs round to.
function decimalsOf(columns) {
  const isWhole = (value) => Math.abs(value - Math.round(value)) <= 1e-9 * Math.max(1, Math.abs(value));
  const rounds = (values, size) => values.every((value) => isWhole(value * size));
  const names = POSITION.filter((name) => name in columns);
  if (names.length * columns.t.length < FEWEST_VALUES) return null;
  for (let decimals = 0; decimals <= MOST_DECIMALS; decimals += 1) {
    if (names.every((name) => rounds(columns[name], 10 ** decimals))) return decimals;
  }
  return null;
}

// What is explained: columns of a file and of the truth at its rows, and how closely. Of many rows some are taken.
function observedCase(columns, judged, truth, allowed) {
  const each = Math.ceil(judged.rows.length / MAPPED);
  const isTaken = (_, i) => i % each === 0;
  const rows = judged.rows.filter(isTaken);
  const golden = Object.fromEntries(POSITION.map((name) => [name, judged.golden[name].filter(isTaken)]));
  const names = POSITION.filter((name) => name in columns);
  const decimals = decimalsOf(columns);
  const printed = Object.fromEntries(names.map((name) => [name, rows.map((row) => columns[name][row])]));
  const error = farthest(names.flatMap((name) => lessThan(printed[name], golden[name])));
  const noise = decimals === null ? 0 : 0.5 * 10 ** -decimals; // of the rounding of its numbers, in m
  const enough = Math.max(allowed, ROUNDED * noise);
  return {
    names,
    decimals,
    noise,
    times: rows.map((row) => columns.t[row]),
    printed,
    golden,
    length: truth.length_m,
    allowed: enough,
    residualLimit: Math.max(Math.min(enough, error / NEEDED), noise), // largest residual of a map or clock that is named, in m
    resolution: Math.max(noise, FINEST * allowed),
  };
}

const uncertaintyOf = (residuals, { resolution }) => Math.max(rootMeanSquare(residuals), resolution);

function isEven(times) {
  const steps = times.slice(1).map((time, i) => time - times[i]);
  const least = steps.reduce((best, step) => Math.min(best, step), Infinity);
  return farthest(steps) - least <= 1e-6 * steps[0];
}

// What is said of heights that are all too high by as much.
function heightMoved(shift, { length, allowed }) {
  if (Math.abs(shift - length) <= allowed) return "counts z from the lowest point";
  return `has z ${shortNumber(Math.abs(shift), HEIGHT_DIGITS)} m too ${shift > 0 ? "high" : "low"} in every row`;
}

// The maps of one column: {text, columns: {name: values}, price}.

function columnMaps(fileCase, name) {
  const { names, printed: all, golden, resolution, times } = fileCase;
  const printed = all[name];
  const right = golden[name];
  const map = (text, values, price = 1) => ({ text, columns: { [name]: values }, price });
  const maps = [];

  const level = mean(printed);
  if (farthest(printed.map((value) => value - printed[0])) <= resolution) {
    maps.push(map(`prints ${name} as a constant, ${shortNumber(level, MAP_DIGITS)}`, printed.map(() => level)));
  }
  for (const other of names.filter((word) => word !== name)) {
    maps.push(map(`prints ${other} in its column of ${name}`, golden[other]));
    maps.push(map(`prints −${other} in its column of ${name}`, golden[other].map((value) => -value)));
  }
  const mirrored = name === "z" ? "counts z downwards" : `prints −${name} in its column of ${name}`;
  maps.push(map(mirrored, right.map((value) => -value)));

  const square = inProduct(right, right);
  const factor = square ? inProduct(right, printed) / square : 0;
  const size = rootMeanSquare(right);
  if (Math.min(Math.abs(factor), Math.abs(factor + 1)) * size > RIVAL * resolution) {
    const scaled = right.map((value) => factor * value);
    const number = fittedNumber(factor, uncertaintyOf(lessThan(printed, scaled), fileCase) / size);
    maps.push(map(`prints ${name} times ${number.text}`, scaled, 1 + number.price));
  }

  const shift = mean(lessThan(printed, right));
  const moved = right.map((value) => value + shift);
  const number = fittedNumber(shift, uncertaintyOf(lessThan(printed, moved), fileCase));
  const added = name === "z" ? heightMoved(shift, fileCase) : `prints ${name} with ${number.text} m added to it`;
  maps.push(map(added, moved, 1 + number.price));

  for (const count of isEven(times) ? LATE_ROWS : []) {
    const late = printed.map((value, i) => right[i - count] ?? value);
    const shiftText = Math.abs(count) === 1 ? "one row" : `${Math.abs(count)} rows`;
    if (printed.length > Math.abs(count)) maps.push(map(`prints ${name} ${shiftText} ${count > 0 ? "late" : "early"}`, late));
  }
  return maps;
}

// The maps of x and y together: scaled, turned, moved.

function planeMaps(fileCase) {
  const { printed, golden } = fileCase;
  const [x, y] = [golden.x, golden.y];
  const square = inProduct(x, x) + inProduct(y, y);
  const along = (inProduct(x, printed.x) + inProduct(y, printed.y)) / square;
  const across = (inProduct(x, printed.y) - inProduct(y, printed.x)) / square;
  const size = Math.sqrt(square / x.length);

  const transformed = (a, b, c = 0, d = 0) => ({
    x: x.map((value, i) => a * value - b * y[i] + c),
    y: y.map((value, i) => a * value + b * x[i] + d),
  });
  const residual = (map) => {
    const squares = lessThan(printed.x, map.x).map((value, i) => Math.hypot(value, printed.y[i] - map.y[i]));
    return uncertaintyOf(squares, fileCase);
  };
  const inDegrees = 180 / Math.PI;
  const maps = [];

  const scaled = transformed(along, 0);
  const scale = fittedNumber(along, residual(scaled) / size);
  maps.push({ text: `prints x and y times ${scale.text}`, columns: scaled, price: 1 + scale.price });

  const turn = Math.atan2(across, along);
  const turned = transformed(Math.cos(turn), Math.sin(turn));
  const doubt = residual(turned) / size;
  const radians = fittedNumber(turn, doubt);
  const degrees_ = fittedNumber(turn * inDegrees, doubt * inDegrees);
  const angle = radians.price ? `${degrees_.text} degrees` : `${radians.text} rad`;
  const turnedText = `prints x and y turned by ${angle}, anticlockwise`;
  maps.push({ text: turnedText, columns: turned, price: 1 + radians.price * degrees_.price });

  const [east, north] = ["x", "y"].map((name) => mean(lessThan(printed[name], golden[name])));
  const moved = transformed(1, 0, east, north);
  const [right, up] = [east, north].map((value) => fittedNumber(value, residual(moved)));
  const movedText = `prints x and y with ${right.text} m and ${up.text} m added to them`;
  maps.push({ text: movedText, columns: moved, price: 2 + right.price + up.price });

  const both = transformed(along, across);
  const close = residual(both) / size;
  const length = fittedNumber(Math.hypot(along, across), close);
  const round = fittedNumber(turn * inDegrees, close * inDegrees);
  const text = `prints x and y times ${length.text} and turned by ${round.text} degrees, anticlockwise`;
  maps.push({ text, columns: both, price: 2 + length.price + round.price });
  return maps;
}

const residualsOf = ({ printed }, { columns }) => Object.keys(columns).flatMap((name) => lessThan(printed[name], columns[name]));

// The cheapest of the maps that make their columns: several if they fit as well.
function bestMaps(fileCase, maps) {
  const { resolution, residualLimit } = fileCase;
  const residuals = maps.map((map) => residualsOf(fileCase, map));
  const sizes = residuals.map((values) => Math.max(rootMeanSquare(values), resolution));
  const most = RIVAL * sizes.reduce((least, size) => Math.min(least, size), Infinity);
  const near = maps.filter((_, i) => sizes[i] <= most && farthest(residuals[i]) <= residualLimit);
  const price = near.reduce((least, map) => Math.min(least, map.price), Infinity);
  return near.filter((map) => map.price === price);
}

const priceOf = (groups) => groups.reduce((total, maps) => total + (maps.length ? maps[0].price : Infinity), 0);

// What a right program's columns were mapped by: {texts, residual_m}; null if no map explains all wrong columns.
function observation(fileCase, truth) {
  const { names, printed, golden, allowed, times } = fileCase;
  const wrong = names.filter((name) => farthest(lessThan(printed[name], golden[name])) > allowed);
  if (!wrong.length || times[times.length - 1] * truth.omega < 2 * Math.PI) return null;

  const separate = wrong.map((name) => bestMaps(fileCase, columnMaps(fileCase, name)));
  let groups = separate;
  if (wrong.includes("x") && wrong.includes("y")) {
    const others = separate.filter((_, i) => wrong[i] === "z");
    const together = [bestMaps(fileCase, planeMaps(fileCase)), ...others];
    if (priceOf(together) < priceOf(separate)) groups = together;
  }
  const price = priceOf(groups);
  if (!Number.isFinite(price) || ROWS_A_NUMBER * price > times.length) return null;
  if (groups.some((maps) => maps.length > ALTERNATIVES)) return null;

  const texts = groups.map((maps) => (maps.length > 1 ? "either " : "") + maps.map((map) => map.text).join(", or "));
  const mended = Object.assign({}, golden, ...groups.map(([map]) => map.columns));
  const residuals = names.map((name) => lessThan(printed[name], mended[name]));
  const distances = times.map((_, i) => Math.hypot(...residuals.map((values) => values[i])));
  return { texts, residual_m: farthest(distances) };
}

// A clock that runs faster or slower than its motion, fitted to more and more rows: {text, residual_m}, or null.
function clockRate({ names, times, printed, residualLimit, resolution }, truth) {
  if (!truth.at || times.length < FIRST_ROWS) return null;
  let rate = 1; // of the motion, over that of the clock

  // of the first rows, those for which the motion is known
  const statesAt = (count) => times.slice(0, count).filter((time) => time * rate <= truth.end).map((time) => truth.at(time * rate));
  const places = names.map((name) => POSITION.indexOf(name));
  const rowErrors = (state, row) => names.map((name, k) => printed[name][row] - state[places[k]]);
  for (let count = FIRST_ROWS; ; count = Math.min(2 * count, times.length)) {
    for (let step = 0; step < CLOCK_STEPS; step += 1) {
      let [above, below] = [0, 0];
      statesAt(count).forEach((state, row) => {
        rowErrors(state, row).forEach((error, k) => {
          const slope = times[row] * state[3 + places[k]];
          above += slope * error;
          below += slope * slope;
        });
      });
      rate += below ? above / below : 0;
    }
    if (!(rate > 0.5 && rate < 2)) return null;
    if (count === times.length) break;
  }

  const states = statesAt(times.length);
  const residual_m = farthest(states.map((state, row) => Math.hypot(...rowErrors(state, row))));
  const speed = rootMeanSquare(states.map((state, row) => times[row] * Math.hypot(state[3], state[4])));
  if (residual_m > residualLimit || !speed) return null;
  const value = fittedNumber(1 / rate, Math.max(residual_m, resolution) / speed);
  return { text: CLOCK_SAID.replace("{value}", value.text), residual_m };
}

// Whether a clock is likelier than the other meaning of g, which has no fitted number; as `likelier` of
// compare/diagnosis/claims.py.
function isLikelier(clock, gravity, { resolution }) {
  if (!gravity?.isNamed || !gravity.explains) return true;
  return NEEDED * Math.max(clock.residual_m, resolution) < gravity.residual_m;
}

// What the rows themselves show, as mistakesIn returns it: maps of columns, the other meaning of g, a clock.
function observed(columns, judged, truth, allowed) {
  const fileCase = observedCase(columns, judged, truth, allowed);
  const unjudged = `nothing finer than ${shortNumber(fileCase.noise, 1)} of its unit can be judged`;
  const rounded = fileCase.noise > allowed ? [`Your file prints ${fileCase.decimals} decimals: ${unjudged}.`] : [];
  const maps = observation(fileCase, truth);
  if (maps) {
    const text = `Your file ${maps.texts.join(", and it ")}: ${correctedTo(maps.residual_m, allowed)}`;
    return { notes: [...rounded, text], explained: maps.residual_m <= allowed, isNamed: true };
  }
  const gravity = gravityTrial(fileCase, truth);
  const clock = clockRate(fileCase, truth);
  if (clock && isLikelier(clock, gravity, fileCase)) {
    const alike = "A step error may look alike: the command tells more.";
    const text = `Perhaps your program ${clock.text}: ${correctedTo(clock.residual_m, allowed)} ${alike}`;
    return { notes: [...rounded, text], explained: clock.residual_m <= allowed, isNamed: true };
  }
  const notes = gravity?.isNamed ? [...rounded, gravity.text, gravity.advice] : rounded;
  return { notes, explained: Boolean(gravity?.isNamed && gravity.explains), gravity };
}
