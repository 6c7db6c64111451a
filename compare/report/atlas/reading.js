// Read a trajectory, or times of xdot = 0, from text, as compare/candidates does: header, units, separators, comments.
// `vocabulary` holds its tables of words and units, its patterns and limits by their names there (parts.py); what cannot
// be read throws Unreadable.
"use strict";

class Unreadable extends Error {}

const NUMBER = /^[+-]?(\d+(\.\d*)?|\.\d+)(e[+-]?\d+)?$/i;
const NOT_FINITE = /^[+-]?(nan|inf|infinity)$/i;

const isNumber = (text) => NUMBER.test(text) || NOT_FINITE.test(text);
const patterns = new Map();

// The pattern of a source, made once; `whole` is one of all of a text.
function pattern(source, flags = "") {
  const key = `${flags}/${source}`;
  if (!patterns.has(key)) patterns.set(key, new RegExp(source, flags));
  return patterns.get(key);
}

const whole = (source, flags = "") => pattern(`^(?:${source})$`, flags);
const allColumns = (vocabulary) => vocabulary.UNNAMED[7]; // t, x, y, z, vx, vy, vz

function plainUnit(word, vocabulary) {
  const plain = word.trim().toLowerCase().replace(/[µμ]/g, "u").replace(/^\.+|\.+$/g, "");
  return vocabulary.OTHER_WORDS[plain] ?? plain;
}

// The size of a unit in SI units, as [numerator, denominator]; undefined if it is none of its column.
function sizeOf(unit, column, vocabulary) {
  if (column === "t") return vocabulary.TIMES[plainUnit(unit, vocabulary)];
  if (!column.startsWith("v")) return vocabulary.LENGTHS[plainUnit(unit, vocabulary)];
  let word = unit.trim().toLowerCase().replace(/[µμ]/g, "u");
  word = word === "ms" ? "m/s" : vocabulary.SHORT_SPEEDS[word] ?? word;
  const parts = whole(vocabulary.PER).exec(word);
  if (!parts) return undefined;
  const above = vocabulary.LENGTHS[plainUnit(parts[1] ?? parts[3], vocabulary)];
  const below = vocabulary.TIMES[plainUnit(parts[2] ?? parts[4], vocabulary)];
  return above && below && [above[0] * below[1], above[1] * below[0]];
}

