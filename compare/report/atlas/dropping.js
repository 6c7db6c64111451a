// The page of a scene: take files that are dropped or chosen, judge them, and show the verdict.
"use strict";

const page = JSON.parse(document.getElementById("truth").textContent);
const truth = unpacked(page);
const zone = document.getElementById("drop");
const shown = document.getElementById("verdict");
const tolerance = document.getElementById("tolerance");
let last = [];

const escaped = (text) => String(text).replace(/[&<>"]/g, (one) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[one]);
const small = (value) => (value === 0 ? "0" : value.toPrecision(3).replace(/\.?0+(e|$)/, "$1"));

// Times of xdot = 0 stand in a file that is called so, or has a column t and neither x nor y.
function isOfTransits({ name, text }) {
  if (/transit/i.test(name)) return true;
  try {
    const { columns } = readColumns(text, ["t"], page.words);
    return !("x" in columns) && !("y" in columns);
  } catch (error) {
    if (error instanceof Unreadable) return false;
    throw error;
  }
}

// Put the files of one drop together to a candidate.
function candidateOf(files) {
  const candidate = { columns: null, transits: null, notes: [] };
  for (const file of files) {
    const ofTransits = isOfTransits(file);
    if (ofTransits ? candidate.transits : candidate.columns) throw new Unreadable("Drop one trajectory, and one file of transits at most.");
    try {
      const read = (ofTransits ? readTransits : readTrajectory)(file.text, page.words);
      candidate.columns ??= read.columns && !ofTransits ? read.columns : null;
      candidate.transits ??= read.transits;
      candidate.notes.push(...read.notes);
    } catch (error) {
      if (error instanceof Unreadable) error.message = `${file.name}: ${error.message}`;
      throw error;
    }
  }
  return candidate;
}

function allowedBy(text) {
  if (!text.trim()) return null;
  const value = Number(text);
  if (!(value > 0 && value < Infinity)) throw new Unreadable("The tolerance is a positive number of metres.");
  return value;
}

// A number with its digits, the first wrong one marked.
function marked(value, place) {
  const digits = value.toFixed(Math.min(Math.max(place + 3, 1), 17));
  const at = digits.indexOf(".") + place + (place > 0 ? 0 : -1);
  if (at < 0 || !/\d/.test(digits[at] ?? "")) return escaped(digits);
  return `${digits.slice(0, at)}<mark>${digits[at]}</mark>${digits.slice(at + 1)}`;
}

function rowsOf({ path, transits, tolerance_m: allowed }) {
  const rows = [];
  if (path) {
    const { worst } = path;
    const place = firstWrongPlace(worst.difference || truth.bound_m);
    rows.push(["judged", `${path.rows} rows, t = ${path.covered_s[0]} to ${path.covered_s[1]} s of ${truth.t_end} s`]);
    rows.push(["largest error", `${small(path.max_error_m)} m (tolerance ${small(allowed)} m), at t = ${worst.t} s`]);
    rows.push(["rms, at the end", `${small(path.rms_error_m)} m, ${small(path.end_error_m)} m`]);
    rows.push(["digits", `${Math.max(path.digits, 0).toFixed(1)} of the amplitude of ${small(truth.amplitude_m)} m`]);
    rows.push(["first wrong digit", `${place > 0 ? `decimal ${place}` : "before the point"} of ${worst.component} at t = ${worst.t} s`]);
    rows.push(["expected", marked(worst.expected, place)], ["got", marked(worst.got, place)]);
    if (path.wrong_from_s !== null) rows.push(["beyond tolerance", `from t = ${path.wrong_from_s} s on`]);
  }
  if (transits) {
    const listed = (times) => (times.length ? ` (${times.slice(0, 3).map((t) => t.toFixed(6)).join(", ")}${times.length > 3 ? " …" : ""} s)` : "");
    rows.push(["transits", `${transits.matched} matched, ${transits.missed.length} missed${listed(transits.missed)}, ${transits.extra.length} extra${listed(transits.extra)}`]);
    rows.push(["their error", `${small(transits.max_error_s)} s, ${small(transits.max_conditioned_error_m)} m of the motion`]);
  }
  return rows;
}

function show(files) {
  shown.className = "";
  try {
    const result = judge(candidateOf(files), truth, allowedBy(tolerance.value));
    const list = rowsOf(result).map(([name, value]) => `<dt>${name}</dt><dd>${value}</dd>`).join("");
    const notes = result.notes.map((note) => `<li>${escaped(note)}</li>`).join("");
    const errors = result.path?.errors;
    const wide = Math.max(280, Math.min(640, shown.clientWidth - 20)); // px
    const picture = errors ? errorPicture({ errors, tolerance: result.tolerance_m, bound: truth.bound_m, end: truth.t_end, wide }) : "";
    const names = files.map((file) => escaped(file.name)).join(" and ");
    shown.className = result.verdict;
    shown.innerHTML = `<p class="word"><strong>${names} ${result.verdict}</strong> with ${escaped(truth.id)}</p><dl>${list}</dl><ul>${notes}</ul>${picture}`;
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    shown.className = "refused";
    shown.innerHTML = `<p class="word"><strong>Not judged</strong></p><p>${escaped(error.message)}</p>`;
  }
}

async function take(files) {
  if (!files.length) return;
  last = await Promise.all([...files].map(async (file) => ({ name: file.name, text: await file.text() })));
  show(last);
}

tolerance.placeholder = small(truth.words.TOLERANCE * truth.amplitude_m);
tolerance.addEventListener("change", () => last.length && show(last));
document.getElementById("files").addEventListener("change", (event) => take(event.target.files));
for (const kind of ["dragenter", "dragover", "dragleave", "drop"]) {
  zone.addEventListener(kind, (event) => {
    event.preventDefault();
    zone.classList.toggle("over", kind === "dragenter" || kind === "dragover");
    if (kind === "drop") take(event.dataTransfer.files);
  });
}
