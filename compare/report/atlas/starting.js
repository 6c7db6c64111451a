// Start the worker that solves a pendulum, made of the page's own scripts, and ask it.
"use strict";

// What a worker of the page's scripts with a class answers: `ask(task, message, report)` is a promise.
function startedWorker(kind) {
  const scripts = [...document.querySelectorAll(`script.${kind}`)].map((script) => script.textContent);
  const address = URL.createObjectURL(new Blob(scripts, { type: "text/javascript" }));
  const worker = new Worker(address);
  const waiting = new Map();
  let asked = 0;

  worker.onmessage = ({ data: { id, progress, result } }) => {
    const { done, report } = waiting.get(id);
    if (progress !== undefined) {
      report(progress);
      return;
    }
    waiting.delete(id);
    done(result);
  };
  worker.onerror = (event) => {
    for (const { done } of waiting.values()) done({ refused: `The script failed: ${event.message}.` });
    waiting.clear();
  };

  return {
    ask(task, message, report = () => {}) {
      const id = ++asked;
      worker.postMessage({ id, task, ...message });
      return new Promise((done) => waiting.set(id, { done, report }));
    },
    stop() {
      worker.terminate();
      URL.revokeObjectURL(address);
    },
  };
}

// The motion that a worker has solved, up to the end that it says, as a player plays it.
function playedMotion(scene, { steps, facts: { end, amplitude, wide } }) {
  const problem = problemOf({ ...scene, run: { ...scene.run, t_end: end } });
  const { length, swing } = problem;
  const period = swing ? (2 * Math.PI) / swing : end;
  return { at: motionOf({ problem, ...steps }), end, period: Math.min(end, period), amplitude, length, wide };
}
