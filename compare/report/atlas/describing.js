// A pendulum as texts by field ("pendulum.length": "67"), checked as reference/scenes checks them; as numbers, as the
// fragment of an address, and as a scene in TOML. `fields` is what form.py embeds. Pure functions, without the page.
"use strict";

const HIGHEST = 1.7976931348623157e308; // the largest double
const MOST_CHARACTERS = 200; // of a text in the address

const KINDS = {
  position: ["release.x", "release.y", "release.vx", "release.vy"],
  angles: ["release.angle", "release.azimuth", "release.angle_rate", "release.azimuth_rate"],
};

const decimal = (words) => new RegExp(`^(?:${words.DECIMAL})$`);
const kindOf = (texts) => ("release.angle" in texts || "release.azimuth" in texts ? "angles" : "position");

// What a field has to be; the words of `within` in reference/scenes/texts.py.
function expectedOf({ least, most, above }) {
  const lower = above ? `a number above ${least}` : `a number at least ${least}`;
  return most === null ? lower : `${lower} and at most ${most}`;
}

// What is wrong with a number's text: {expected, advice}; null if nothing is.
function wrongNumber(text, field, words) {
  if (field.or_inf && text === "inf") return null;
  const number = Number(text);
  if (!decimal(words).test(text) || text === "inf") {
    const comma = decimal(words).test(text.replace(",", "."));
    const alone = /^[+-]?\d/.test(text) ? "Write the number alone, in this unit." : "";
    return { expected: words.NUMBER_EXPECTED, advice: comma ? "Write a decimal point, not a comma." : alone };
  }
  if (Math.abs(number) > HIGHEST) return { expected: "a number in the range of a double", advice: "" };
  if (field.least === null) return null;
  const low = field.above ? number <= Number(field.least) : number < Number(field.least);
  const high = field.most !== null && number > Number(field.most);
  return low || high ? { expected: expectedOf(field), advice: "" } : null;
}

function wrongText(text, field, words) {
  if (field.choices) return field.choices.includes(text) ? null : { expected: `one of ${field.choices.join(", ")}`, advice: "" };
  return wrongNumber(text, field, words);
}

// What is wrong, by field: {"pendulum.length": {expected, advice}}.
function wrongOf(texts, fields, words) {
  const wrong = {};
  for (const field of fields) {
    if (field.name in texts) {
      const mistake = wrongText(texts[field.name], field, words);
      if (mistake) wrong[field.name] = mistake;
    }
  }
  for (const name of KINDS[kindOf(texts)].slice(0, 2)) {
    if (!(name in texts)) wrong[name] = { expected: words.NUMBER_EXPECTED, advice: "The box is empty." };
  }
  if (Object.keys(wrong).length) return wrong;

  const { pendulum, release, run } = sceneOf(texts, fields);
  if (kindOf(texts) === "position" && Math.hypot(release.x, release.y) >= pendulum.length) {
    const expected = `a point below the suspension: x² + y² less than length² = ${texts["pendulum.length"] ?? "67"}²`;
    return { "release.x": { expected, advice: "To release at or above the horizontal, give angle and azimuth." } };
  }
  if (run.t_end / run.grid_step > words.MAX_ROWS) {
    return { "run.grid_step": { expected: `at most ${words.MAX_ROWS} grid times up to t_end`, advice: "Take a longer step." } };
  }
  return wrong;
}

// The scene as numbers, table by table; what is not given has its default.
function sceneOf(texts, fields) {
  const scene = { pendulum: {}, site: {}, release: {}, run: {} };
  for (const { name, choices, default: value } of fields) {
    const text = texts[name] ?? value;
    const [table, key] = name.split(".");
    if (text === null) continue;
    if (choices) scene[table][key] = text;
    else scene[table][key] = text === "inf" ? Infinity : Number(text);
  }
  return scene;
}

// The fields that are not their defaults, in the order of the form.
function givenOf(texts, fields) {
  return fields.filter(({ name, default: value }) => name in texts && texts[name] !== value).map(({ name }) => [name, texts[name]]);
}

// The fragment of the address that is this pendulum, and back. Words that are no field are left out.
function fragmentOf(title, texts, fields) {
  const pairs = givenOf(texts, fields);
  return new URLSearchParams(title ? [["title", title], ...pairs] : pairs).toString();
}

function textsOfFragment(fragment, fields) {
  const pairs = new URLSearchParams(fragment.replace(/^#/, ""));
  const texts = {};
  for (const { name } of fields) {
    const text = pairs.get(name);
    if (text !== null) texts[name] = text.slice(0, MOST_CHARACTERS);
  }
  return { title: plainTitle(pairs.get("title") ?? ""), texts };
}

const plainTitle = (text) => text.replace(/[\p{Cc}\p{Cf}\p{Zl}\p{Zp}]/gu, " ").slice(0, MOST_CHARACTERS).trim();

// A text as a basic string of TOML.
const quoted = (text) => JSON.stringify(text.toWellFormed?.() ?? text);

// The scene as a file that every command takes.
function tomlOf(title, texts, fields) {
  const lines = title ? [`title = ${quoted(title)}`] : [];
  const kind = KINDS[kindOf(texts)];
  for (const table of ["pendulum", "site", "release", "run"]) {
    lines.push("", `[${table}]`);
    const inTable = fields.filter((field) => field.name.startsWith(`${table}.`));
    for (const { name, default: value } of inTable) {
      const text = texts[name] ?? value;
      if (text === null || (table === "release" && !kind.includes(name))) continue;
      lines.push(`${name.split(".")[1]} = ${quoted(text)}`);
    }
  }
  return `${lines.join("\n").trim()}\n`;
}

// The azimuth, from east to north, of a compass bearing, from north to east, and back: 90 minus it, exactly.
function turnedCompass(text) {
  if (/e/i.test(text)) return String(90 - Number(text)); // its digits may be many
  const [whole, ...more] = sum(decimalOf("90"), decimalOf(text), -1n);
  return plainDecimal(whole, ...more);
}

// An integer as a decimal with the given number of digits after the point.
function plainDecimal(mantissa, digits) {
  const sign = mantissa < 0n ? "-" : "";
  const text = String(mantissa < 0n ? -mantissa : mantissa).padStart(digits + 1, "0");
  const whole = text.slice(0, text.length - digits);
  const part = text.slice(text.length - digits).replace(/0+$/, "");
  return sign + whole + (digits && part ? `.${part}` : "");
}

// The same text with the other sign: a rate of the bearing as one of the azimuth.
function negated(text) {
  if (Number(text) === 0) return text;
  return text.startsWith("-") ? text.slice(1) : `-${text.replace(/^\+/, "")}`;
}
