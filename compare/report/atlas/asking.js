// The page for any pendulum: its form, its motion, what is judged by it, and what can be kept of it.
"use strict";

const { fields, presets, words } = JSON.parse(document.getElementById("known").textContent);
const at = (id) => document.getElementById(id);
const form = at("pendulum");
const BEGIN = "paris";
const MOST_PRINTED = 500_000; // rows of a CSV
const PAUSE = 250; // ms from the last key to the motion
const BEARING = {
  "release.azimuth": "direction of the bob, from north to east: 0 is north, 90 east",
  "release.azimuth_rate": "rate of the bearing",
};
const COMPASS = Object.keys(BEARING);
const EMPTY = "The box is empty. Paste what your program printed: a line t,x,y, and below it the time in s and the place in m, row by row.";
const CHANGED = {
  rows: "the rows in the box have changed. Press “Judge the rows”.",
  tolerance: "the tolerance has changed. Press Enter in its field.",
  pendulum: "the pendulum has changed.",
};
const CONTAINED = {
  sphere: "The bob on a sphere, and not small angles: a wider swing is slower",
  coriolis: "The Coriolis force in three dimensions, −2 Ω × v with Ω = Ω (0, cos φ, sin φ), and not its part with sin φ alone",
  centrifugal: "The centrifugal force where the bob is, and not only at the suspension: −Ω × (Ω × r), which no measured g contains",
};
const AZIMUTH = Object.fromEntries(COMPASS.map((name) => [name, at(`${name}.meaning`).textContent]));

let pendulum = null; // { title, texts } that the form has, without a mistake
let address = ""; // the fragment that is this pendulum, or that the page was opened with
let motion = null; // { worker, facts } of the pendulum that is shown
let started = 0; // motions so far: of two the later one is shown
let timer = null;
let files = []; // that were judged last
const changes = new Set(); // since then: names of CHANGED
let largestError = null; // in m, of the last verdict
let judgedTolerance = null; // text of the field when files were judged last

// The form.

const input = (name) => at(name);
const choicesOf = (name) => [...at(name).querySelectorAll("input")];
const isCompass = (name) => COMPASS.includes(name) && at("direction").value === "bearing";

function turned(name, text) {
  if (!isCompass(name) || !decimal(words).test(text)) return text;
  return name === "release.azimuth" ? turnedCompass(text) : negated(text);
}

// The texts that the form has, by field; an empty field has its default.
function textsOfForm() {
  const texts = {};
  for (const { name, choices } of fields) {
    if (name.startsWith("release.") && !KINDS[at("kind").value].includes(name)) continue;
    const text = choices ? choicesOf(name).find((button) => button.checked)?.value : input(name).value.trim();
    if (text) texts[name] = turned(name, text);
  }
  return texts;
}

function fill({ title, texts }) {
  at("title").value = title;
  at("kind").value = kindOf(texts);
  at("direction").value = "azimuth";
  for (const { name, choices, default: value } of fields) {
    const text = texts[name] ?? value ?? "";
    if (choices) for (const button of choicesOf(name)) button.checked = button.value === text;
    else input(name).value = text;
  }
  showKind();
}

function showKind() {
  const kind = at("kind").value;
  for (const [other, names] of Object.entries(KINDS)) {
    for (const name of names) input(name).closest(".field").hidden = other !== kind;
  }
  at("direction-line").hidden = kind !== "angles";
  const word = at("direction").value;
  for (const name of COMPASS) {
    const label = input(name).closest(".field").querySelector("label").firstChild;
    label.data = name === "release.azimuth" ? `${word} ` : `${word} rate `;
    at(`${name}.meaning`).textContent = word === "bearing" ? BEARING[name] : AZIMUTH[name];
  }
}

// Write the same direction as a bearing, or as an azimuth again.
function turnDirections() {
  for (const name of COMPASS) {
    const text = input(name).value.trim();
    if (!decimal(words).test(text)) continue;
    input(name).value = name === "release.azimuth" ? turnedCompass(text) : negated(text);
  }
}

