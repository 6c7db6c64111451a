// Play the motion from the golden function, seen from above and, where the bob swings wide, from the south; beside it
// the rows of a dropped file, their distance from it enlarged. Nothing moves before the button is pressed.
"use strict";

const player = document.getElementById("player");
const [canvas, button, speed, slider] = ["canvas", "button", "select", "input"].map((name) => player?.querySelector(name));
const still = matchMedia("(prefers-reduced-motion: reduce)");
const TRAIL = 240; // points of the trail
const SHARE = 0.15; // of the amplitude, that enlarged errors take up at most
const MOST_ROWS = 1000; // of a file, in the trail
let scene = null; // { at, end, period, panels, size }
let dropped = null; // { t, x, y, scale } of a dropped file
let now = 0;
let playing = false;
let before = 0; // ms, of the last frame

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);

async function ready() {
  if (scene) return true;
  const made = await functionMade();
  if (!made) return false;
  const { at, end } = functionOf(made);
  const z = doubles(page.grid.z);
  const wide = z.some((height) => height > -0.7 * page.length_m);
  const period = Math.min(end, page.omega ? (2 * Math.PI) / page.omega : end);
  // each panel: which two components, and where its middle is
  scene = { at, end, period, panels: wide ? [[0, 1, page.amplitude_m], [0, 2, page.length_m]] : [[0, 1, page.amplitude_m]] };
  now = period;
  return true;
}

function line(context, points, shown) {
  context.beginPath();
  points.forEach((point, i) => context[i ? "lineTo" : "moveTo"](...shown(point)));
  context.stroke();
}

function dot(context, [x, y], radius, filled) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context[filled ? "fill" : "stroke"]();
}

// Rows of the file within the trail, each moved away from the golden state of its own time by `scale` times its error.
function droppedRows(from, until) {
  const [first, last] = [nearest(dropped.t, from), nearest(dropped.t, until)];
  const each = Math.ceil((last - first + 1) / MOST_ROWS);
  const rows = [];
  for (let row = first; row <= last; row += each) if (dropped.t[row] >= from && dropped.t[row] <= until) rows.push(row);
  return rows.map((row) => {
    const golden = scene.at(Math.min(dropped.t[row], scene.end));
    const moved = (k, value) => golden[k] + dropped.scale * (value - golden[k]);
    return [moved(0, dropped.x[row]), moved(1, dropped.y[row])];
  });
}

function draw() {
  const ratio = devicePixelRatio || 1;
  const side = Math.min(360, (player.clientWidth - 12) / (player.clientWidth < 700 ? 1 : scene.panels.length));
  const across = player.clientWidth < 700 ? 1 : scene.panels.length;
  const down = scene.panels.length / across;
  [canvas.style.width, canvas.style.height] = [`${side * across}px`, `${side * down}px`];
  [canvas.width, canvas.height] = [side * across * ratio, side * down * ratio];
  const context = canvas.getContext("2d");
  context.scale(ratio, ratio);
  context.font = "12px system-ui, sans-serif";
  const begin = Math.max(0, now - scene.period);
  const trail = Array.from({ length: TRAIL + 1 }, (_, i) => scene.at(begin + ((now - begin) * i) / TRAIL));
  const mine = dropped && droppedRows(begin, now);
  scene.panels.forEach(([i, j, size], n) => {
    const [left, top] = across > 1 ? [n * side, 0] : [0, n * side];
    const unit = (side / 2 - 14) / size;
    const shown = (state) => [left + side / 2 + unit * state[i], top + side / 2 - unit * state[j]];
    [context.strokeStyle, context.fillStyle, context.lineWidth] = [colour("--rule"), colour("--faint"), 1];
    dot(context, [left + side / 2, top + side / 2], side / 2 - 14, false);
    context.fillText(j === 1 ? "from above: x east, y north" : "from the south: x east, z up", left + 4, top + 12);
    if (j === 2) line(context, [[0, 0, 0], trail[TRAIL]], shown); // the cord
    [context.strokeStyle, context.fillStyle, context.lineWidth] = [colour("--blue"), colour("--blue"), 1.5];
    line(context, trail, shown);
    dot(context, shown(trail[TRAIL]), 5, true);
    if (!mine?.length || j === 2) return;
    context.strokeStyle = colour("--bad");
    line(context, mine, shown);
    dot(context, shown(mine[mine.length - 1]), 7, false);
  });
  slider.value = now / scene.end;
  const enlarged = dropped ? `; yours in orange${dropped.scale > 1 ? `, its error times ${dropped.scale.toLocaleString("en")}` : ""}` : "";
  player.querySelector("output").textContent = `t = ${now.toPrecision(7)} s of ${page.t_end} s${enlarged}`;
}

function frame() {
  if (!playing) return;
  const time = performance.now();
  if (!still.matches || time - before >= 1000) { // with reduced motion, a still picture each second
    now += (Math.min(time - before, 1000) / 1000) * (Number(speed.value) * scene.period || 1);
    if (now >= scene.end) now %= scene.end;
    before = time;
    draw();
  }
  requestAnimationFrame(frame);
}

async function press() {
  if (!(await ready())) return;
  playing = !playing;
  button.textContent = playing ? "Pause" : "Play";
  before = performance.now();
  if (playing) requestAnimationFrame(frame);
}

function drawDropped([t, x, y], error) {
  const room = (SHARE * page.amplitude_m) / error;
  dropped = { t, x, y, scale: room > 1 ? 10 ** Math.floor(Math.log10(room)) : 1 };
  ready().then((there) => {
    if (!there) return;
    now = Math.min(scene.end, Math.max(t[0] + scene.period, scene.period));
    draw();
  });
}

if (player) {
  button.addEventListener("click", press);
  slider.addEventListener("input", async () => (await ready()) && ((now = slider.value * scene.end), draw()));
  addEventListener("resize", () => scene && draw());
  still.addEventListener("change", () => playing && press());
  listeners.push(drawDropped);
  if (page.beside === null) ready().then(draw);
}
