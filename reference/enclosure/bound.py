"""TRUSTED. The error bound of a step: scene in balls, defect, how the radius grows: Theorem C (THEOREM.md, 1 to 7).

Time on a step is s = (t - centre)/h; h Ω, h² c, h γ, h H are written Ω, c, γ, H. A name of a size is an upper bound.
"""

from fractions import Fraction
from functools import cached_property, lru_cache, reduce
from typing import Any

import numpy as np
from flint import arb, ctx, fmpz, fmpz_poly

from ..numbers.taylor_step import DIGIT_BITS, Digits, TaylorStep
from .balls import SHORT, Vector, add, ball, cross, demand, dot, fixed, interval, size, times, total, upper
from .shapes import Covered, Sizes, State, Tube


class SceneBalls:
    """The scene's constants and release as balls at `prec` bits, from its exact inputs alone; exact zeros stay exact.

    Axes: x east, w along the Earth's axis, m in the meridian; without rotation x, y, z. `omega` is the scene's Ω, with
    which K = p × (p' + Ω × p) is formed; `turning` is that of the pendulum itself: the same, but in a box of inputs.
    """

    def __init__(self, inputs: Any, prec: int, flint_only: bool = False) -> None:
        demand(inputs.drag >= 0 and inputs.length > 0, "not a pendulum: the theorems take a length > 0 and a drag >= 0")
        self.inputs, self.prec, self.flint_only = inputs, prec, flint_only  # the last: without sums of digits
        with ctx.workprec(prec):
            (sin, cos), rate = ball(inputs.latitude / 180).sin_cos_pi(), ball(inputs.rotation_rate)
            f, self.length, self.drag = ball(inputs.flattening), ball(inputs.length), ball(inputs.drag)
            normal = ball(inputs.equatorial_radius) / (1 - f * (2 - f) * sin * sin).sqrt()
            # the centrifugal force at the pivot, which effective gravity contains
            push = arb(0) if inputs.gravity_is == "effective" else rate * rate * (normal + ball(inputs.altitude)) * cos
            self.tilt = (arb(1), arb(0)) if rate.is_zero() else (sin, cos)
            self.omega = [arb(0), arb(0), rate]
            self.turning = self.omega
            weight = [arb(0), -sin * push, cos * push - ball(inputs.gravity)]
            self.release = self._release(inputs)
            self.c, self.r, v = (self.turned(a, 1) for a in (times(1 / self.length, weight), *self.release))
            (x, y, vx), at_rest = (q.is_zero() for q in (*self.release[0][:2], v[0])), all(q.is_zero() for q in v)
            self.slow, self.flat = vx, at_rest and x  # xdot(0) = 0 exactly; and xddot(0) = 0
            # xdot = 0 for ever: in a plane that does not turn, or at rest on the vertical
            self.still = x and ((vx and rate.is_zero()) or (at_rest and y and (sin * cos * rate).is_zero()))
            # whether the velocity at the release is exactly horizontal, and c exactly vertical (Lemma 13.2)
            self.level = horizontal(inputs, self.release[1][2])
            self.upright = weight[1].is_zero()
            self.begin(v)

    def begin(self, v: Vector) -> None:
        """Take the velocity at the release: H there, the weight, and what bounds the motion for all times."""
        self.H = cross(self.r, add(v, cross(self.turning, self.r)))
        c, w = size(self.c), size(self.turning)
        # any positive number is a valid weight
        self.w0 = next(pace.mid() for pace in (c.sqrt(), w + size(self.H), arb(1)) if pace > 0)
        energy = dot(self.H, self.H) / 2 - dot(self.turning, self.H) - dot(self.c, self.r)
        self.speed = upper(w + upper(w**2 + 2 * (energy + c)).sqrt())  # |H| at any time
        self.below, self.above = upper(self.w0**2 + w**2 / 2 + energy), upper(c - self.w0**2)  # -+ (c·r - w0²)

    def turned(self, a: Vector, way: int) -> Vector:
        """Turn east, north, up to the axes x, m, w; with `way` -1 back."""
        sin, cos = self.tilt
        return [a[0], a[1] * sin - way * a[2] * cos, a[2] * sin + way * a[1] * cos]

    def _release(self, inputs: Any) -> tuple[Vector, Vector]:
        if inputs.position:
            x, y, vx, vy = (ball(q) / self.length for q in inputs.position)
            z = -(1 - x * x - y * y).sqrt()
            return [x, y, z], [vx, vy, -(x * vx + y * vy) / z]
        angle, azimuth, *rates = (ball(q / 180) for q in inputs.angles)
        (s, c), (sa, ca), (da, db) = angle.sin_cos_pi(), azimuth.sin_cos_pi(), times(arb.pi(), rates)
        return [s * ca, s * sa, -c], [c * ca * da - s * sa * db, c * sa * da + s * ca * db, s * da]


