"""Truth to check the enclosure against: the equations of motion, integrated by heyoka and by scipy."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache

import heyoka as hy
import mpmath as mp
import numpy as np
from enclosure_recurrence import Recurrence

from reference.enclosure.approximant import pair
from reference.enclosure.frames import ColumnSource
from reference.enclosure.trusted.defect import Piece
from reference.enclosure.trusted.radius import Radius
from reference.enclosure.trusted.six_columns import Columns
from reference.enclosure.trusted.system import SceneBalls
from reference.enclosure.trusted.tube import output
from reference.enclosure.trusted.zeros import Scan
from reference.numbers.taylor_step import DIGIT_BITS, Digits, TaylorStep
from reference.scenes.inputs import Inputs

PARIS = Inputs(
    length=Fraction(67), drag=Fraction(0), latitude=Fraction("48.846111"), altitude=Fraction(0),
    gravity=Fraction("9.80665"), rotation_rate=Fraction("7.292115e-5"), equatorial_radius=Fraction(6378137),
    flattening=1 / Fraction("298.257223564"), position=(Fraction("0.3"), Fraction("0.4"), Fraction(0), Fraction(0)),
    angles=None, t_end=Fraction(60), grid_step=Fraction(1),
)  # fmt: skip


def scene(**changes: object) -> Inputs:
    """Paris with changes; numbers as strings, `x`, `y`, `vx`, `vy` or four `angles` in degrees."""
    start = [
        Fraction(str(changes.pop(n, d)))
        for n, d in (("x", "0.3"), ("y", "0.4"), ("vx", 0), ("vy", 0))
    ]
    angles = changes.pop("angles", None)
    turned = tuple(Fraction(str(a)) for a in angles) if angles else None
    numbers = {
        name: value if name == "gravity_is" else Fraction(str(value))
        for name, value in changes.items()
    }
    return replace(PARIS, position=None if turned else tuple(start), angles=turned, **numbers)


def q(number: Fraction):
    return mp.mpf(number.numerator) / number.denominator


def constants(inputs: Inputs):
    """sin, cos of the latitude, R, and the rest, as mpmath numbers."""
    phi, f = q(inputs.latitude) * mp.pi / 180, q(inputs.flattening)
    s, c = mp.sin(phi), mp.cos(phi)
    R = (q(inputs.equatorial_radius) / mp.sqrt(1 - f * (2 - f) * s * s) + q(inputs.altitude)) * c
    R = 0 if inputs.gravity_is == "effective" else R
    return s, c, R, q(inputs.length), q(inputs.gravity), q(inputs.rotation_rate), q(inputs.drag)


def start(inputs: Inputs):
    """x, y, z, vx, vy, vz at t = 0."""
    length = q(inputs.length)
    if inputs.position:
        x, y, vx, vy = map(q, inputs.position)
        z = -mp.sqrt(length**2 - x * x - y * y)
        return [x, y, z, vx, vy, -(x * vx + y * vy) / z]
    a, b, da, db = (q(v) * mp.pi / 180 for v in inputs.angles)
    sa, ca, sb, cb = mp.sin(a), mp.cos(a), mp.sin(b), mp.cos(b)
    speeds = [ca * cb * da - sa * sb * db, ca * sb * da + sa * cb * db, sa * da]
    return [length * v for v in (sa * cb, sa * sb, -ca, *speeds)]


def acceleration(pars, state):
    """The issue's equations of motion, x east, y north, z up, with every term."""
    s, c, R, length, g, om, drag = pars
    x, y, z, u, v, w = state
    q = R - s * y + c * z
    fx = om * om * x - 2 * om * (c * w - s * v) - drag * u
    fy = -om * om * s * q - 2 * om * s * u - drag * v
    fz = -g + om * om * c * q + 2 * om * c * u - drag * w
    pull = (u * u + v * v + w * w + x * fx + y * fy + z * fz) / (length * length)
    return fx - x * pull, fy - y * pull, fz - z * pull


@cache
def integrator(prec: int):
    names = hy.make_vars("x", "y", "z", "u", "v", "w")
    rates = [*names[3:], *acceleration([hy.par[i] for i in range(7)], names)]
    zero = [hy.real(0, prec)] * 7
    return hy.taylor_adaptive(
        list(zip(names, rates, strict=True)),
        zero[:6],
        pars=zero,
        fp_type=hy.real,
        prec=prec,
        compact_mode=True,
    )


def _real(x, prec: int):
    return hy.real(mp.nstr(x, int(prec * 0.302) + 8, strip_zeros=False), prec)


def truth(inputs: Inputs, times: list[Fraction], prec: int = 400) -> list[list[Fraction]]:
    """States at `times` by heyoka in the plain form at `prec` bits."""
    out = []
    with mp.workprec(prec + 64):
        ta = integrator(prec)
        ta.time = hy.real(0, prec)
        ta.state[:] = [_real(x, prec) for x in start(inputs)]
        ta.pars[:] = [_real(x, prec) for x in constants(inputs)]
        for t in times:
            ta.propagate_until(_real(q(t), prec))
            out.append([Fraction(mp.nstr(mp.mpf(str(x)), int(prec * 0.3))) for x in ta.state])
    return out