const unquoted = (word) => word.trim().replace(/^(["'`])(.*)\1$/, "$2").trim();

// The column, sign and rank of a name without a unit: rank 0 is the column's own name, 2 another word.
function columnOf(name, vocabulary) {
  if (allColumns(vocabulary).includes(name)) return { column: name, sign: 1, rank: 0 };
  if (allColumns(vocabulary).includes(name.toLowerCase())) return { column: name.toLowerCase(), sign: 1, rank: 1 };
  const spelled = name.toLowerCase().normalize("NFD").replaceAll("\u0307", "dot").replace(/['’′]$/, "prime");
  const plain = spelled.replace(/[^\p{L}\p{N}]/gu, "");
  if (vocabulary.TIME_WORDS.includes(plain)) return { column: "t", sign: 1, rank: 2 };
  for (const [source, speed] of [[vocabulary.POSITION, ""], [vocabulary.VELOCITY, "v"]]) {
    const match = whole(source).exec(plain);
    if (!match) continue;
    const given = match.slice(1).filter(Boolean);
    const last = given[given.length - 1];
    const [axis, sign] = vocabulary.AXES[last];
    if (given.length > 1 && !(last in vocabulary.DIRECTIONS)) return undefined;
    return { column: speed + axis, sign, rank: 2 };
  }
  return undefined;
}

// What a word of a header means: {column, factor: [numerator, denominator] or undefined if unknown, unit, rank}.
function meaning(word, vocabulary) {
  const text = unquoted(word);
  if (text.length > vocabulary.LONGEST) return undefined;
  const brackets = whole(vocabulary.BRACKETS).exec(text);
  const after = whole(vocabulary.AFTER).exec(text);
  let ways = [[text, ""]];
  if (whole(vocabulary.TIME_UNITS).test(text.toLowerCase())) ways.push(["t", text]);
  if (after) ways.push([after[1], after[2]]);
  if (brackets) ways = [[brackets[1], brackets[2]]];
  for (const [name, suffix] of ways) {
    const named = columnOf(name, vocabulary);
    if (!named) continue;
    let { column, sign, rank } = named;
    let unit = suffix;
    if (suffix === text) rank = 2; // it is called by its unit
    const turned = vocabulary.DIRECTIONS[suffix.toLowerCase()];
    if (turned && column !== "t") {
      column = column.slice(0, -1) + turned[0];
      [sign, unit, rank] = [turned[1], "", 2];
    }
    if (["t", "time"].includes(suffix.toLowerCase()) && column !== "t") unit = ""; // x(t)
    const size = unit ? sizeOf(unit, column, vocabulary) : [1, 1];
    if (size) return { column, factor: [size[0] * sign, size[1]], unit, rank };
    if (brackets) return { column, factor: undefined, unit, rank };
  }
  return undefined;
}

// How a line is written if it is a row, that is if most of its fields are numbers; else null.
function spelling(line, vocabulary) {
  let best = null;
  const hexfloat = whole(vocabulary.HEXFLOAT, "i"); // never read, but no word either
  for (const comma of line.includes(",") ? [false, true] : [false]) {
    for (const separator of [",", ";", "\t", null]) {
      if ((separator !== null && !line.includes(separator)) || (comma && separator === ",")) continue;
      const fields = fieldsOf(line, { separator, comma }, vocabulary);
      const count = fields.length - (fields[fields.length - 1] === "" ? 1 : 0);
      const share = fields.filter((field) => isNumber(field) || hexfloat.test(field)).length / Math.max(1, count);
      if (share > (best ? best.share : 0)) best = { separator, comma, share };
    }
  }
  return best && best.share > 0.5 ? best : null;
}

function fieldsOf(line, { separator, comma }, vocabulary) {
  let plain = line.replaceAll('"', "").replace(pattern(vocabulary.FORTRAN, "g"), "e");
  if (comma) plain = plain.replaceAll(",", ".");
  return separator === null ? plain.trim().split(/\s+/) : plain.split(separator).map((field) => field.trim());
}

// The ways to take a header apart, the most likely first.
function wordsOf(line, vocabulary) {
  const ways = [",", ";", "\t"].filter((separator) => line.includes(separator)).map((separator) => line.split(separator));
  const bare = line.trim();
  const joined = bare.replace(pattern(vocabulary.BEFORE_BRACKET, "g"), "");
  ways.push(bare.split(pattern(vocabulary.APART)), joined.split(/\s+/), bare.split(/\s+/));
  return ways.map((way) => (way.length > 1 && !way[way.length - 1].trim() ? way.slice(0, -1) : way));
}

// The words of the header among the lines above the first row, or those that the number of columns stands for.
function headerOf(above, count, needed, vocabulary) {
  const columns = (way) => new Set(way.map((word) => meaning(word, vocabulary)?.column).filter(Boolean));
  const complete = (way) => needed.every((name) => columns(way).has(name));
  for (const { text, comment, number } of above.slice().reverse()) {
    const ways = wordsOf(text, vocabulary);
    const fitting = ways.filter((way) => way.length === count);
    const enough = comment ? Math.max(Math.min(vocabulary.FEW, needed.length), Math.floor(count / 2)) : 0;
    const other = (way) => complete(way) && (!comment || columns(way).size === way.length);
    const header = fitting.find(complete) ?? ways.find(other) ?? fitting.find((way) => columns(way).size >= enough);
    if (!header) continue;
    if (header.length !== count) {
      throw new Unreadable(`The first row has ${count} fields, and the header in line ${number} has ${header.length}.`);
    }
    return { words: header, conventions: [] };
  }
  if (needed.length === 1 && count === 1 && !above.length) return { words: ["t"], conventions: [] };
  const names = needed.length > 1 && vocabulary.UNNAMED[count];
  if (!names) throw new Unreadable(`No line names the columns: let the first be ${needed.join(",")}.`);
  const conventions = [`no header: the columns are taken as ${names.join(", ")}`];
  return { words: [...names, ...Array(count - names.length).fill("-")], conventions };
}

// Which column stands where, and by what it comes to SI units.
function layoutOf(words, needed, vocabulary) {
  const meanings = words.map((word) => meaning(word, vocabulary));
  const layout = {};
  for (const name of allColumns(vocabulary)) {
    const places = meanings.flatMap((meant, i) => (meant && meant.column === name ? [i] : []));
    const rank = Math.min(...places.map((i) => meanings[i].rank));
    const best = places.filter((i) => meanings[i].rank === rank);
    if (best.length > 1) throw new Unreadable(`Two columns are ${name}: ${best.map((i) => words[i].trim()).join(", ")}.`);
    if (!best.length && needed.includes(name)) {
      throw new Unreadable(`There is no column ${name} in ${words.map((word) => word.trim()).join(", ").slice(0, 80)}.`);
    }
    if (!best.length) continue;
    const meant = meanings[best[0]];
    if (!meant.factor) throw new Unreadable(`The unit ${meant.unit} of ${name} is not known: write s, m or m/s.`);
    layout[name] = { ...meant, at: best[0], word: unquoted(words[best[0]]) };
  }
  return layout;
}

// What is to be said of a header: columns by other names, those not read, units converted; as names.py says it.
function conventionsOf(words, places, vocabulary) {
  const read = Object.values(places);
  const renamed = read.filter(({ rank }) => rank === 2).map(({ word, factor, column }) => `${word} as ${factor[0] < 0 ? "-" : ""}${column}`);
  const skipped = words.filter((word, i) => !read.some(({ at }) => at === i)).map(unquoted);
  const unread = skipped.filter((word) => !vocabulary.SKIPPED.includes(word)).join(", ");
  const units = read.filter(({ factor }) => Math.abs(factor[0]) !== factor[1]).map(({ column, unit }) => `${column} from ${unit}`);
  const conventions = renamed.length ? [renamed.join(", ") + (unread && `; not read: ${unread}`)] : [];
  return units.length ? [...conventions, `${units.join(", ")}, converted to SI units`] : conventions;
}

// Read columns of a text: {t: […], x: […], …} in SI units, and notes. `needed` columns must be there, times first.
function readColumns(text, needed, vocabulary, onComment = () => {}) {
  if (text.includes("\0")) throw new Unreadable("This is no text: a CSV file is wanted.");
  const above = [];
  const columns = {};
  const notes = [];
  let [spelled, places, width, rows, finer] = [null, null, 0, 0, false];
  text.replace(/^\ufeff/, "").split(/\r?\n/).forEach((raw, i) => {
    const line = raw.trim();
    if (!line) return;
    const remark = whole(vocabulary.COMMENT, "s").exec(line);
    if (remark) {
      if (!places) above.push({ text: remark[1], comment: true, number: i + 1 });
      onComment(remark[1], i + 1);
      return;
    }
    if (!places) {
      spelled = spelling(line, vocabulary);
      if (!spelled) {
        above.push({ text: line, comment: false, number: i + 1 });
        if (above.length > vocabulary.MOST) throw new Unreadable(`Line ${i + 1} is no row of numbers, and none is before it.`);
        return;
      }
      const fields = fieldsOf(line, spelled, vocabulary);
      width = fields.length;
      const count = width - (width > 1 && fields[width - 1] === "" ? 1 : 0);
      const { words, conventions } = headerOf(above, count, needed, vocabulary);
      places = layoutOf(words, needed, vocabulary);
      const comma = spelled.comma ? [vocabulary.DECIMAL_COMMA] : [];
      notes.push(...[...conventions, ...conventionsOf(words, places, vocabulary), ...comma].map((text) => `Reading: ${text}.`));
      for (const name of Object.keys(places)) columns[name] = [];
    }
    const fields = fieldsOf(line, spelled, vocabulary);
    if (fields.length !== width) {
      throw new Unreadable(`Line ${i + 1} has ${fields.length} fields, and the first row has ${width}. Is it cut off?`);
    }
    for (const [name, { at, factor }] of Object.entries(places)) {
      const field = fields[at];
      if (!isNumber(field)) throw new Unreadable(`Line ${i + 1}: ${field.slice(0, 40) || "nothing"} is no number (${name}).`);
      const value = (Number(field) * factor[0]) / factor[1];
      if (!(Math.abs(value) <= vocabulary.LARGEST)) throw new Unreadable(`Line ${i + 1}: ${name} is ${field}. The run failed there.`);
      finer ||= field.replace(/e.*/i, "").replace(/^[+-]?[0.]*/, "").replace(".", "").length > vocabulary.DOUBLE_DIGITS;
      columns[name].push(value);
    }
    rows += 1;
  });
  if (!rows) throw new Unreadable("There are no rows of numbers.");
  if (finer) notes.push("Numbers of more than 17 digits are rounded to doubles here; foucault score reads all of them.");
  return { columns, notes };
}

// Read a trajectory: {columns, transits (null if there are none), notes}.
function readTrajectory(text, vocabulary) {
  const transits = [];
  const { columns, notes } = readColumns(text, ["t", "x", "y"], vocabulary, (comment, number) => {
    const words = comment.split(/\s+/);
    if (words[0] !== "P") return; // a transit of foucPend: # P, a count, a time in s, a frequency
    if (!NUMBER.test(words[2] ?? "")) throw new Unreadable(`Line ${number}: a transit without a time.`);
    transits.push(Number(words[2]));
  });
  checkTimes(columns.t, "increase", (before, after) => after > before);
  checkTimes(transits, "not decrease", (before, after) => after >= before);
  return { columns, transits: transits.length ? transits : null, notes };
}

// Read times of xdot = 0 in s: they may be equal, and each but one of equal ones is an extra transit.
function readTransits(text, vocabulary) {
  const { columns, notes } = readColumns(text, ["t"], vocabulary);
  checkTimes(columns.t, "not decrease", (before, after) => after >= before);
  return { transits: columns.t, notes };
}

function checkTimes(times, word, inOrder) {
  if (times[0] < 0) throw new Unreadable(`The first time is ${times[0]} s: times begin at 0.`);
  for (let i = 1; i < times.length; i += 1) {
    if (!inOrder(times[i - 1], times[i])) {
      throw new Unreadable(`Row ${i + 1}: t = ${times[i]} after ${times[i - 1]}. Times have to ${word}.`);
    }
  }
}