def horizontal(inputs: Any, vz: arb) -> bool:
    """Return whether the velocity at the release is exactly horizontal; `vz` is a ball of its vertical component."""
    if inputs.position and all(isinstance(q, Fraction) for q in inputs.position):
        x, y, vx, vy = inputs.position
        # of exact inputs: r·v = 0 leaves z vz = -(x vx + y vy)
        return bool(x * vx + y * vy == 0)
    return vz.is_zero()


class Scaled:
    """Constants in the time of a step: balls, integers over 2^bits that are off by at most `off` in all, and sizes."""

    def __init__(self, balls: SceneBalls, h: Fraction, bits: int) -> None:
        with ctx.workprec(balls.prec):
            self.h, self.w = ball(h), balls.w0 * ball(h)
            self.c, self.omega, self.drag = times(self.h**2, balls.c), times(self.h, balls.omega), self.h * balls.drag
            self.whole, self.off = fixed([self.omega[2], self.omega[2] ** 2, self.drag, *self.c[1:]], bits)
            self.c_size, self.omega_size, self.drag_size = size(self.c), size(self.omega), upper(self.drag)
            self.speed, self.below, self.above = balls.speed * self.h, balls.below * self.h**2, balls.above * self.h**2


scaled = lru_cache(maxsize=16)(Scaled)  # steps of the same length follow each other


def frozen(step: TaylorStep) -> TaylorStep:
    """Return a copy of a step, whose coefficients are read once."""
    rows: Any = step.coefficients
    if isinstance(rows, Digits):
        rows = Digits(np.array(rows.table, np.int32))
        rows.table.setflags(write=False)
    else:
        rows = tuple(fmpz_poly(row) for row in rows)
    centre, h, low, high = (Fraction(x) for x in (step.centre, step.h, step.low, step.high))
    return TaylorStep(centre, h, low, high, int(step.bits), rows, step.columns)


class Piece:
    """A step with its polynomials p, p' and λ, used from `begin` to `end` (in s).

    Its `step` is a copy: all that rests on this step rests on the same numbers, whatever its source does afterwards.
    """

    def __init__(self, balls: SceneBalls, step: TaylorStep) -> None:
        step = frozen(step)
        demand(-1 <= step.low < step.high <= 1 and step.h > 0, "a step must lie in -1 <= s <= 1, where its sizes hold")
        rows: Any = step.rows
        if isinstance(rows, Digits):
            demand(step.bits == DIGIT_BITS * rows.table.shape[1] - 1, "coefficients have 22 bits a digit, but one")
        self.balls, self.step, self.k = balls, step, scaled(balls, step.h, step.bits)
        self.unit, self.rows, self.p = fmpz(1) << step.bits, rows, polynomials(rows, slice(3))
        self.v = [f.derivative() for f in self.p]
        self.begin, self.end = step.centre + step.h * step.low, step.centre + step.h * step.high

    def values(self, s: arb, first: int = 0) -> tuple[Vector, Vector]:
        """Return balls of p(s) and p'(s), of this from a component on."""
        return [f(s) / self.unit for f in self.p], [f(s) / self.unit for f in self.v[first:]]

    @cached_property
    def sizes(self) -> Sizes:
        """The defects and norms, from integers but for the radii of the constants (section 6)."""
        k = self.k
        with ctx.workprec(SHORT):
            *d, t, x, m, w, t1 = self.norms = self.defects()
            v1, size_p, n = size([x, m, w]), upper((1 + t).sqrt()), max(2, *map(len, self.p)) - 1
            defect = size_p * (size(d) + k.off * (2 * v1 + size_p)) + k.drag_size * k.omega_size * t
            speed, rate = v1 + k.omega_size * size_p, (n - 1 + k.omega_size) * v1
            first, second = t * speed + t1 * size_p / 2, t1 * speed + t * rate + (2 * n - 1) * t1 * size_p / 2
            return Sizes(*map(upper, (first, defect, size_p, size_p * speed, t, second)))

    def defects(self) -> list[arb]:
        """Return the norms of d (three components), τ, p' (three), τ': by sums of digits, or by FLINT's polynomials."""
        if isinstance(self.rows, Digits) and not self.balls.flint_only:
            from .digits import norms

            return norms(self.rows.table, self.k.whole)
        return [total(f, 2 * self.step.bits) for f in self.measured()]

    def measured(self) -> list[fmpz_poly]:
        """Return d (three components), τ, p' (three components), τ' over 2^(2 bits)."""
        k, p, v, unit = self.k, self.p, self.v, self.unit
        (tension,) = polynomials(self.rows, slice(3, 4))
        (turn, _, drag, cm, cw), a, lift = k.whole, [f.derivative() for f in v], tension - k.whole[1]
        d = [unit * x + f * y for x, f, y in zip(a, (lift, lift, tension), p, strict=True)]
        d = add(d, [-2 * turn * v[1], 2 * turn * v[0] - unit * cm, fmpz_poly([-unit * cw])])
        tau = dot(p, p) - unit * unit
        return [*add(d, times(drag, v)), tau, *times(unit, v), tau.derivative()]


