// The page of a scene: take files that are dropped or chosen, have them judged, and show the verdict.
"use strict";

const page = JSON.parse(document.getElementById("truth").textContent);
const zone = document.getElementById("drop");
const shown = document.getElementById("verdict");
const tolerance = document.getElementById("tolerance");
const listeners = []; // called with the columns t, x, y of what was judged
let last = [];
let drops = 0; // so far: of two the later one is shown

const escaped = (text) => String(text).replace(/[&<>"]/g, (letter) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[letter]);

// The golden function {record, coefficients, end}: in the page, or in a script beside it; null without one.
let made = null;
function functionMade() {
  made ??= page.beside === null ? Promise.resolve(page.function) : new Promise((done) => {
    const script = document.createElement("script");
    script.onload = () => done(globalThis.goldenFunction);
    script.onerror = () => {
      page.missing = `${page.beside} is not beside this page: only rows at the golden times are judged.`;
      done(null);
    };
    script.src = page.beside;
    document.head.append(script);
  });
  return made;
}

// What answers files: a worker of the page's own scripts.
let worker = null;
async function answered(files, drop) {
  worker ??= functionMade().then((made) => {
    const scripts = [...document.querySelectorAll("script.judging")].map((script) => script.textContent);
    const started = new Worker(URL.createObjectURL(new Blob(scripts, { type: "text/javascript" })));
    started.postMessage({ truth: page, made });
    return started;
  });
  const started = await worker;
  return new Promise((done) => {
    started.onmessage = ({ data }) => data.drop === drop && done(data);
    started.onerror = (event) => done({ refused: `The script failed: ${event.message}.` });
    started.postMessage({ files, tolerance: tolerance.value, drop });
  });
}

// A number with its digits, the first wrong one marked.
function marked(value, place) {
  const digits = value.toFixed(Math.min(Math.max(place + 3, 1), 17));
  const at = digits.indexOf(".") + place + (place > 0 ? 0 : -1);
  if (at < 0 || !/\d/.test(digits[at] ?? "")) return escaped(digits);
  return `${digits.slice(0, at)}<mark>${digits[at]}</mark>${digits.slice(at + 1)}`;
}

// A bound is given 1.005 times as large, so that rounding to three digits does not take from it.
function rowsOf({ path, transits, tolerance_m: allowed, bound_m: bound, amplitude_m: amplitude, at_any_time: exact }) {
  const rows = [];
  if (path) {
    const { worst } = path;
    const place = firstWrongPlace(worst.difference || bound);
    rows.push(["judged", `${path.rows.toLocaleString("en")} rows, t = ${path.covered_s[0]} to ${path.covered_s[1]} s of ${page.t_end} s`]);
    rows.push(["largest error", `${small(path.max_error_m)} m (tolerance ${small(allowed)} m), at t = ${worst.t} s`]);
    rows.push(["held against", exact ? `the golden function, which is within ${small(1.005 * bound)} m of the truth at every time (proven)` : `the golden rows, as doubles within ${small(1.005 * bound)} m of the truth`]);
    rows.push(["rms, at the end", `${small(path.rms_error_m)} m, ${small(path.end_error_m)} m`]);
    rows.push(["digits", `${Math.max(path.digits, 0).toFixed(1)} of the amplitude of ${small(amplitude)} m`]);
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

function show(files, result) {
  if (result.refused) {
    shown.className = "refused";
    shown.innerHTML = `<p class="word"><strong>Not judged</strong></p><p>${escaped(result.refused)}</p>`;
    return;
  }
  const list = rowsOf(result).map(([name, value]) => `<dt>${name}</dt><dd>${value}</dd>`).join("");
  const notes = [...result.notes, ...(page.missing ? [page.missing] : [])].map((note) => `<li>${escaped(note)}</li>`).join("");
  const wide = Math.max(280, Math.min(640, shown.clientWidth - 20)); // px
  const names = files.map((file) => escaped(file.name)).join(" and ");
  shown.className = result.verdict;
  shown.innerHTML = `<p class="word"><strong>${names} ${result.verdict}</strong> with ${escaped(page.id)}</p><dl>${list}</dl><ul>${notes}</ul>${result.points ? errorPicture(result, wide) : ""}`;
}

async function take(files) {
  if (!files.length) return;
  last = [...files];
  const drop = ++drops;
  shown.className = "working";
  shown.innerHTML = `<p class="word">Judging ${last.map((file) => escaped(file.name)).join(" and ")} …</p>`;
  const result = await answered(last, drop);
  if (drop !== drops) return;
  show(last, result);
  if (result.mine) for (const listener of listeners) listener(result.mine, result.path.max_error_m);
}

tolerance.placeholder = small(page.words.TOLERANCE * page.amplitude_m);
tolerance.addEventListener("change", () => take(last));
document.getElementById("files").addEventListener("change", (event) => take(event.target.files));
for (const kind of ["dragenter", "dragover", "dragleave", "drop"]) {
  zone.addEventListener(kind, (event) => {
    event.preventDefault();
    zone.classList.toggle("over", kind === "dragenter" || kind === "dragover");
    if (kind === "drop") take(event.dataTransfer.files);
  });
}