// Say what is wrong at each field; return whether anything is.
function showWrong(texts) {
  const wrong = wrongOf(texts, fields, words);
  for (const { name, choices } of fields) {
    if (choices) continue;
    const mistake = wrong[name];
    at(`${name}.wrong`).textContent = mistake ? `Expected ${mistake.expected}. ${mistake.advice}`.trim() : "";
    input(name).setAttribute("aria-invalid", String(Boolean(mistake)));
  }
  return Object.keys(wrong).length > 0;
}

// The motion.

const places = ({ value, error }) => {
  if (!(error < Math.abs(value))) return `0 ± ${error.toPrecision(2)}`;
  const digits = Math.floor(Math.log10(Math.abs(value))) - Math.ceil(Math.log10(error)) + 1;
  return String(Number(value.toPrecision(Math.min(Math.max(digits, 1), 15))));
};

function hangs({ hangs: aside, tilt }) {
  if (tilt === null) return "none";
  if (aside === 0) return "in the vertical";
  return `${small(Math.abs(aside))} m ${aside < 0 ? "south" : "north"} of the vertical, a tilt of ${small(Math.abs(tilt))}°`;
}

function factRows(facts) {
  const rows = [];
  if (facts.period) rows.push(["period", `${places(facts.period)} s`]);
  if (facts.precession) {
    const way = facts.turn ? (facts.precession.value < 0 ? ", clockwise" : ", anticlockwise") : "";
    rows.push(["precession", `${places(facts.precession)} °/h${way}`]);
  }
  if (facts.turn) rows.push(["full turn", `${places(facts.turn)} h`]);
  if (facts.reason) rows.push([facts.period ? "no full turn" : "no period", facts.reason]);
  rows.push(["rest position", hangs(facts)]);
  rows.push(["pull", `${rounded(facts.pull, 9)} m/s², gravity and centrifugal force together`]);
  const count = facts.transits === null ? words.UNDECIDED_TRANSITS : facts.transits.toLocaleString("en");
  rows.push(["transits", facts.transits ? `${count}, each within ${small(facts.transitError)} s (estimated)` : count]);
  rows.push(["error", `${small(facts.error)} m at the end, estimated from a second run`]);
  if (facts.until < facts.end) {
    const accuracy = `known to a millionth of the amplitude up to t = ${small(facts.until)} s`;
    rows.push(["in doubles", `${accuracy}; ask the command for the rest`]);
  }
  return rows;
}

const say = (text) => { at("state").textContent = text; };

// Show the first swings of the pendulum, and then the whole motion.
async function solvePendulum() {
  const number = ++started;
  motion?.worker.stop();
  const worker = startedWorker("solving");
  motion = { worker, facts: null };
  const begin = performance.now();
  const { texts } = pendulum;
  const scene = sceneOf(texts, fields);
  say("Computing …");
  const first = await worker.ask("begin", { texts, fields });
  if (number !== started) return;
  if (!first.refused) showMotion(playedMotion(scene, first), number);

  const report = (share) => number === started && say(`Computing: ${Math.round(100 * share)} %`);
  const solved = await worker.ask("solve", { texts, fields, words }, report);
  if (number !== started) return;
  if (solved.refused) {
    say(`${solved.refused} On the command line: ${at("prove").textContent}`);
    at("facts").replaceChildren();
    return;
  }
  motion.facts = solved.facts;
  say(`Computed in ${((performance.now() - begin) / 1000).toPrecision(2)} s.`);
  at("facts").replaceChildren(factList(factRows(solved.facts)));
  at("tolerance").placeholder = small(words.TOLERANCE * solved.facts.amplitude);
  player.show(playedMotion(scene, solved), player.time());
  if (files.length) judgeFiles(files);
}

// Play a new motion from its first swing on; the first of a page begins to move by itself.
function showMotion(played, number) {
  const moves = number === 1 ? !still.matches : player.playing();
  player.show(played);
  player.play(moves);
}

