// Show the verdict on a file. Whatever comes from a file, a form or an address is inserted as text, never as HTML.
"use strict";

// An element with properties and children, which are texts or elements.
function elementOf(name, properties = {}, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

// The names and descriptions of a list; a description is a text or several children.
function factList(rows) {
  const items = rows.flatMap(([name, ...value]) => [elementOf("dt", {}, name), elementOf("dd", {}, ...value.flat())]);
  return elementOf("dl", {}, ...items);
}

// A number with its digits, the first wrong one marked.
function marked(value, place) {
  const digits = value.toFixed(Math.min(Math.max(place + 3, 1), 17));
  const at = digits.indexOf(".") + place + (place > 0 ? 0 : -1);
  if (at < 0 || !/\d/.test(digits[at] ?? "")) return [digits];
  return [digits.slice(0, at), elementOf("mark", {}, digits[at]), digits.slice(at + 1)];
}

// A bound is given 1.005 times as large, so that rounding to three digits does not take from it.
const atMost = (bound) => small(1.005 * bound);

function pathRows({ path, tolerance_m: allowed, bound_m: bound, amplitude_m: amplitude }, end, reference) {
  const { worst } = path;
  const place = firstWrongPlace(worst.difference || bound);
  const lastRight = place > 1 ? `decimal ${place - 1}` : "the point at most";
  const rows = [
    ["judged", `${path.rows.toLocaleString("en")} rows, t = ${path.covered_s[0]} to ${path.covered_s[1]} s of ${end} s`],
    ["largest error", `${small(path.max_error_m)} m (tolerance ${small(allowed)} m), at t = ${worst.t} s`],
    ["compared with", reference],
    ["error at the end", `${small(path.end_error_m)} m`],
    ["rms error", `${small(path.rms_error_m)} m`],
    ["digits", `${Math.max(path.digits, 0).toFixed(1)} of the amplitude of ${small(amplitude)} m`],
    ["right up to", `${lastRight} of ${worst.component} at t = ${worst.t} s`],
    ["expected", marked(worst.expected, place)],
    ["got", marked(worst.got, place)],
  ];
  if (path.wrong_from_s !== null) rows.push(["beyond tolerance", `from t = ${path.wrong_from_s} s on`]);
  return rows;
}

function transitRows({ matched, missed, extra, max_error_s: late, max_conditioned_error_m: moved }) {
  function listed(times) {
    const first = times.slice(0, 3).map((t) => t.toFixed(6)).join(", ");
    return times.length ? ` (${first}${times.length > 3 ? " …" : ""} s)` : "";
  }
  return [
    ["transits", `${matched} matched, ${missed.length} missed${listed(missed)}, ${extra.length} extra${listed(extra)}`],
    ["their error", `${small(late)} s, ${small(moved)} m of the motion`],
  ];
}

// A picture that drawing.js writes: of numbers alone.
function pictureOf(svg) {
  const { documentElement } = new DOMParser().parseFromString(svg, "image/svg+xml");
  return document.importNode(documentElement, true);
}

// What decided a verdict, and how to change it.
const LOOSEN = "To loosen this, type metres into Tolerance above and press Enter.";
const DECIDES = {
  typed: "the tolerance that you typed above.",
  amplitude: `a millionth of the amplitude, which is the largest distance of the right motion from the vertical through the suspension. ${LOOSEN}`,
  rows: `a millionth of the amplitude of your rows, which swing far less than this. ${LOOSEN}`,
};

const decidedBy = ({ tolerance_m: tolerance, tolerance_of: of }) =>
  `It agrees if no position is off by more than ${small(tolerance)} m, beside the error of the reference: ${DECIDES[of]}`;

function showRefusal(shown, reason) {
  shown.className = "refused";
  shown.replaceChildren(elementOf("p", { className: "word" }, elementOf("strong", {}, "Not judged")), elementOf("p", {}, reason));
}

// Show a verdict on files in an element. `scene` has its name and end, `reference` says by what was judged, and
// `bound` what its error is called; `notes` follow those of the verdict, each a text or several children.
function showVerdict(shown, files, result, { name, end, reference, bound }, notes = []) {
  if (result.refused) {
    showRefusal(shown, result.refused);
    return;
  }
  const rows = result.path ? pathRows(result, end, reference(result)) : [];
  if (result.transits) rows.push(...transitRows(result.transits));
  const items = [...result.notes, ...notes].map((note) => elementOf("li", {}, ...[note].flat()));
  const names = files.map((file) => file.name).join(" and ");
  const word = elementOf("p", { className: "word" }, elementOf("strong", {}, `${names} ${result.verdict}`), ` with ${name}`);
  shown.className = result.verdict;
  const decided = elementOf("p", { className: "faint" }, decidedBy(result));
  shown.replaceChildren(word, decided, elementOf("ul", {}, ...items), factList(rows));
  if (!result.points) return;
  const wide = Math.max(280, Math.min(640, shown.clientWidth - 20)); // px
  const moving = ["In ", elementOf("a", { href: "#player" }, "the moving picture"), " your bob is the orange one, with its error enlarged as the line below it says."];
  const ofBound = showsBound(result) ? `; below “${bound}” nothing can be told` : "";
  const help = `How far your bob is from the right one, in m. Below the line “tolerance” it agrees${ofBound}. `;
  shown.append(elementOf("p", { className: "faint" }, help, ...moving), pictureOf(errorPicture(result, wide, bound)));
}

// Take the files that are dropped on a zone or chosen.
function takeFiles(zone, take) {
  for (const kind of ["dragenter", "dragover", "dragleave", "drop"]) {
    zone.addEventListener(kind, (event) => {
      event.preventDefault();
      zone.classList.toggle("over", kind === "dragenter" || kind === "dragover");
      if (kind === "drop") take(event.dataTransfer.files);
    });
  }
  zone.querySelector("input[type=file]").addEventListener("change", (event) => take(event.target.files));
}
