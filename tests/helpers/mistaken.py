"""A Foucault pendulum in Python, as somebody might write it, with mistakes: key=value. Prints t,x,y.

It shares nothing with the project: the cord's pull in Cartesian coordinates, or small swings; scipy, RK4 or leapfrog.
"""

import math
import sys

word = {key: float(value) for key, value in (argument.split("=") for argument in sys.argv[1:])}


def given(name, default):
    return word.get(name, default)


length, g = given("l", 67) * given("ltimes", 1), given("g", 9.80665) * given("gtimes", 1)
latitude = math.radians(given("lat", 45))
turn = given("rate", 7.292115e-5) * given("ratetimes", 1)
drag, half, out, t_end = given("drag", 0), given("half", 1), given("out", 2), given("tend", 600)
rows, h = round(t_end / out), given("h", 0.01)
f = 1 / 298.257223564
e2 = f * (2 - f)
axis = 6378137 / math.sqrt(1 - e2 * math.sin(latitude) ** 2) * math.cos(latitude)
coriolis = math.radians(given("corlat", math.degrees(latitude)))
north, up = turn * math.cos(latitude), turn * math.sin(latitude)
cn, cu = half * given("north", 1) * turn * math.cos(coriolis), half * turn * math.sin(coriolis)


def force(x, y, z, vx, vy, vz):
    fx = 2 * (cu * vy - cn * vz) - drag * vx
    fy = -2 * cu * vx - drag * vy
    fz = -g + 2 * cn * vx - drag * vz
    if given("reading", 0) == 0:
        q = axis - y * math.sin(latitude) + z * math.cos(latitude)
        fx += turn * turn * x
        fy -= turn * up * q
        fz += turn * north * q
    return fx, fy, fz


def rates(_, s):
    x, y, z, vx, vy, vz = s
    if given("model", 0) == 1:
        return (
            vx,
            vy,
            0,
            -g / length * x + 2 * cu * vy - drag * vx,
            -g / length * y - 2 * cu * vx - drag * vy,
            0,
        )
    fx, fy, fz = force(*s)
    pull = (vx * vx + vy * vy + vz * vz + x * fx + y * fy + z * fz) / (length * length)
    return vx, vy, vz, fx - x * pull, fy - y * pull, fz - z * pull


def moved(s, k, by):
    return [a + by * b for a, b in zip(s, k, strict=True)]


def step(s):
    if given("method", 4) == 3:  # velocity Verlet
        s = [*s[:3], *moved(s[3:], rates(0, s)[3:], h / 2)]
        s = [*moved(s[:3], s[3:], h), *s[3:]]
        return [*s[:3], *moved(s[3:], rates(0, s)[3:], h / 2)]
    if given("method", 4) == 0:  # semi-implicit Euler
        v = moved(s[3:], rates(0, s)[3:], h)
        return [*moved(s[:3], v, h), *v]
    a = rates(0, s)
    b = rates(0, moved(s, a, h / 2))
    if given("method", 4) == 2:
        return moved(s, b, h)
    c = rates(0, moved(s, b, h / 2))
    d = rates(0, moved(s, c, h))
    return [
        x + h / 6 * (i + 2 * j + 2 * k + m) for x, i, j, k, m in zip(s, a, b, c, d, strict=True)
    ]


x, y = given("x0", 1), given("y0", 0)
# of the Earth, whatever factor the Coriolis force has
stars = given("stars", 0) * turn * math.sin(coriolis)
s = [
    x,
    y,
    -math.sqrt(length * length - x * x - y * y),
    given("vx0", 0) + stars * y,
    given("vy0", 0) - stars * x,
    0,
]
s[5] = -(s[0] * s[3] + s[1] * s[4]) / s[2]
fast = 1 + given("counts_ends", 0) * out / t_end if given("counts_ends", 0) else given("fast", 1)
print("t,x,y")
if "rtol" in word:
    from scipy.integrate import solve_ivp

    times = [out * row for row in range(rows + 1)]
    found = solve_ivp(
        rates, (0, times[-1]), s, t_eval=times, rtol=word["rtol"], atol=word["rtol"] * 1e-3
    ).y
    for t, x, y in zip(times, found[0], found[1], strict=True):
        print(repr(t * fast), repr(float(x)), repr(float(y)), sep=",")
else:
    for row in range(rows + 1):
        print(repr(row * out * fast), repr(s[0]), repr(s[1]), sep=",")
        for _ in range(round(out / h)):
            s = step(s)