// Take what the form says: show its mistakes, or its motion.
function take() {
  const texts = textsOfForm();
  mark("pendulum");
  showKind();
  if (showWrong(texts)) {
    say("A field is wrong: see below it.");
    return;
  }
  pendulum = { title: plainTitle(at("title").value), texts };
  address = `#${fragmentOf(pendulum.title, texts, fields)}`;
  if (location.hash !== address) history.replaceState(null, "", address);
  at("toml").textContent = tomlOf(pendulum.title, texts, fields);
  at("step").placeholder = String(sceneOf(texts, fields).run.grid_step);
  solvePendulum();
}

function takeSoon() {
  clearTimeout(timer);
  timer = setTimeout(take, PAUSE);
}

function takePreset(id) {
  const chosen = presets.find((preset) => preset.id === id);
  at("about").textContent = chosen ? chosen.title : "";
  if (!chosen) return;
  fill({ title: chosen.title, texts: chosen.texts });
  take();
}

// Take a new address: another pendulum, or a section of this page, which leaves form and address as they are.
function takeAddressChange() {
  if (location.hash && at(location.hash.slice(1))) history.replaceState(null, "", address);
  else takeAddress();
}

function takeAddress() {
  address = location.hash;
  const { title, texts } = textsOfFragment(location.hash, fields);
  if (!Object.keys(texts).length) {
    at("preset").value = BEGIN;
    takePreset(BEGIN);
    return;
  }
  at("preset").value = "";
  at("about").textContent = "";
  fill({ title, texts });
  take();
}

// The judge.

const shown = at("verdict");

// Mark the verdict as out of date by a change, and as up to date again.
function mark(change) {
  if (files.length) changes.add(change);
  showOutdated();
}

function unmark(...names) {
  for (const change of names) changes.delete(change);
  showOutdated();
}

function markTolerance() {
  if (at("tolerance").value === judgedTolerance) unmark("tolerance");
  else mark("tolerance");
}

function showOutdated() {
  const [change] = changes;
  at("outdated").textContent = change ? `Out of date: ${CHANGED[change]}` : "";
}

// The largest error beside that of the verdict before, where it is another one.
function comparedWithBefore({ path }) {
  if (!path) return [];
  const error = path.max_error_m;
  const before = largestError;
  largestError = error;
  if (before === null || before === error) return [];
  return [`The largest error is ${small(error)} m; in the verdict before it was ${small(before)} m.`];
}

function referenceText({ bound_m: bound }) {
  return `the motion above, whose error is estimated at ${small(bound)} m`;
}

// What the equations of the right motion contain, with how far the bob is off without it.
function containedIn({ leftOut, path, gravity }) {
  const items = [];
  const error = gravity?.isNamed ? gravity.residual_m : path.max_error_m;
  for (const [name, text] of Object.entries(CONTAINED)) {
    const size = leftOut?.sizes[name];
    if (size === 0) continue;
    const beside = size > error ? ", more than your error" : "";
    const moved = size === undefined ? "" : ` Without it: off by ${rounded(size, 2)} m up to t = ${leftOut.until} s${beside}.`;
    items.push(elementOf("li", {}, `${text}.${moved}`));
  }
  return ["The right motion contains what programs often leave out:", elementOf("ul", {}, ...items)];
}

// What to do about an error that the page does not explain, or not in full.
function furtherSteps(result) {
  if (result.verdict !== "disagrees" || result.explained) return [];
  const { site } = sceneOf(pendulum.texts, fields);
  const { gravity } = result;
  const steps = [];
  if (!result.isNamed && !gravity?.isNamed) {
    const other = gravity && !gravity.helps ? ", and the other meaning of g makes it no better" : "";
    steps.push(`The page finds nothing wrong with the clock, the unit and the axes${other}. What remains are your equations, your numbers, your method and its step.`);
  }
  steps.push("Halve your step and judge again: what shrinks is the error of your method, what stays is in your equations.");
  if (gravity?.helps && !gravity.isNamed && site.gravity_is === "ellipsoid") {
    steps.push("Does your program leave out the centrifugal force? Choose effective under Place: if most of the error goes, that is it.");
  }
  if (result.path) steps.push(containedIn(result));
  const command = "foucault score pendulum.toml mine.csv";
  return [...steps, `Or save pendulum.toml below: ${command} names the mistake. The command needs Python.`];
}

