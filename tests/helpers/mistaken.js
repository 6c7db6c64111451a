// A Foucault pendulum in JavaScript, as somebody might write it, with mistakes: key=value. Prints t,x,y. It shares
// nothing with the project: the cord's pull in Cartesian coordinates, or small swings; RK4, leapfrog or Euler.
const word = Object.fromEntries(process.argv.slice(2).map(argument => argument.split("=")))
const given = (name, otherwise) => name in word ? Number(word[name]) : otherwise
const l = given("l", 67) * given("ltimes", 1), g = given("g", 9.80665) * given("gtimes", 1)
const phi = given("lat", 45) * Math.PI / 180, sin = Math.sin(phi), cos = Math.cos(phi)
const omega = given("rate", 7.292115e-5) * given("ratetimes", 1)
const drag = given("drag", 0), half = given("half", 1), out = given("out", 2), tEnd = given("tend", 600)
const rows = Math.round(tEnd / out), h = given("h", 0.01), method = given("method", 4)
const f = 1 / 298.257223564, e2 = f * (2 - f), axis = 6378137 / Math.sqrt(1 - e2 * sin * sin) * cos
const turned = given("corlat", given("lat", 45)) * Math.PI / 180
const cn = half * given("north", 1) * omega * Math.cos(turned), cu = half * omega * Math.sin(turned)
const rates = ([x, y, z, vx, vy, vz]) => {
  if (given("model", 0) === 1)
    return [vx, vy, 0, -g / l * x + 2 * cu * vy - drag * vx, -g / l * y - 2 * cu * vx - drag * vy, 0]
  const a = [2 * (cu * vy - cn * vz) - drag * vx, -2 * cu * vx - drag * vy, -g + 2 * cn * vx - drag * vz]
  if (given("reading", 0) === 0) {
    const q = axis - y * sin + z * cos
    a[0] += omega * omega * x
    a[1] -= omega * omega * sin * q
    a[2] += omega * omega * cos * q
  }
  const pull = (vx * vx + vy * vy + vz * vz + x * a[0] + y * a[1] + z * a[2]) / (l * l)
  return [vx, vy, vz, a[0] - x * pull, a[1] - y * pull, a[2] - z * pull]
}
const moved = (s, k, by) => s.map((value, i) => value + by * k[i])
const kicked = (s, by) => { const k = rates(s); return s.map((value, i) => i < 3 ? value : value + by * k[i]) }
const drifted = (s, by) => s.map((value, i) => i < 3 ? value + by * s[i + 3] : value)
const step = s => {
  if (method === 3) return kicked(drifted(kicked(s, h / 2), h), h / 2)
  if (method === 0) return drifted(kicked(s, h), h)
  if (method === 1) return moved(s, rates(s), h)
  const a = rates(s), b = rates(moved(s, a, h / 2))
  if (method === 2) return moved(s, b, h)
  const c = rates(moved(s, b, h / 2)), d = rates(moved(s, c, h))
  return s.map((value, i) => value + h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]))
}
const x = given("x0", 1), y = given("y0", 0), z = -Math.sqrt(l * l - x * x - y * y)
const stars = given("stars", 0) * omega * Math.sin(turned) // of the Earth, whatever factor the Coriolis force has
const vx = given("vx0", 0) + stars * y, vy = given("vy0", 0) - stars * x
const fast = "counts_ends" in word ? 1 + Number(word.counts_ends) * out / tEnd : given("fast", 1)
let s = [x, y, z, vx, vy, -(x * vx + y * vy) / z]
console.log("t,x,y")
for (let row = 0; row <= rows; row++) {
  console.log([row * out * fast, s[0], s[1]].join(","))
  for (let k = 0; k < Math.round(out / h); k++) s = step(s)
}
