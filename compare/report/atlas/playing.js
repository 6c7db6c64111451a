// Play a motion, seen from above and, where the bob swings wide, from the south; beside it the rows of a dropped file,
// their distance from it enlarged.
"use strict";

const TRAIL = 240; // points of the trail
const SHARE = 0.15; // of the amplitude, that enlarged errors take up at most
const MOST_SHOWN = 1000; // rows of a file in the trail
const MARGIN = 14; // px
const BROAD = 700; // px: two panels stand side by side
const MOST_SIDE = 360; // px

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);
const still = matchMedia("(prefers-reduced-motion: reduce)");

function path(context, points, shown) {
  context.beginPath();
  points.forEach((point, i) => context[i ? "lineTo" : "moveTo"](...shown(point)));
  context.stroke();
}

function disc(context, [x, y], radius, filled) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context[filled ? "fill" : "stroke"]();
}

// A player in an element of player.html. `load` returns a promise of the motion {at, end, period, amplitude, length, wide}
// or of null; it is called when the player is first used.
function playerOf(element, load) {
  const part = (name) => element.querySelector(name);
  const [canvas, button, speed] = [part("canvas"), part("button"), part("select")];
  const [slider, output] = [part("input"), part("output")];
  let motion = null;
  let panels = []; // { across, up, size, title }: two components, and the length in m that half of the panel shows
  let dropped = null; // { t, x, y, scale } of a dropped file
  let now = 0; // s
  let playing = false;
  let before = 0; // ms, of the last frame

  function show(next, from = next.period) {
    motion = next;
    dropped = null;
    panels = [{ across: 0, up: 1, size: motion.amplitude, title: "from above: x east, y north" }];
    if (motion.wide) panels.push({ across: 0, up: 2, size: motion.length, title: "from the south: x east, z up" });
    now = Math.min(from, motion.end);
    draw();
  }

  async function ready() {
    if (motion) return true;
    output.textContent = "Computing the motion …";
    const loaded = await load();
    output.textContent = "";
    if (loaded) show(loaded);
    return Boolean(loaded);
  }

  // Rows of the file within the trail, each moved away from the motion at its own time by `scale` times its error.
  function droppedRows(from, until) {
    const first = nearest(dropped.t, from);
    const last = nearest(dropped.t, until);
    const each = Math.ceil((last - first + 1) / MOST_SHOWN);
    const points = [];
    for (let row = first; row <= last; row += each) {
      const time = dropped.t[row];
      if (time < from || time > until) continue;
      const [x, y] = motion.at(Math.min(time, motion.end));
      points.push([x + dropped.scale * (dropped.x[row] - x), y + dropped.scale * (dropped.y[row] - y)]);
    }
    return points;
  }

  function sized() {
    const across = element.clientWidth < BROAD ? 1 : panels.length;
    const down = panels.length / across;
    const side = Math.max(2 * MARGIN, Math.min(MOST_SIDE, (element.clientWidth - 12) / across));
    const ratio = devicePixelRatio || 1;
    canvas.style.width = `${side * across}px`;
    canvas.style.height = `${side * down}px`;
    canvas.width = side * across * ratio;
    canvas.height = side * down * ratio;
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.font = "12px system-ui, sans-serif";
    return { context, side, across };
  }

  function drawPanel(context, { across, up, size, title }, [left, top], side, trail, mine) {
    const middle = [left + side / 2, top + side / 2];
    const unit = (side / 2 - MARGIN) / size;
    const shown = (state) => [middle[0] + unit * state[across], middle[1] - unit * state[up]];
    const bob = trail[TRAIL];
    context.strokeStyle = colour("--rule");
    context.fillStyle = colour("--faint");
    context.lineWidth = 1;
    disc(context, middle, side / 2 - MARGIN, false);
    context.fillText(title, left + 4, top + 12);
    if (up === 2) path(context, [[0, 0, 0], bob], shown); // the cord

    context.strokeStyle = colour("--blue");
    context.fillStyle = colour("--blue");
    context.lineWidth = 1.5;
    path(context, trail, shown);
    disc(context, shown(bob), 5, true);
    if (!mine?.length || up === 2) return;
    context.strokeStyle = colour("--bad");
    path(context, mine, shown);
    disc(context, shown(mine[mine.length - 1]), 7, false);
  }

  function draw() {
    const { context, side, across } = sized();
    const begin = Math.max(0, now - motion.period);
    const trail = Array.from({ length: TRAIL + 1 }, (_, i) => motion.at(begin + ((now - begin) * i) / TRAIL));
    const mine = dropped && droppedRows(begin, now);
    panels.forEach((panel, i) => {
      const corner = across > 1 ? [i * side, 0] : [0, i * side];
      drawPanel(context, panel, corner, side, trail, mine);
    });
    slider.value = now / motion.end;
    const scale = dropped?.scale > 1 ? `, its error times ${dropped.scale.toLocaleString("en")}` : "";
    const beside = dropped ? `; yours in orange${scale}` : "";
    output.textContent = `t = ${now.toPrecision(7)} s of ${motion.end} s${beside}`;
  }

  function frame() {
    if (!playing) return;
    const time = performance.now();
    if (!still.matches || time - before >= 1000) { // with reduced motion, a still picture each second
      const seconds = Math.min(time - before, 1000) / 1000;
      now += seconds * (Number(speed.value) * motion.period || 1);
      if (now >= motion.end) now %= motion.end;
      before = time;
      draw();
    }
    requestAnimationFrame(frame);
  }

  function play(on) {
    playing = on;
    button.textContent = playing ? "Pause" : "Play";
    before = performance.now();
    if (playing) requestAnimationFrame(frame);
  }

  // Show the columns t, x, y of a file beside the motion; `error` is its largest in m.
  async function drop([t, x, y], error) {
    if (!(await ready())) return;
    const room = (SHARE * motion.amplitude) / error;
    dropped = { t, x, y, scale: room > 1 ? 10 ** Math.floor(Math.log10(room)) : 1 };
    now = Math.min(motion.end, Math.max(t[0] + motion.period, motion.period));
    draw();
  }

  button.addEventListener("click", async () => (await ready()) && play(!playing));
  slider.addEventListener("input", async () => {
    const chosen = Number(slider.value); // when a motion is first shown, it moves the slider
    if (!(await ready())) return;
    now = chosen * motion.end;
    draw();
  });
  addEventListener("resize", () => motion && draw());
  still.addEventListener("change", () => playing && play(false));
  return { show, ready, drop, play, playing: () => playing, time: () => now };
}
