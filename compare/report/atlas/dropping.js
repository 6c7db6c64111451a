// The page of a scene: take files that are dropped or chosen, have them judged, and show the verdict; play the motion.
"use strict";

const page = JSON.parse(document.getElementById("truth").textContent);
const zone = document.getElementById("drop");
const shown = document.getElementById("verdict");
const tolerance = document.getElementById("tolerance");
let last = [];
let drops = 0; // so far: of two the later one is shown

// The golden function {record, coefficients, end}: in the page, or in a script beside it; null without one.
let functionRead = null; // a promise of it
function readGoldenFunction() {
  functionRead ??= page.beside === null ? Promise.resolve(page.function) : new Promise((done) => {
    const script = document.createElement("script");
    script.onload = () => done(globalThis.goldenFunction);
    script.onerror = () => {
      page.missing = `${page.beside} is not beside this page: only rows at the golden times are judged.`;
      done(null);
    };
    script.src = page.beside;
    document.head.append(script);
  });
  return functionRead;
}

// What answers files: a worker that knows the golden data.
let judging = null;
function judgingWorker() {
  judging ??= readGoldenFunction().then(async (goldenFunction) => {
    const worker = startedWorker("judging");
    await worker.ask("know", { data: page, goldenFunction });
    return worker;
  });
  return judging;
}

function referenceText({ at_any_time: exact, bound_m: bound }) {
  if (exact) return `the golden function, which is within ${atMost(bound)} m of the truth at every time (proven)`;
  return `the golden rows, as doubles within ${atMost(bound)} m of the truth`;
}

async function take(files) {
  if (!files.length) return;
  last = [...files];
  const drop = ++drops;
  const names = last.map((file) => file.name).join(" and ");
  shown.className = "working";
  shown.replaceChildren(elementOf("p", { className: "word" }, `Judging ${names} …`));
  const worker = await judgingWorker();
  const result = await worker.ask("judge", { files: last, tolerance: tolerance.value });
  if (drop !== drops) return;
  const scene = { name: page.id, end: page.t_end, reference: referenceText, bound: "bound of the truth" };
  showVerdict(shown, last, result, scene, page.missing ? [page.missing] : []);
  if (result.mine) player.drop(result.mine, result.path.max_error_m);
}

// What is played: the golden function that the page holds, or else the motion that the page computes.
function goldenMotion() {
  const { at, end } = functionOf(page.function);
  return {
    at,
    end,
    period: Math.min(end, page.omega ? (2 * Math.PI) / page.omega : end),
    amplitude: page.amplitude_m,
    length: page.length_m,
    wide: doubles(page.grid.z).some((height) => height > -0.7 * page.length_m),
  };
}

async function computedMotion() {
  const { texts, fields, words } = page.pendulum;
  const worker = startedWorker("solving");
  const solved = await worker.ask("solve", { texts, fields, words });
  worker.stop();
  if (solved.refused) {
    document.getElementById("played").textContent = solved.refused;
    return null;
  }
  document.getElementById("played").textContent = `Computed in this page, its error estimated at ${small(solved.facts.error)} m.`;
  return playedMotion(sceneOf(texts, fields), solved);
}

const player = playerOf(document.getElementById("player"), async () => (page.function ? goldenMotion() : computedMotion()));
tolerance.placeholder = small(page.words.TOLERANCE * page.amplitude_m);
tolerance.addEventListener("change", () => take(last));
takeFiles(zone, take);
if (page.function) player.ready();
