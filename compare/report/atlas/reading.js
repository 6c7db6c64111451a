// Read a trajectory, or times of xdot = 0, from text, as compare/candidates does: the same rules, once more.
// `vocabulary` holds its tables of words and units, its patterns and limits by their names there (parts.py); what cannot
// be read throws Unreadable. tests/compare/candidates/spellings.py lists texts that both must read alike.
"use strict";

class Unreadable extends Error {}

const patterns = new Map();

// The pattern of a source, made once; `whole` is one of all of a text.
function pattern(source, flags = "") {
  const key = `${flags}/${source}`;
  if (!patterns.has(key)) patterns.set(key, new RegExp(source, flags));
  return patterns.get(key);
}

const whole = (source, flags = "") => pattern(`^(?:${source})$`, flags);
const allColumns = (vocabulary) => vocabulary.UNNAMED[7]; // t, x, y, z, vx, vy, vz
const stripped = (text, characters) => [...text].every((letter) => characters.includes(letter));
const unquoted = (word) => word.trim().replace(/^(["'`])(.*)\1$/, "$2").trim();

// Fields: compare/candidates/text.py.

const isNumber = (text, vocabulary) => whole(vocabulary.NUMBER).test(text) || whole(vocabulary.NOT_FINITE, "i").test(text);
const isClock = (text, vocabulary) => whole(vocabulary.CLOCK).test(text) || whole(vocabulary.MOMENT).test(text);
const isMissing = (text, vocabulary) => vocabulary.MISSING.includes(text.toLowerCase());
const isGrouped = (text, vocabulary) => whole(vocabulary.GROUPED).test(text);

// A line that has no field, or is drawn.
function saysNothing(line, vocabulary) {
  const text = line.trim();
  return stripped(text, vocabulary.EMPTY) || (text.includes("---") && stripped(text, vocabulary.RULE));
}

function unquotedField(field) {
  const text = field.trim();
  return text.length > 1 && text.startsWith('"') && text.endsWith('"') ? text.slice(1, -1).replaceAll('""', '"').trim() : text;
}

// The fields of a line; a field in quotes may hold the separator, which is white space if empty.
function split(text, separator, vocabulary) {
  const quotes = text.split('"').length - 1;
  const line = quotes % 2 ? text.replaceAll('"', "") : text;
  if (!line.includes('"')) {
    return separator ? line.split(separator).map((field) => field.trim()) : line.split(/\s+/).filter(Boolean);
  }
  if (!separator) return [...line.matchAll(pattern(vocabulary.QUOTED_WORD, "g"))].map((match) => unquotedField(match[0]));
  const mark = separator === "|" ? "\\|" : separator;
  const fields = (line + separator).matchAll(pattern(`((?:"[^"]*"|[^"${mark}])*)${mark}`, "g"));
  return [...fields].map((match) => unquotedField(match[1]));
}

// The separators under which most fields of a line are numbers, the likeliest first.
function possibleSeparators(line, vocabulary) {
  const isOne = (field) => isNumber(field, vocabulary) || isClock(field, vocabulary) || whole(vocabulary.HEXFLOAT, "i").test(field);
  const candidates = [];
  for (const separator of vocabulary.SEPARATORS) {
    if (!line.includes(separator)) continue;
    const fields = split(line, separator, vocabulary).filter((field) => !isMissing(field, vocabulary));
    const share = fields.filter(isOne).length / Math.max(1, fields.length);
    if (share > 0.5) candidates.push({ separator, share });
  }
  return candidates.sort((one, other) => other.share - one.share).map(({ separator }) => separator);
}

function withoutEnd(fields) {
  let end = fields.length;
  while (end > 1 && !fields[end - 1].trim()) end -= 1;
  return fields.slice(0, end);
}

// The ways to take a header apart, the most likely first.
function wordsOf(line, vocabulary) {
  const marks = vocabulary.SEPARATORS.filter((separator) => separator && line.includes(separator));
  const joined = line.replace(pattern(vocabulary.BEFORE_BRACKET, "g"), "");
  const ways = marks.map((separator) => split(line, separator, vocabulary));
  ways.push(line.trim().split(pattern(vocabulary.APART)), split(joined, "", vocabulary), split(line, "", vocabulary));
  return ways.map(withoutEnd);
}

const plain = (number, vocabulary) => number.replaceAll(",", ".").replace(pattern(vocabulary.FORTRAN, "g"), "e");

// The number in a field; Number knows no inf.
function valueOf(field, vocabulary) {
  if (!whole(vocabulary.NOT_FINITE, "i").test(field)) return Number(plain(field, vocabulary));
  if (/nan/i.test(field)) return NaN;
  return field.startsWith("-") ? -Infinity : Infinity;
}

// A number whose mark may be decimal or may separate thousands; undefined if the numbers decide it.
function doubtfulNumber(columns, commasSeparate, vocabulary) {
  const [examples, proven] = [{}, new Set()];
  let wholeBesidePoint = false;
  for (const column of columns) {
    const marked = column.filter((number) => /[.,]/.test(number));
    const grouped = marked.filter((number) => isGrouped(number, vocabulary));
    for (const number of grouped) examples[number.includes(",") ? "," : "."] ??= number;
    for (const number of marked) if (!isGrouped(number, vocabulary)) proven.add(number.includes(",") ? "," : ".");
    wholeBesidePoint ||= grouped.length > 0 && grouped.length < column.length;
  }
  if (examples[","] && !proven.has(",")) return examples[","];
  if (!examples["."] || proven.has(".")) return undefined;
  return proven.has(",") || (wholeBesidePoint && !commasSeparate) ? examples["."] : undefined;
}

// Names and units: compare/candidates/names.py.

function plainUnit(word, vocabulary) {
  const bare = word.trim().toLowerCase().replace(/[µμ]/g, "u").replace(/^\.+|\.+$/g, "");
  return vocabulary.OTHER_WORDS[bare] ?? bare;
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

// The column, sign and rank of a name without a unit: rank 0 is the column's own name, 2 another word.
function columnOf(name, vocabulary) {
  if (allColumns(vocabulary).includes(name)) return { column: name, sign: 1, rank: 0 };
  if (allColumns(vocabulary).includes(name.toLowerCase())) return { column: name.toLowerCase(), sign: 1, rank: 1 };
  const spelled = name.toLowerCase().normalize("NFD").replaceAll("\u0307", "dot").replace(/['’′]$/, "prime");
  const bare = spelled.replace(/[^\p{L}\p{N}]/gu, "");
  if (vocabulary.TIME_WORDS.includes(bare)) return { column: "t", sign: 1, rank: 2 };
  for (const [source, speed] of [[vocabulary.POSITION, ""], [vocabulary.VELOCITY, "v"]]) {
    const match = whole(source).exec(bare);
    if (!match) continue;
    const given = match.slice(1).filter(Boolean);
    const last = given[given.length - 1];
    const [axis, sign] = vocabulary.AXES[last];
    if (given.length > 1 && !(last in vocabulary.DIRECTIONS)) return undefined;
    return { column: speed + axis, sign, rank: 2 };
  }
  return undefined;
}

// The ways to take a text apart into a name and a unit, which may be empty.
function withUnit(text, vocabulary) {
  const brackets = whole(vocabulary.BRACKETS).exec(text);
  if (brackets) return [[brackets[1], brackets[2]]];
  const ways = [[text, ""]];
  if (whole(vocabulary.TIME_UNITS).test(text.toLowerCase())) ways.push(["t", text]);
  for (const source of [vocabulary.AFTER, vocabulary.LAST]) {
    const parts = whole(source).exec(text);
    if (parts) ways.push([parts[1], parts[2]]);
  }
  return ways;
}

// The ways to take a word apart into a name, a unit and a direction, the most likely first.
function partsOf(text, vocabulary) {
  const ways = [];
  for (const [name, last] of withUnit(text, vocabulary)) {
    if (!(last.toLowerCase() in vocabulary.DIRECTIONS)) continue;
    ways.push(...withUnit(name, vocabulary).map(([before, unit]) => [before, unit, last]));
  }
  return [...ways, ...withUnit(text, vocabulary).map(([name, unit]) => [name, unit, ""])];
}

// What a word of a header means: {column, factor: [numerator, denominator] or undefined if unknown, unit, rank}.
function meaning(word, vocabulary) {
  const long = unquoted(word);
  if (long.length > vocabulary.LONGEST || /[,;|]$/.test(long)) return undefined; // what ends so is a part of a line
  const text = whole(vocabulary.LABEL, "i").exec(long)?.[1] ?? long;
  for (const [name, suffix, direction] of partsOf(text, vocabulary)) {
    const named = columnOf(name, vocabulary);
    if (!named) continue;
    let { column, sign, rank } = named;
    let unit = suffix;
    if (suffix === text) rank = 2; // it is called by its unit
    if (direction) {
      if (column === "t") continue;
      const turned = vocabulary.DIRECTIONS[direction.toLowerCase()];
      column = column.slice(0, -1) + turned[0];
      [sign, rank] = [turned[1], 2];
    }
    if (["t", "time"].includes(suffix.toLowerCase()) && column !== "t") unit = ""; // x(t)
    const size = unit ? sizeOf(unit, column, vocabulary) : [1, 1];
    if (size) return { column, factor: [size[0] * sign, size[1]], unit, rank };
    if (whole(vocabulary.BRACKETS).test(text)) return { column, factor: undefined, unit, rank };
  }
  return undefined;
}

// A unit without brackets and quotes; nothing for a word that stands for none.
function bareUnit(printed, vocabulary) {
  const text = unquoted(printed);
  const bare = /^[([{<].*[)\]}>]$/.test(text) ? text.slice(1, -1).trim() : text;
  return vocabulary.SKIPPED.includes(bare) || vocabulary.TYPES.includes(bare.toLowerCase()) ? "" : bare;
}

// The units of a line that holds nothing else, one for each word; undefined for another line.
function unitsOf(words, vocabulary) {
  const units = words.map((word) => bareUnit(word, vocabulary));
  const isOfColumn = (unit) => ["t", "x", "vx"].some((column) => sizeOf(unit, column, vocabulary));
  const isOtherUnit = (unit) => !unit || vocabulary.OTHER_UNITS.includes(plainUnit(unit, vocabulary));
  if (!units.every((unit) => isOfColumn(unit) || isOtherUnit(unit))) return undefined;
  const typed = words.some((word) => vocabulary.TYPES.includes(unquoted(word).toLowerCase()));
  return units.some(isOfColumn) || typed ? units : undefined;
}

const sameSize = (one, other) => one[0] * other[1] === other[0] * one[1];

// What a word means if a line of units names a unit for it.
function withLineOfUnits(meant, word, printed, vocabulary) {
  const unit = bareUnit(printed, vocabulary);
  if (!meant || !unit) return meant;
  const size = sizeOf(unit, meant.column, vocabulary);
  if (!size) return { ...meant, factor: undefined, unit };
  if (meant.unit && meant.factor && !sameSize([Math.abs(meant.factor[0]), meant.factor[1]], size)) {
    throw new Unreadable(`The header says ${meant.unit} of ${word.trim()}, and the line of units ${unit}: leave one of them out.`);
  }
  return { ...meant, factor: [size[0] * (meant.factor && meant.factor[0] < 0 ? -1 : 1), size[1]], unit };
}

// Which column stands where, and by what it comes to SI units.
function layoutOf(words, needed, vocabulary, units = []) {
  const named = words.map((word) => meaning(word, vocabulary));
  const meanings = units.length ? named.map((meant, i) => withLineOfUnits(meant, words[i], units[i], vocabulary)) : named;
  const layout = {};
  for (const name of needed.length > 1 ? allColumns(vocabulary) : needed) {
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

// What is to be said of a header: columns by other names, those not read, units converted.
function conventionsOf(words, places, vocabulary) {
  const read = Object.values(places);
  const renamed = read.filter(({ rank }) => rank === 2).map(({ word, factor, column }) => `${word} as ${factor[0] < 0 ? "-" : ""}${column}`);
  const skipped = words.filter((word, i) => !read.some(({ at }) => at === i)).map(unquoted);
  const unread = skipped.filter((word) => !vocabulary.SKIPPED.includes(word)).join(", ");
  const units = read.filter(({ factor }) => Math.abs(factor[0]) !== factor[1]).map(({ column, unit }) => `${column} from ${unit}`);
  const conventions = renamed.length ? [renamed.join(", ") + (unread && `; not read: ${unread}`)] : [];
  return units.length ? [...conventions, `${units.join(", ")}, converted to SI units`] : conventions;
}

// The lines above the first row: compare/candidates/header.py. A line is {text, comment, number}.

const columnsNamed = (way, vocabulary) => new Set(way.map((word) => meaning(word, vocabulary)?.column).filter(Boolean));
const namesAll = (way, needed, vocabulary) => needed.every((name) => columnsNamed(way, vocabulary).has(name));

// The ways to take a line apart; where one names all columns that are needed, no less likely one.
function likelyWays(line, needed, vocabulary) {
  const ways = wordsOf(line.text, vocabulary);
  const explicit = vocabulary.SEPARATORS.filter((separator) => separator && line.text.includes(separator)).length;
  const tiers = [ways.slice(0, explicit), ...ways.slice(explicit).map((way) => [way])];
  return tiers.find((tier) => tier.some((way) => namesAll(way, needed, vocabulary))) ?? ways;
}

function namedBy(line, count, needed, vocabulary) {
  const ways = likelyWays(line, needed, vocabulary);
  const fitting = ways.filter((way) => way.length === count);
  const other = (way) => namesAll(way, needed, vocabulary) && (!line.comment || columnsNamed(way, vocabulary).size === way.length);
  const enough = line.comment ? Math.max(Math.min(vocabulary.FEW, needed.length), Math.floor(count / 2)) : 0;
  const complete = fitting.find((way) => namesAll(way, needed, vocabulary));
  return complete ?? ways.find(other) ?? fitting.find((way) => columnsNamed(way, vocabulary).size >= enough);
}

// The units in a line that holds nothing else, one for each column; undefined for another line.
function lineOfUnits(line, count, vocabulary) {
  const text = line.text.replace(pattern(`^${vocabulary.UNITS_LABEL}`, "i"), "");
  const ways = vocabulary.SEPARATORS.map((separator) => split(text, separator, vocabulary));
  const fitting = ways.filter((fields) => fields.length >= count && fields.slice(count).every((field) => !field));
  return fitting.map((fields) => unitsOf(fields.slice(0, count), vocabulary)).find(Boolean);
}

// The place and the words of the last line that names the columns, or is meant to; null if none does.
function headerOf(lines, least, most, needed, vocabulary) {
  const ways = lines.map((line) => likelyWays(line, needed, vocabulary));
  const complete = ways.map((of) => new Set(of.filter((way) => namesAll(way, needed, vocabulary)).map((way) => way.length)));
  const first = complete.findIndex((counts) => counts.size);
  for (let i = lines.length - 1; i >= 0; i -= 1) {
    const counts = new Set([...ways[i].map((way) => way.length), least]);
    const fitting = [...counts].filter((count) => least <= count && count <= most).sort((one, other) => other - one);
    const below = first >= 0 && i > first;
    if (below && fitting.some((count) => complete[first].has(count) && lineOfUnits(lines[i], count, vocabulary))) continue;
    const count = fitting.find((candidate) => complete[i].has(candidate)) ?? least;
    const header = namedBy(lines[i], count, needed, vocabulary);
    if (header) return { i, header };
  }
  return null;
}

// The units in the line below the header in line `i`, or in that above it; none if neither has any.
function unitsBeside(lines, i, count, vocabulary) {
  const beside = lines.filter((_, k) => k > i || k === i - 1);
  const [first, ...others] = beside.map((line) => lineOfUnits(line, count, vocabulary)).filter(Boolean);
  const other = others.find((units) => units.join() !== first.join());
  if (other) throw new Unreadable(`There are two lines of units, ${first.join(", ")} and ${other.join(", ")}: leave one out.`);
  if (first) return first;
  for (const line of lines) {
    const label = pattern(`^${vocabulary.UNITS_LABEL}`, "i").exec(line.text);
    const unlabelled = label ? line.text.slice(label[0].length) : line.text;
    const words = unlabelled.replace(/^[ \t,;|]+|[ \t,;|]+$/g, "").split(/[\s,;|]+/);
    const units = (label || !line.comment || words.length > 1) && unitsOf(words, vocabulary);
    if (units && units.some((unit) => !vocabulary.SI_UNITS.includes(unit))) {
      throw new Unreadable(`Line ${line.number} names units, but not one for each column: write them into the header.`);
    }
  }
  return [];
}

// The names in a header without a label such as "Columns:" before them.
function withoutLabel(names) {
  const [first, ...others] = names;
  const isLabel = first.endsWith(":") && !others.some((name) => name.endsWith(":"));
  return isLabel && others.length ? others : names;
}

// Refuse a comment that names columns, but not as many as there are, or in another order or unit than taken.
function refuseOtherComment(lines, names, count, needed, vocabulary) {
  for (const line of lines) {
    const marks = vocabulary.SEPARATORS.filter((mark) => mark && line.text.includes(mark));
    const separated = new Set(marks.map((mark) => withoutEnd(split(line.text, mark, vocabulary)).join("\n")));
    for (const way of wordsOf(line.text, vocabulary)) {
      const words = withoutLabel(way);
      const meanings = words.map((word) => meaning(word, vocabulary)).filter(Boolean);
      const named = meanings.map(({ column }) => column);
      if (!needed.every((name) => named.includes(name)) || 2 * named.length < words.length) continue;
      const same = named.join() === names.join() && meanings.every(({ factor }) => factor && factor[0] === factor[1]);
      if (same && !separated.has(way.join("\n"))) continue;
      throw new Unreadable(`The first row has ${count} fields, and the header in line ${line.number} has ${words.length}.`);
    }
  }
}

// {words, places, width, conventions} of a first row, from it and the lines above it.
function layoutAbove(lines, row, separator, number, needed, vocabulary) {
  const fields = split(row, separator, vocabulary);
  const least = withoutEnd(fields).length;
  const placed = headerOf(lines, least, fields.length, needed, vocabulary);
  if (placed) {
    const { i } = placed;
    const header = withoutLabel(placed.header);
    const width = header.length;
    if (width < least || width > fields.length) {
      const commas = separator === "," && width < least && least <= 2 * width ? ` ${vocabulary.COMMAS}` : "";
      throw new Unreadable(`The first row has ${least} fields, and the header in line ${lines[i].number} has ${width}.${commas}`);
    }
    const above = lines.slice(0, i).find((line) => !line.comment && wordsOf(line.text, vocabulary).some((way) => way.length === width && namesAll(way, needed, vocabulary)));
    if (above && !namesAll(header, needed, vocabulary)) {
      throw new Unreadable(`Line ${lines[i].number}, ${header.join(", ").slice(0, 80)}, is neither a row nor units of the header in line ${above.number}.`);
    }
    const places = layoutOf(header, needed, vocabulary, unitsBeside(lines, i, width, vocabulary));
    return { places, width, conventions: conventionsOf(header, places, vocabulary) };
  }
  const alone = needed.length === 1;
  const names = alone ? least === 1 && !lines.length && ["t"] : vocabulary.UNNAMED[least];
  if (!names) throw new Unreadable(`No line names the columns: let the first be ${needed.join(",")}.`);
  refuseOtherComment(lines, names, least, needed, vocabulary);
  const words = [...names, ...Array(least - names.length).fill("-")];
  const conventions = alone ? [] : [`no header: the columns are taken as ${names.join(", ")}`];
  return { places: layoutOf(words, needed, vocabulary), width: least, conventions };
}

// Clocks: compare/candidates/clock.py. A decimal is [mantissa, digits], whose value is mantissa / 10^digits.

const DAY_S = 86400;
const MINUTE_S = 60;

function decimalOf(text) {
  const [, sign, before, after, exponent] = /^([+-]?)(\d*)\.?(\d*)(?:e([+-]?\d+))?$/i.exec(text);
  const digits = after.length - Number(exponent ?? 0);
  const mantissa = BigInt(`${before}${after}`) * (sign === "-" ? -1n : 1n);
  return digits < 0 ? [mantissa * 10n ** BigInt(-digits), 0] : [mantissa, digits];
}

function sum([one, digits], [other, otherDigits], sign = 1n) {
  const most = Math.max(digits, otherDigits);
  return [one * 10n ** BigInt(most - digits) + sign * other * 10n ** BigInt(most - otherDigits), most];
}

const numberOf = ([mantissa, digits]) => Number(`${mantissa}e-${digits}`);

// Times in s since another, each the nearest double to the difference of the decimals.
const since = (start, times) => times.map((time) => numberOf(sum(decimalOf(String(time)), decimalOf(String(start)), -1n)));

// What a clock shows in s, as a decimal: since midnight, or with a date since 1970.
function secondsOf(text, number, vocabulary) {
  const moment = whole(vocabulary.MOMENT).exec(text);
  const clock = moment ? moment.slice(4, 7) : whole(vocabulary.CLOCK).exec(text)?.slice(1);
  if (!clock) throw new Unreadable(`Line ${number}: ${text.slice(0, 40)} is no time as in the first row (t). ${vocabulary.HOW}`);
  const [hours, minutes, seconds] = clock;
  if (hours === undefined && !/[.,]/.test(seconds)) {
    throw new Unreadable(`Line ${number}: are ${text} hours and minutes, or minutes and seconds? ${vocabulary.HOW}`);
  }
  const ofDay = sum(decimalOf(seconds.replace(",", ".")), [BigInt(3600 * Number(hours ?? 0) + MINUTE_S * Number(minutes)), 0]);
  if (!moment) return ofDay;
  const [year, month, day] = moment.slice(1, 4).map(Number);
  const date = new Date(Date.UTC(year, month - 1, day));
  date.setUTCFullYear(year);
  if (date.getUTCMonth() !== month - 1 || date.getUTCDate() !== day || year === 0) {
    throw new Unreadable(`Line ${number}: ${text.slice(0, 40)} is no date of the calendar (t).`);
  }
  const zone = moment[7] ? (Number(moment[8]) * MINUTE_S + Number(moment[9])) * MINUTE_S * (moment[7] === "-" ? -1 : 1) : 0;
  return sum(ofDay, [BigInt(Math.round(date.getTime() / 1000) - zone), 0]);
}

// The times of a clock's texts in s: since the first row if it does not begin at 0, but of transits as they stand.
function clockTimes(texts, numbers, alone, vocabulary) {
  const times = texts.map((text, i) => secondsOf(text, numbers[i], vocabulary));
  const kind = whole(vocabulary.MOMENT).test(texts[0]) ? "dates with hours:minutes:seconds" : "hours:minutes:seconds";
  const convention = `times are ${kind}, converted to seconds`;
  if (alone || !times[0][0]) return { times: times.map(numberOf), convention, start: null };
  return { times: times.map((time) => numberOf(sum(time, times[0], -1n))), convention, start: numberOf(times[0]) };
}

// Rows: compare/candidates/read.py.

const fieldsRead = (row, { separator, places }, vocabulary) => {
  const fields = split(row, separator, vocabulary);
  return Object.values(places).map(({ at }) => fields[at]).filter((field) => field !== undefined);
};

function counts(row, { separator, width }, vocabulary) {
  const fields = split(row, separator, vocabulary);
  return fields.length >= width && fields.slice(width).every((field) => !field);
}

function fits(row, reading, vocabulary) {
  const [time = "", ...others] = fieldsRead(row, reading, vocabulary);
  const readable = (field) => isNumber(field, vocabulary) || isMissing(field, vocabulary);
  return counts(row, reading, vocabulary) && (readable(time) || isClock(time, vocabulary)) && others.every(readable);
}

// Whether a line names the columns between separators other than white space, as many as in a row.
function usedAbove(lines, row, separator, needed, vocabulary) {
  if (!separator || !row.includes(separator)) return false;
  const fields = split(row, separator, vocabulary);
  const least = withoutEnd(fields).length;
  const ways = lines.filter(({ text }) => text.includes(separator)).map(({ text }) => withoutEnd(split(text, separator, vocabulary)));
  return ways.some((way) => least <= way.length && way.length <= fields.length && namesAll(way, needed, vocabulary));
}

// The ways to read the first row; none if the line is no row.
function readingsOf(lines, row, number, needed, vocabulary) {
  const [readings, refusals] = [[], []];
  const possible = possibleSeparators(row, vocabulary);
  const ofHeader = vocabulary.SEPARATORS.filter((separator) => usedAbove(lines, row, separator, needed, vocabulary));
  for (const separator of possible.length && ofHeader.length ? ofHeader : possible) {
    try {
      readings.push({ separator, ...layoutAbove(lines, row, separator, number, needed, vocabulary) });
    } catch (error) {
      if (!(error instanceof Unreadable)) throw error;
      refusals.push({ separator, error });
    }
  }
  if (refusals.length && !readings.length) throw refusals[0].error;
  const isWhole = ({ separator }) => split(row, separator, vocabulary).every((field) => isNumber(field, vocabulary));
  if (!lines.length && refusals.some(isWhole)) {
    throw new Unreadable(`Line ${number}, ${row.slice(0, 40)}, may be one number or two: write ${needed.join(",")} in a first line.`);
  }
  const fitting = readings.filter((reading) => fits(row, reading, vocabulary));
  return fitting.length ? fitting : readings.slice(0, 1);
}

// The one way to read all rows.
function onlyReading(readings, rows, vocabulary) {
  if (readings.length === 1) return readings[0];
  const possible = readings.filter((reading) => rows.every(({ text }) => fits(text, reading, vocabulary)));
  for (const other of possible.slice(1)) {
    for (const { text, number } of rows) {
      const value = (field) => (isNumber(field, vocabulary) ? String(valueOf(field, vocabulary)) : field);
      const [first, second] = [possible[0], other].map((way) => fieldsRead(text, way, vocabulary).map(value));
      if (Object.keys(possible[0].places).join() === Object.keys(other.places).join() && first.join() === second.join()) continue;
      throw new Unreadable(`Line ${number} is ${first.join(", ")} or ${second.join(", ")}: name the columns in a first line, and separate them by semicolons.`);
    }
  }
  return possible[0] ?? readings[0];
}

// The fields of the rows by column, their lines, and what is to be said; rows in which a position is missing are left out.
function columnsOf(rows, reading, needed, vocabulary) {
  const names = Object.keys(reading.places);
  const alone = needed.length === 1;
  const [kept, numbers, lost] = [[], [], []];
  for (const { text, number } of rows) {
    if (!counts(text, reading, vocabulary)) {
      const count = withoutEnd(split(text, reading.separator, vocabulary)).length;
      const many = reading.separator === "," ? vocabulary.COMMAS : "Are there two numbers in one field?";
      throw new Unreadable(`Line ${number} has ${count} fields, and the first row has ${reading.width}. ${count > reading.width ? many : "Is it cut off?"}`);
    }
    const fields = fieldsRead(text, reading, vocabulary);
    const missing = fields.map((field) => isMissing(field, vocabulary));
    if (missing.some(Boolean) && !alone && (missing.every(Boolean) || !missing[0])) {
      lost.push(fields[0]);
      continue;
    }
    names.forEach((name, i) => {
      if (isNumber(fields[i], vocabulary) || (name === "t" && isClock(fields[i], vocabulary))) return;
      const thousands = whole(vocabulary.THOUSANDS).test(fields[i]) ? " Write numbers without marks between thousands." : "";
      throw new Unreadable(`Line ${number}: ${fields[i].slice(0, 40) || "nothing"} is no number (${name}).${thousands}`);
    });
    kept.push(fields);
    numbers.push(number);
  }
  if (!kept.length) throw new Unreadable(`No row has numbers of ${names.slice(1).join(" or ")}.`);
  const notes = lost.length ? [`${lost.length} ${lost.length === 1 ? "row" : "rows"} without a position left out, the first at t = ${lost[0] || "?"}.`] : [];
  return { columns: names.map((_, i) => kept.map((fields) => fields[i])), numbers, notes };
}

function checkMarks(columns, { separator }, vocabulary) {
  const commasSeparate = separator === ",";
  const doubtful = doubtfulNumber(columns, commasSeparate, vocabulary);
  if (doubtful) {
    const mark = doubtful.includes(",") ? "comma" : "point";
    throw new Unreadable(`Is the ${mark} of ${doubtful} decimal, or between thousands? Write ${doubtful.replaceAll(",", ".")}0 or ${doubtful.replace(/[.,]/g, "")}.`);
  }
  if (!commasSeparate || columns.some((column) => column.some((number) => /[.,]/.test(number)))) return;
  const needless = columns.flat().find((number) => whole(vocabulary.PADDED).test(number));
  if (needless) throw new Unreadable(`${needless} between commas. ${vocabulary.COMMAS}`);
}

// Rows of NaN after which others follow are lost frames, and left out; at the end they say that the run failed.
function withoutLostFrames(columns, numbers, notes, vocabulary) {
  const names = Object.keys(columns);
  const isLost = columns.t.map((_, i) => names.some((name) => name !== "t" && Number.isNaN(columns[name][i])));
  const last = isLost.lastIndexOf(false);
  const lost = isLost.map((value, i) => value && i < last);
  for (const [name, column] of Object.entries(columns)) {
    const row = column.findIndex((value, i) => !lost[i] && !(Math.abs(value) <= vocabulary.LARGEST));
    if (row >= 0) throw new Unreadable(`Line ${numbers[row]}: ${name} is ${String(column[row]).toLowerCase()}. The run failed there.`);
  }
  const count = lost.filter(Boolean).length;
  if (!count) return columns;
  notes.push(`${count} ${count === 1 ? "row" : "rows"} of NaN left out, the first at t = ${columns.t[lost.indexOf(true)]} s.`);
  return Object.fromEntries(names.map((name) => [name, columns[name].filter((_, i) => !lost[i])]));
}

// Read columns of a text: {columns: {t: […], x: […], …} in SI units, notes, clock}. `needed` columns must be there, times
// first. `clock` is what a clock showed in the first row, from which t is counted; null if t is since the release.
function readColumns(text, needed, vocabulary, onComment = () => {}) {
  if (text.includes("\0")) throw new Unreadable("This is no text: a CSV file is wanted.");
  const [above, rows, notes] = [[], [], []];
  let readings = [];
  text.replace(/^\ufeff/, "").split(/\r*\n/).forEach((raw, i) => {
    const line = raw.replace(/^[ \r\v\f]+|[ \r\v\f]+$/g, "");
    const number = i + 1;
    if (saysNothing(line, vocabulary)) return;
    if (line.includes("\r")) throw new Unreadable("Lines end with CR alone: save it with other line ends.");
    const remark = whole(vocabulary.COMMENT, "s").exec(line.trimStart());
    if (remark) {
      if (!rows.length) above.push({ text: remark[1], comment: true, number });
      onComment(remark[1], number);
      return;
    }
    if (!rows.length) readings = readingsOf(above, line, number, needed, vocabulary);
    if (readings.length) {
      rows.push({ text: line, number });
      return;
    }
    above.push({ text: line, comment: false, number });
    if (above.length > vocabulary.MOST) throw new Unreadable(`Line ${number} is not a row of numbers, and no such row comes before it.`);
  });
  if (!rows.length) throw new Unreadable("There are no rows of numbers.");
  const reading = onlyReading(readings, rows, vocabulary);
  const { columns: fields, numbers, notes: lost } = columnsOf(rows, reading, needed, vocabulary);
  const conventions = [...reading.conventions];
  let clock = null;
  let times = null;
  if (isClock(fields[0][0], vocabulary)) {
    const { factor } = reading.places.t;
    if (factor[0] !== factor[1]) throw new Unreadable(`The unit of t says that it is a number, and it is ${fields[0][0]}.`);
    const counted = clockTimes(fields[0], numbers, needed.length === 1, vocabulary);
    conventions.push(counted.convention);
    times = counted.times;
    clock = counted.start;
  }
  const written = times ? fields.slice(1) : fields;
  const clockLate = times ? -1 : fields[0].findIndex((field) => !isNumber(field, vocabulary));
  if (clockLate >= 0) throw new Unreadable(`Line ${numbers[clockLate]}: ${fields[0][clockLate].slice(0, 40)} is no number (t).`);
  checkMarks(written, reading, vocabulary);
  if (written.some((column) => column.some((field) => field.includes(",")))) conventions.push(vocabulary.DECIMAL_COMMA);
  notes.push(...conventions.map((convention) => `Reading: ${convention}.`), ...lost);
  let columns = {};
  Object.entries(reading.places).forEach(([name, { factor }], i) => {
    columns[name] = name === "t" && times ? times : fields[i].map((field) => (valueOf(field, vocabulary) * factor[0]) / factor[1]);
  });
  columns = withoutLostFrames(columns, numbers, notes, vocabulary);
  const digits = (field) => field.replace(/e.*/i, "").replace(/^[+-]?[0.]*/, "").replace(".", "").length;
  if (written.some((column) => column.some((field) => digits(plain(field, vocabulary)) > vocabulary.DOUBLE_DIGITS))) {
    notes.push("Numbers of more than 17 digits are rounded to doubles here; foucault score reads all of them.");
  }
  return { columns, notes, clock };
}

// Read a trajectory: {columns, transits (null if there are none), notes, clock}.
function readTrajectory(text, vocabulary) {
  const transits = [];
  const { columns, notes, clock } = readColumns(text, ["t", "x", "y"], vocabulary, (comment, number) => {
    const words = comment.split(/\s+/);
    if (words[0] !== "P") return; // a transit of foucPend: # P, a count, a time in s, a frequency
    if (!whole(vocabulary.NUMBER).test(words[2] ?? "")) throw new Unreadable(`Line ${number}: a transit without a time.`);
    transits.push(Number(words[2]));
  });
  checkTimes(columns.t, "increase", (before, after) => after > before);
  checkTimes(transits, "not decrease", (before, after) => after >= before);
  return { columns, transits: transits.length ? transits : null, notes, clock };
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
