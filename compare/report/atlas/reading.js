// Read a trajectory, or times of xdot = 0, from text, as compare/candidates does: header, units, separators, comments.
// `vocabulary` holds the words and patterns of names.py; what cannot be read throws Unreadable.
"use strict";

class Unreadable extends Error {}

const NUMBER = /^[+-]?(\d+(\.\d*)?|\.\d+)(e[+-]?\d+)?$/i;
const NOT_FINITE = /^[+-]?(nan|inf|infinity)$/i;
const HEXFLOAT = /^[+-]?0x[\da-f]+(\.[\da-f]*)?p[+-]?\d+$/i; // never read, but no word either
const COMMENT = /^(#|%|!|\/\/)/;
const FORTRAN = /([\d.])[dD](?=[+-]?\d)/g;
const MOST_DIGITS = 17; // of a double
const KNOWN = ["t", "x", "y", "z", "vx", "vy", "vz"];
const UNNAMED = { 3: KNOWN.slice(0, 3), 4: KNOWN.slice(0, 4), 7: KNOWN, 10: KNOWN.slice(0, 4) }; // 10: foucPend
const LONGEST = 100; // characters of a word of a header, whose patterns take the square of it
const BRACKETS = /^(.*?)\s*[(\[{<]\s*(.*?)\s*[)\]}>]$/;
const AFTER = /^(.*?)(?:\s*\/\s*|\s+in\s+|[\s_.]+)([^\s_/.]+(?:(?:\/|_per_|_)[^\s_/]+)?)$/;
const PER = /^(?:(\w+?)\s*(?:\/|_per_|\s+per\s+|_)\s*(\w+)|(\w+)\s*[·*⋅ ]?\s*(\w+?)\s*(?:\^?\s*[-−]1|⁻¹))$/;

const isNumber = (text) => NUMBER.test(text) || NOT_FINITE.test(text);
const whole = (source) => new RegExp(`^(?:${source})$`);

function plainUnit(word, vocabulary) {
  const plain = word.trim().toLowerCase().replace(/[µμ]/g, "u").replace(/^\.+|\.+$/g, "");
  return vocabulary.words[plain] ?? plain;
}

// The size of a unit in SI units, as [numerator, denominator]; undefined if it is none of its column.
function sizeOf(unit, column, vocabulary) {
  if (column === "t") return vocabulary.times[plainUnit(unit, vocabulary)];
  if (!column.startsWith("v")) return vocabulary.lengths[plainUnit(unit, vocabulary)];
  let word = unit.trim().toLowerCase().replace(/[µμ]/g, "u");
  word = word === "ms" ? "m/s" : vocabulary.speeds[word] ?? word;
  const parts = PER.exec(word);
  if (!parts) return undefined;
  const above = vocabulary.lengths[plainUnit(parts[1] ?? parts[3], vocabulary)];
  const below = vocabulary.times[plainUnit(parts[2] ?? parts[4], vocabulary)];
  return above && below && [above[0] * below[1], above[1] * below[0]];
}

const unquoted = (word) => word.trim().replace(/^(["'`])(.*)\1$/, "$2").trim();

// The column, sign and rank of a name without a unit: rank 0 is the column's own name, 2 another word.
function columnOf(name, vocabulary) {
  if (KNOWN.includes(name)) return { column: name, sign: 1, rank: 0 };
  if (KNOWN.includes(name.toLowerCase())) return { column: name.toLowerCase(), sign: 1, rank: 1 };
  const spelled = name.toLowerCase().normalize("NFD").replaceAll("\u0307", "dot").replace(/['’′]$/, "prime");
  const plain = spelled.replace(/[^\p{L}\p{N}]/gu, "");
  if (vocabulary.time.includes(plain)) return { column: "t", sign: 1, rank: 2 };
  for (const [source, speed] of [[vocabulary.position, ""], [vocabulary.velocity, "v"]]) {
    const match = whole(source).exec(plain);
    if (!match) continue;
    const given = match.slice(1).filter(Boolean);
    const last = given[given.length - 1];
    const [axis, sign] = vocabulary.axes[last];
    if (given.length > 1 && !(last in vocabulary.directions)) return undefined;
    return { column: speed + axis, sign, rank: 2 };
  }
  return undefined;
}

// What a word of a header means: {column, factor: [numerator, denominator] or undefined if unknown, unit, rank}.
function meaning(word, vocabulary) {
  const text = unquoted(word);
  if (text.length > LONGEST) return undefined;
  const brackets = BRACKETS.exec(text);
  const after = AFTER.exec(text);
  let ways = [[text, ""]];
  if (whole(vocabulary.timeUnits).test(text.toLowerCase())) ways.push(["t", text]);
  if (after) ways.push([after[1], after[2]]);
  if (brackets) ways = [[brackets[1], brackets[2]]];
  for (const [name, said] of ways) {
    const found = columnOf(name, vocabulary);
    if (!found) continue;
    let { column, sign, rank } = found;
    let unit = said;
    if (said === text) rank = 2; // it is called by its unit
    const turned = vocabulary.directions[said.toLowerCase()];
    if (turned && column !== "t") {
      column = column.slice(0, -1) + turned[0];
      [sign, unit, rank] = [turned[1], "", 2];
    }
    if (["t", "time"].includes(said.toLowerCase()) && column !== "t") unit = ""; // x(t)
    const size = unit ? sizeOf(unit, column, vocabulary) : [1, 1];
    if (size) return { column, factor: [size[0] * sign, size[1]], unit, rank };
    if (brackets) return { column, factor: undefined, unit, rank };
  }
  return undefined;
}

// How a line is written if it is a row, that is if most of its fields are numbers; else null.
function spelling(line) {
  let best = null;
  for (const comma of line.includes(",") ? [false, true] : [false]) {
    for (const separator of [",", ";", "\t", null]) {
      if ((separator !== null && !line.includes(separator)) || (comma && separator === ",")) continue;
      const fields = fieldsOf(line, { separator, comma });
      const count = fields.length - (fields[fields.length - 1] === "" ? 1 : 0);
      const share = fields.filter((field) => isNumber(field) || HEXFLOAT.test(field)).length / Math.max(1, count);
      if (share > (best ? best.share : 0)) best = { separator, comma, share };
    }
  }
  return best && best.share > 0.5 ? best : null;
}

function fieldsOf(line, { separator, comma }) {
  let plain = line.replaceAll('"', "").replace(FORTRAN, "$1e");
  if (comma) plain = plain.replaceAll(",", ".");
  return separator === null ? plain.trim().split(/\s+/) : plain.split(separator).map((field) => field.trim());
}

// The ways to take a header apart, the most likely first.
function wordsOf(line) {
  const ways = [",", ";", "\t"].filter((separator) => line.includes(separator)).map((one) => line.split(one));
  const bare = line.trim();
  ways.push(bare.split(/\s{2,}|\t/), bare.replace(/(?<!\s)\s+(?=[(\[{])/g, "").split(/\s+/), bare.split(/\s+/));
  return ways.map((way) => (way.length > 1 && !way[way.length - 1].trim() ? way.slice(0, -1) : way));
}

// The words of the header among the lines above the first row, or those that the number of columns stands for.
function headerOf(above, count, needed, vocabulary) {
  const columns = (way) => new Set(way.map((word) => meaning(word, vocabulary)?.column).filter(Boolean));
  const complete = (way) => needed.every((name) => columns(way).has(name));
  for (const { text, comment, number } of above.slice().reverse()) {
    const ways = wordsOf(text);
    const fitting = ways.filter((way) => way.length === count);
    const few = comment ? Math.max(Math.min(2, needed.length), Math.floor(count / 2)) : 0;
    const other = (way) => complete(way) && (!comment || columns(way).size === way.length);
    const found = fitting.find(complete) ?? ways.find(other) ?? fitting.find((way) => columns(way).size >= few);
    if (!found) continue;
    if (found.length !== count) {
      throw new Unreadable(`The first row has ${count} fields, and the header in line ${number} has ${found.length}.`);
    }
    return found;
  }
  if (needed.length === 1 && count === 1 && !above.length) return ["t"];
  const names = needed.length > 1 && UNNAMED[count];
  if (!names) throw new Unreadable(`No line names the columns: let the first be ${needed.join(",")}.`);
  return [...names, ...Array(count - names.length).fill("-")];
}

// Which column stands where, and by what it comes to SI units.
function layoutOf(words, needed, vocabulary) {
  const meanings = words.map((word) => meaning(word, vocabulary));
  const places = {};
  for (const name of KNOWN) {
    const found = meanings.flatMap((one, i) => (one && one.column === name ? [i] : []));
    const rank = Math.min(...found.map((i) => meanings[i].rank));
    const best = found.filter((i) => meanings[i].rank === rank);
    if (best.length > 1) throw new Unreadable(`Two columns are ${name}: ${best.map((i) => words[i].trim()).join(", ")}.`);
    if (!best.length && needed.includes(name)) {
      throw new Unreadable(`There is no column ${name} in ${words.map((word) => word.trim()).join(", ").slice(0, 80)}.`);
    }
    if (!best.length) continue;
    const one = meanings[best[0]];
    if (!one.factor) throw new Unreadable(`The unit ${one.unit} of ${name} is not known: write s, m or m/s.`);
    places[name] = { at: best[0], factor: one.factor };
  }
  return places;
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
    if (COMMENT.test(line)) {
      const comment = line.replace(COMMENT, "").trim();
      if (!places) above.push({ text: comment, comment: true, number: i + 1 });
      onComment(comment, i + 1);
      return;
    }
    if (!places) {
      spelled = spelling(line);
      if (!spelled) {
        above.push({ text: line, comment: false, number: i + 1 });
        if (above.length > 1000) throw new Unreadable(`Line ${i + 1} is no row of numbers, and none is before it.`);
        return;
      }
      const fields = fieldsOf(line, spelled);
      width = fields.length;
      const count = width - (width > 1 && fields[width - 1] === "" ? 1 : 0);
      places = layoutOf(headerOf(above, count, needed, vocabulary), needed, vocabulary);
      for (const name of Object.keys(places)) columns[name] = [];
    }
    const fields = fieldsOf(line, spelled);
    if (fields.length !== width) {
      throw new Unreadable(`Line ${i + 1} has ${fields.length} fields, and the first row has ${width}. Is it cut off?`);
    }
    for (const [name, { at, factor }] of Object.entries(places)) {
      const field = fields[at];
      if (!isNumber(field)) throw new Unreadable(`Line ${i + 1}: ${field.slice(0, 40) || "nothing"} is no number (${name}).`);
      const value = (Number(field) * factor[0]) / factor[1];
      if (!(Math.abs(value) <= 1e100)) throw new Unreadable(`Line ${i + 1}: ${name} is ${field}. The run failed there.`);
      finer ||= field.replace(/e.*/i, "").replace(/^[+-]?[0.]*/, "").replace(".", "").length > MOST_DIGITS;
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