@cache
def turning(prec: int):
    """The same motion as n and H, for steep scenes: the plain form leaves the sphere there."""
    names = hy.make_vars("x", "y", "z", "a", "b", "c")
    x, y, z, a, b, c = names
    wy, wz, cy, cz = (hy.par[i] for i in range(4))
    q, s = b - wy, c - wz
    rates = [q * z - s * y, s * x - a * z, a * y - q * x]
    rates += [y * cz - z * cy + b * wz - c * wy, -(x * cz) - a * wz, x * cy + a * wy]
    zero = [hy.real(0, prec)] * 6
    return hy.taylor_adaptive(
        list(zip(names, rates, strict=True)),
        zero,
        pars=zero[:4],
        fp_type=hy.real,
        prec=prec,
        compact_mode=True,
    )


def steep_truth(inputs: Inputs, time: Fraction, prec: int) -> list[Fraction]:
    """The state at `time` by heyoka in the momentum form, without drag."""
    with mp.workprec(prec + 64):
        s, c, R, length, g, om, _ = constants(inputs)
        x, y, z, u, v, w = (q / length for q in start(inputs))
        wy, wz = om * c, om * s
        u, v, w = u + wy * z - wz * y, v + wz * x, w - wy * x
        first = [x, y, z, y * w - z * v, z * u - x * w, x * v - y * u]
        ta = turning(prec)
        ta.time = hy.real(0, prec)
        ta.state[:] = [_real(q, prec) for q in first]
        ta.pars[:] = [
            _real(q, prec)
            for q in (wy, wz, -om * om * s * R / length, (om * om * c * R - g) / length)
        ]
        ta.propagate_until(_real(q(time), prec))
        x, y, z, a, b, d = (mp.mpf(str(q)) for q in ta.state)
        b, d = b - wy, d - wz
        end = [x, y, z, b * z - d * y, d * x - a * z, a * y - b * x]
        return [Fraction(mp.nstr(length * q, int(prec * 0.29))) for q in end]


def doubles(inputs: Inputs):
    """Start and right-hand side for double-precision integrators."""
    pars = [float(x) for x in constants(inputs)]

    def rates(_t, s):
        return np.array([*s[3:], *acceleration(pars, s)])

    return rates, np.array([float(x) for x in start(inputs)])


def cross(a, b):
    return [a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def lin(*terms):
    """The sum of vectors, each after its factor."""
    return [sum(f * v[i] for f, v in terms) for i in range(3)]


def contains(interval, x: Fraction) -> bool:
    return interval.low <= x <= interval.high


def unit_step(bits: int, rows) -> TaylorStep:
    """A made-up step of 1 s on either side of t = 1 s."""
    return TaylorStep(Fraction(1), Fraction(1), Fraction(-1), Fraction(1), bits, rows)


class FailingStep:
    """A step that raises when it has been read so many times: a fault of the driver at any place of a proof."""

    def __init__(self, step: TaylorStep, readings: int) -> None:
        self.step, self.readings = step, readings

    def __getattr__(self, name: str):
        """Hand on what the step has."""
        self.readings -= 1
        if self.readings < 0:
            raise RuntimeError("this step fails")
        return getattr(self.step, name)


def steps(
    inputs: Inputs,
    end: Fraction,
    bits: int = 128,
    order: int = 64,
    first: Fraction = Fraction(1, 4),
):
    """Steps of the recurrence, the last one cut at `end`."""
    for step in pair(Recurrence(SceneBalls(inputs, bits + 64), bits, order).chain(first)):
        last = step.centre + step.h * step.high >= end
        yield step._replace(high=(end - step.centre) / step.h) if last else step
        if last:
            return


def in_digits(step: TaylorStep) -> TaylorStep:
    """The same step, its coefficients as digits over the next power of two that these have."""
    from reference.enclosure.trusted.digits import split  # needs numba

    count = -(-(step.bits + 1) // DIGIT_BITS)
    up, orders = DIGIT_BITS * count - 1 - step.bits, max(map(len, step.coefficients))
    table = np.zeros((4, count, orders), np.int64)
    for i, row in enumerate(step.coefficients):
        for k, c in enumerate(row):
            table[i, :, k] = split(count, int(c) << up)[0]
    # signed digits, as a series has them: the leading ones of a small coefficient are 0
    for q in range(count - 1, 0, -1):
        over = table[:, q] >> (DIGIT_BITS - 1)
        table[:, q] -= over << DIGIT_BITS
        table[:, q - 1] += over
    return step._replace(bits=step.bits + up, rows=Digits(table.astype(np.int32)))


def carry(inputs: Inputs, proposal, columns: bool = False):
    """Every piece with its tube."""
    proposal = list(proposal)
    balls = SceneBalls(inputs, proposal[0].bits + 64)
    bound, source = (Columns(balls), ColumnSource(balls)) if columns else (Radius(balls), None)
    for step in proposal:
        piece = Piece(balls, step)
        more = [source.propose(step, [float(z) for z in bound.z])] if source else []
        yield bound.advance(piece, *more)


def scanned(inputs: Inputs, proposal, columns: bool = False):
    """The transits of a proposal."""
    scan = None
    for covered in carry(inputs, proposal, columns):
        scan = scan or Scan(covered.piece.balls)
        scan.advance(covered)
    return scan.finish()


def last_state(inputs: Inputs, proposal, columns: bool = False):
    *_, last = carry(inputs, proposal, columns)
    return output(last, last.piece.end)
