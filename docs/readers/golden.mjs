// Read a golden dataset in JavaScript, as doubles from hexfloats: node golden.mjs data/golden/paris
import { existsSync, readFileSync } from "node:fs";

const folder = process.argv[2] ?? ".";
const json = (name) => JSON.parse(readFileSync(`${folder}/${name}`, "utf8"));
const there = (name) => existsSync(`${folder}/${name}`);

function table(name) { // rows as objects: row.x is a text
  const [header, ...rows] = readFileSync(`${folder}/${name}`, "utf8").trimEnd().split("\n").map((row) => row.split(","));
  return rows.map((row) => Object.fromEntries(row.map((cell, i) => [header[i], cell])));
}

function hexfloat(text) { // JavaScript reads none by itself; nothing is rounded here
  const [, sign, whole, part, power] = /^(-?)0x([01])\.([0-9a-f]+)p([+-]\d+)$/.exec(text);
  return (sign ? -1 : 1) * (parseInt(whole + part, 16) / 16 ** part.length) * 2 ** power;
}

const { bounds } = json("manifest.json");
const grid = table("grid.binary64.csv");
const last = grid.at(-1);
console.log(`grid ${grid.length}\nt ${hexfloat(last.t_hex)}`);
for (const [name, bound] of Object.entries(bounds.grid)) console.log(name, hexfloat(last[`${name}_hex`]), bound);
if (there("transits.csv")) {
  const transits = table("transits.csv");
  console.log("transits", transits.length, transits.reduce((most, row) => Math.max(most, Number(row.bound)), 0));
}
if (there("vectors.json")) {
  const { states, transits } = json("vectors.json");
  console.log("vectors", states.length, transits.length, states[1].values.x.hexfloat);
}
