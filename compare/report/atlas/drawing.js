// Numbers as text, and the picture of a verdict: the position error against time on a logarithmic scale, as SVG text.
// Pure functions, without the page.
"use strict";

const [TALL, LEFT, TOP, BOTTOM] = [260, 64, 12, 36];
const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";

// A number of so many digits, without zeros at its end. String drops them; a pattern would take 1e-10 for 1e-1.
const rounded = (value, digits) => String(Number(value.toPrecision(digits)));
const small = (value) => rounded(value, 3);
const raised = (exponent) => `10${exponent < 0 ? "⁻" : ""}${[...String(Math.abs(exponent))].map((digit) => RAISED[digit]).join("")}`;

// Where the axis of errors begins, a power of ten: below the tolerance and the smallest error after the first row, in
// which a program has the right position; but not below the bound of the truth, within which no error is known.
function lowestDecade({ points, tolerance_m: tolerance, bound_m: bound }) {
  const errors = points.slice(1).map(([, error]) => error).filter((error) => error > 0);
  return Math.floor(Math.log10(Math.max(bound, Math.min(tolerance, ...errors))));
}

const showsBound = (result) => result.bound_m >= 10 ** lowestDecade(result);

// Points [[t, error], …] and lines at the tolerance and, where it is on the axis, at the bound, with its word; it spans
// the file.
function errorPicture(result, wide, boundWord) {
  const { points, path, tolerance_m: tolerance, bound_m: bound } = result;
  const low = lowestDecade(result);
  const floor = 10 ** low;
  const high = Math.ceil(Math.log10(Math.max(tolerance, bound, ...points.map((point) => point[1])) * 1.5));
  const [begin, end] = path.covered_s;
  const x = (t) => (LEFT + ((t - begin) / (end - begin || 1)) * (wide - LEFT - 10)).toFixed(1);
  const y = (error) => (TOP + ((high - Math.log10(Math.max(error, floor))) / (high - low)) * (TALL - TOP - BOTTOM)).toFixed(1);
  const spacing = Math.ceil((high - low) / 6);
  const parts = [];
  for (let n = low; n <= high; n += spacing) {
    parts.push(`<path class="rule" d="M${LEFT} ${y(10 ** n)}H${wide - 10}"/>`);
    parts.push(`<text x="${LEFT - 6}" y="${Number(y(10 ** n)) + 4}" text-anchor="end">${raised(n)}</text>`);
  }
  for (const share of wide < 450 ? [0, 0.5, 1] : [0, 0.25, 0.5, 0.75, 1]) {
    const t = begin + share * (end - begin);
    parts.push(`<text x="${x(t)}" y="${TALL - BOTTOM + 16}" text-anchor="${share === 1 ? "end" : "middle"}">${rounded(t, 6)}</text>`);
  }
  const line = (value, word) => `<path class="guide" d="M${LEFT} ${y(value)}H${wide - 10}"/><text x="${wide - 12}" y="${Number(y(value)) - 4}" text-anchor="end">${word}</text>`;
  parts.push(line(tolerance, "tolerance"));
  if (showsBound(result)) parts.push(line(bound, boundWord));
  parts.push(`<path class="error" d="${points.map(([t, error], i) => `${i ? "L" : "M"}${x(t)} ${y(error)}`).join("")}"/>`);
  if (points.length === 1) parts.push(`<circle cx="${x(points[0][0])}" cy="${y(points[0][1])}" r="3"/>`);
  parts.push(`<text x="${(LEFT + wide) / 2}" y="${TALL - 4}" text-anchor="middle">t in s</text>`);
  parts.push(`<text transform="translate(14 ${(TOP + TALL - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">position error in m</text>`);
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${wide} ${TALL}" class="errors" role="img" aria-label="Position error in m against time">${parts.join("")}</svg>`;
}