async function judgeFiles(chosen) {
  if (!chosen.length) return;
  files = [...chosen];
  if (!motion?.facts) return;
  const { worker } = motion;
  shown.className = "working";
  shown.replaceChildren(elementOf("p", { className: "word" }, "Judging …"));
  unmark("tolerance", "pendulum");
  const tolerance = at("tolerance").value;
  judgedTolerance = tolerance;
  const result = await worker.ask("judge", { files, tolerance });
  if (worker !== motion.worker) return;
  const { run } = sceneOf(pendulum.texts, fields);
  const scene = { name: pendulum.title || "this pendulum", end: run.t_end, reference: referenceText, bound: "estimated error of the page" };
  const notes = result.refused ? [] : [...comparedWithBefore(result), ...result.notes];
  showVerdict(shown, files, { ...result, notes }, scene, furtherSteps(result));
  if (result.mine) player.drop(result.mine, result.path.max_error_m);
}

function judgePasted() {
  const text = at("pasted").value;
  if (text.trim()) {
    unmark("rows");
    judgeFiles([new File([text], "your output")]);
    return;
  }
  files = [];
  unmark(...changes);
  showRefusal(shown, EMPTY);
}

function judgeDropped(chosen) {
  unmark("rows");
  judgeFiles(chosen);
}

// Enter in the field of the tolerance: judge what the box has, if that has not been judged.
function judgeByEnter(event) {
  if (event.key !== "Enter") return;
  if (changes.has("rows") || !files.length) judgePasted();
  else judgeFiles(files);
}

// The field is left with another tolerance. Enter fires `change` too, after `keydown` has judged: then nothing is left to do.
function judgeByChange() {
  if (at("tolerance").value !== judgedTolerance) judgeFiles(files);
}

// What can be kept.

function save(name, text, type) {
  const address = URL.createObjectURL(new Blob([text], { type }));
  const link = elementOf("a", { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

async function saveRows() {
  const run = sceneOf(pendulum.texts, fields).run;
  const step = Number(at("step").value || run.grid_step);
  if (!(step > 0 && run.t_end / step <= MOST_PRINTED)) {
    at("saved").textContent = `Expected a number above 0, and at most ${MOST_PRINTED.toLocaleString("en")} rows.`;
    return;
  }
  if (!motion?.facts) return;
  const csv = await motion.worker.ask("print", { step });
  save("pendulum.csv", csv, "text/csv");
  at("saved").textContent = `${csv.split("\n").length - 2} rows in pendulum.csv.`;
}

async function copyLink() {
  try {
    await navigator.clipboard.writeText(location.href);
    at("copied").textContent = "Copied.";
  } catch {
    at("copied").textContent = location.href; // a page from a file may not copy
  }
}

const player = playerOf(at("player"), async () => null);
form.addEventListener("submit", (event) => event.preventDefault());
form.addEventListener("input", ({ target }) => {
  if (target.closest("#player") || target.id === "preset") return;
  at("preset").value = "";
  at("about").textContent = "";
  takeSoon();
});
at("preset").addEventListener("change", (event) => takePreset(event.target.value));
at("tolerance").addEventListener("change", judgeByChange);
at("tolerance").addEventListener("input", markTolerance);
at("tolerance").addEventListener("keydown", judgeByEnter);
at("pasted").addEventListener("input", () => mark("rows"));
at("judge").addEventListener("click", judgePasted);
at("csv").addEventListener("click", saveRows);
at("copy").addEventListener("click", copyLink);
at("save").addEventListener("click", () => save("pendulum.toml", at("toml").textContent, "application/toml"));
at("direction").addEventListener("change", turnDirections);
addEventListener("hashchange", takeAddressChange);
takeFiles(at("drop"), judgeDropped);
takeAddress();
