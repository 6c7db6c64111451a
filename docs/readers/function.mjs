// Evaluate a golden function in JavaScript: node function.mjs FOLDER 17.25 3600
// Prints t, x, y, z, vx, vy, vz for each time; docs/format.md specifies the files and every operation.
import { readFileSync } from "node:fs";

// Return what gives [x, y, z, vx, vy, vz] at a time, from function.json and a DataView of function.f64.
export function evaluator({ degree, components, length_squared, times: ends }, numbers) {
  function fromHex(text) { // "0x1.8p+3"
    const [, whole, part, exponent] = /^0x([01])\.([0-9a-f]+)p([+-]\d+)$/.exec(text);
    return parseInt(whole + part, 16) * 2 ** (Number(exponent) - 4 * part.length);
  }
  const times = ends.map(fromHex), square = length_squared && fromHex(length_squared), last = times.length - 1;

  return function at(t) {
    if (!(t >= 0 && t <= times[last])) throw new RangeError(`${t}: not within 0 to ${times[last]} s`);
    let low = 0, high = last; // times[low] <= t, and t < times[high] but at the very end
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= t) low = middle; else high = middle;
    }
    const a = times[low], b = times[high], w = b - a, u = ((t - a) - (b - t)) / w, y = u + u;
    const position = [], velocity = [];
    for (let i = 0; i < components.length; i++) {
      const first = 8 * (low * components.length + i) * (degree + 1);
      let b1 = 0, b2 = 0, d1 = 0, d2 = 0;
      for (let k = degree; k > 0; k--) {
        const c = numbers.getFloat64(first + 8 * k, true), b0 = (y * b1 - b2) + c, d0 = (y * d1 - d2) + k * c;
        b2 = b1; b1 = b0; d2 = d1; d1 = d0;
      }
      position.push((u * b1 - b2) + numbers.getFloat64(first, true));
      velocity.push((d1 + d1) / w);
    }
    if (square !== null) {
      const [x, y] = position, [vx, vy] = velocity, z = -Math.sqrt(square - (x * x + y * y));
      position.push(z);
      velocity.push(-(x * vx + y * vy) / z);
    }
    return [...position, ...velocity];
  };
}

const [folder, ...asked] = process.argv.slice(2);
const bytes = readFileSync(`${folder}/function.f64`);
const numbers = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
const at = evaluator(JSON.parse(readFileSync(`${folder}/function.json`, "utf8")), numbers);
for (const text of asked) console.log([Number(text), ...at(Number(text))].join(" "));
