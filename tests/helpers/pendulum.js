// A Foucault pendulum in JavaScript, as somebody else would write it: accelerations with the cord's pull, RK4, CSV on stdout.
// node pendulum.js x0 y0 length latitude gravity rotation_rate t_end step
const [x0, y0, l, latitude, g, omega, tEnd, h] = process.argv.slice(2).map(Number);
const phi = latitude * Math.PI / 180, s = Math.sin(phi), c = Math.cos(phi);
const f = 1 / 298.257223564, e2 = f * (2 - f);
const R = 6378137 / Math.sqrt(1 - e2 * s * s) * c;
const rates = ([x, y, z, vx, vy, vz]) => {
  const q = R - s * y + c * z;
  const a = [
    omega * omega * x - 2 * omega * (c * vz - s * vy),
    -omega * omega * s * q - 2 * omega * s * vx,
    -g + omega * omega * c * q + 2 * omega * c * vx,
  ];
  const pull = (vx * vx + vy * vy + vz * vz + x * a[0] + y * a[1] + z * a[2]) / (l * l);
  return [vx, vy, vz, a[0] - x * pull, a[1] - y * pull, a[2] - z * pull];
};
const add = (u, k, w) => u.map((value, i) => value + w * k[i]);
let u = [x0, y0, -Math.sqrt(l * l - x0 * x0 - y0 * y0), 0, 0, 0];
console.log("time (ms);north;east");
for (let n = 0; n <= Math.round(tEnd / h); n++) {
  if (n % Math.round(60 / h) === 0) console.log([n * h * 1000, u[1], u[0]].join(";"));
  const k1 = rates(u), k2 = rates(add(u, k1, h / 2)), k3 = rates(add(u, k2, h / 2)), k4 = rates(add(u, k3, h));
  u = u.map((value, i) => value + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]));
}
