// Answer what files are dropped. Pure functions, for a worker; need judging.js.
"use strict";

const MOST_POINTS = 800; // of the picture of the errors
const HEAD = 65536; // characters of a file that tell its columns

// Whether a file holds times of xdot = 0: it is called so, or it has a column t and neither x nor y.
function isOfTransits({ name, text }, words) {
  if (/transit/i.test(name)) return true;
  const head = text.slice(0, HEAD);
  const lines = text.length > HEAD ? head.slice(0, head.lastIndexOf("\n")) : text;
  const reads = (needed) => {
    try {
      readColumns(lines, needed, words);
      return true;
    } catch (error) {
      if (error instanceof Unreadable) return false;
      throw error;
    }
  };
  const positions = [["t", "x", "y"], ["t", "x"], ["t", "y"]];
  return reads(["t"]) && !positions.some(reads);
}

// Put the files of one drop together to a candidate.
function candidateOf(files, words) {
  const candidate = { columns: null, transits: null, notes: [], clock: null };
  for (const file of files) {
    const ofTransits = isOfTransits(file, words);
    if (ofTransits ? candidate.transits : candidate.columns) throw new Unreadable("Drop one trajectory, and one file of transits at most.");
    try {
      const read = (ofTransits ? readTransits : readTrajectory)(file.text, words);
      candidate.columns ??= read.columns && !ofTransits ? read.columns : null;
      candidate.transits ??= read.transits;
      candidate.clock ??= read.clock ?? null;
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

// The largest error in each of as many equal parts as a picture resolves: [[t, error], …].
function thinned({ t, position }) {
  const each = Math.ceil(t.length / MOST_POINTS);
  const points = [];
  for (let i = 0; i < t.length; i += each) points.push([t[i], most(position.subarray(i, i + each))]);
  return points;
}

const textsOf = (files) => Promise.all([...files].map(async (file) => ({ name: file.name, text: await file.text() })));

// The verdict on files [{name, text}], and what is drawn of it; {refused} says why there is none.
function answer(files, tolerance, truth) {
  try {
    const allowed = allowedBy(tolerance);
    const candidate = countedFromRelease(candidateOf(files, truth.words), truth, allowed);
    const { path, ...result } = judge(candidate, truth, allowed);
    if (!path) return { ...result, path };
    const { errors, ...verdict } = path;
    const { t, x, y } = candidate.columns;
    const mine = [t, x, y].map((column) => Float64Array.from(column));
    return { ...result, path: verdict, points: thinned(errors), mine };
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    return { refused: error.message };
  }
}

// Let a worker answer messages {id, task, …} by tasks, functions of the message and of what reports the progress.
function serve(tasks) {
  onmessage = async ({ data: { id, task, ...message } }) => {
    try {
      const result = await tasks[task](message, (progress) => postMessage({ id, progress }));
      postMessage({ id, result });
    } catch (error) {
      postMessage({ id, result: { refused: `The script failed: ${error.message}.` } });
      throw error;
    }
  };
}