def polynomials(rows: Any, part: slice) -> list[fmpz_poly]:
    """Return a part of the rows of coefficients as polynomials."""
    if not isinstance(rows, Digits):
        return [fmpz_poly(row) for row in rows[part]]
    table, odd, unit = rows.table[part].astype(np.int64), rows.table.shape[1] % 2, fmpz(1) << 2 * DIGIT_BITS
    pairs = np.concatenate([table[:, :odd], (table[:, odd::2] << DIGIT_BITS) + table[:, odd + 1 :: 2]], 1).tolist()
    return [reduce(lambda f, pair: f * unit + fmpz_poly(pair), row, fmpz_poly()) for row in pairs]


def error_rate(k: Scaled, size_p: arb) -> arb:
    """Return the rate ν of Theorem N."""
    return (k.c_size + k.w**2 + k.drag_size * k.omega_size * (1 + size_p)) / (2 * k.w)


def tube(k: Scaled, d: Sizes, eta: arb, gamma: arb) -> Tube:
    """Return the bounds of position, velocity and acceleration from |e| <= eta and |g| <= gamma (section 7)."""
    demand(eta < 2, "a bound is as wide as the sphere")
    turn, gw = d.k + k.omega_size, k.drag_size * k.omega_size
    u = gamma + turn * eta + d.d1
    torque = k.c_size * eta + k.omega_size * gamma + k.drag_size * gamma + gw * (1 + d.p) * eta + d.d2
    rate = d.p * k.c_size + d.k * k.omega_size + k.drag_size * d.k + gw * (1 + d.p**2) + d.d2
    a = torque + rate * eta + gamma * (turn * d.p + d.d1 + u) + turn * u + d.d1_rate
    return Tube(upper(eta), upper(u), upper(a))


class Carried:
    """State carried from step to step: the time reached, and p and K there (K in 1/s); at t = 0 balls of r and H."""

    def __init__(self, balls: SceneBalls) -> None:
        self.balls, self.time, self.last = balls, Fraction(0), [*balls.r, *balls.H]

    def join(self, piece: Piece) -> Vector:
        """Return bounds of the jumps in p and K from the end of the step before to the start of `piece`."""
        demand(piece.begin == self.time and piece.balls is self.balls, "steps must join, and be of one scene")
        with ctx.workprec(self.balls.prec):
            ends = (piece.values(ball(s)) for s in (piece.step.low, piece.step.high))
            start, end = ([*p, *times(1 / piece.k.h, cross(p, add(v, cross(piece.k.omega, p))))] for p, v in ends)
            self.time, self.last, before = piece.end, end, self.last
            return [(a - b).abs_upper() for a, b in zip(start, before, strict=True)]


class Radius(Carried):
    """Theorem C: one radius, |e|² + |g⊥|²/w² <= eta²."""

    eta = arb(0)

    def advance(self, piece: Piece) -> Covered:
        """Carry the radius over a piece."""
        k, jump, d = piece.k, self.join(piece), piece.sizes
        with ctx.workprec(SHORT):
            span, gw, ck = ball(piece.step.high - piece.step.low), k.drag_size * k.omega_size, k.c_size + d.k**2
            start, source = upper(self.eta + size(jump[:3]) + size(jump[3:]) / self.balls.w0), d.d2 / k.w + d.d1
            # Theorem N: |e| <= far
            far = upper(((1 + d.k / k.w) * start + span * source) * (span * error_rate(k, d.p)).exp())
            rate = (k.below.max(k.above + (k.speed + k.w * far) ** 2) + ck * far + gw * d.p) / (2 * k.w)
            self.eta = upper((start + span * (ck * d.tau / (2 * k.w) + source)) * (span * rate).exp())
            return Covered(piece, tube(k, d, self.eta, (k.w + d.k) * self.eta))


def state(covered: Covered, s: arb, first: int = 0) -> tuple[Vector, Vector]:
    """Return balls that contain the true r and r' at `s`, of this from a component on."""
    (p, v), (eta, u, _) = covered.piece.values(s, first), covered.tube
    return [x + arb(0, eta) for x in p], [x + arb(0, u) for x in v]


def output(covered: Covered, time: Fraction) -> State:
    """Return position and velocity at an output time, in m and m/s; at 0 those of the release itself."""
    piece, balls = covered.piece, covered.piece.balls
    with ctx.workprec(balls.prec):
        demand(piece.begin <= time <= piece.end, "the tube holds on its own step only")
        r, v = state(covered, ball((time - piece.step.centre) / piece.step.h))
        moving = [balls.turned(r, -1), balls.turned(times(1 / piece.k.h, v), -1)]
        return tuple(interval(x * balls.length) for part in (moving if time else balls.release) for x in part)
