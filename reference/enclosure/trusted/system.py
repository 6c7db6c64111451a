"""TRUSTED. The system of THEOREM.md, section 1: the scene's constants and release in balls, and in the time of a step.

Time on a step is s = (t - centre)/h; h Ω, h² c, h γ, h H are written Ω, c, γ, H. A name of a size is an upper bound.
"""

from fractions import Fraction
from functools import lru_cache
from typing import Any

from flint import arb, ctx

from .balls import Vector, add, ball, cross, demand, dot, fixed, size, times, upper


class SceneBalls:
    """The scene's constants and release as balls at `prec` bits, from its exact inputs alone; exact zeros stay exact.

    Axes: x east, w along the Earth's axis, m in the meridian; without rotation x, y, z. `omega` is the scene's Ω, with
    which K = p × (p' + Ω × p) is formed; `turning` is that of the pendulum itself: the same, but in a box of inputs.
    """

    def __init__(self, inputs: Any, prec: int, flint_only: bool = False) -> None:
        demand(
            inputs.drag >= 0 and inputs.length > 0,
            "not a pendulum: the theorems take a length > 0 and a drag >= 0",
        )
        # the last: without sums of digits
        self.inputs, self.prec, self.flint_only = inputs, prec, flint_only
        with ctx.workprec(prec):
            (sin, cos), rate = ball(inputs.latitude / 180).sin_cos_pi(), ball(inputs.rotation_rate)
            f, self.length, self.drag = (
                ball(inputs.flattening),
                ball(inputs.length),
                ball(inputs.drag),
            )
            normal = ball(inputs.equatorial_radius) / (1 - f * (2 - f) * sin * sin).sqrt()
            # the centrifugal force at the pivot, which effective gravity contains
            push = (
                arb(0)
                if inputs.gravity_is == "effective"
                else rate * rate * (normal + ball(inputs.altitude)) * cos
            )
            self.tilt = (arb(1), arb(0)) if rate.is_zero() else (sin, cos)
            self.omega = [arb(0), arb(0), rate]
            self.turning = self.omega
            weight = [arb(0), -sin * push, cos * push - ball(inputs.gravity)]
            self.release = self._release(inputs)
            self.c, self.r, v = (
                self.turned(a, 1) for a in (times(1 / self.length, weight), *self.release)
            )
            (x, y, vx), at_rest = (
                (q.is_zero() for q in (*self.release[0][:2], v[0])),
                all(q.is_zero() for q in v),
            )
            self.slow, self.flat = vx, at_rest and x  # xdot(0) = 0 exactly; and xddot(0) = 0
            # xdot = 0 for ever: in a plane that does not turn, or at rest on the vertical
            self.still = x and (
                (vx and rate.is_zero()) or (at_rest and y and (sin * cos * rate).is_zero())
            )
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
        # -+ (c·r - w0²)
        self.below, self.above = upper(self.w0**2 + w**2 / 2 + energy), upper(c - self.w0**2)

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
        (s, c), (sa, ca), (da, db) = (
            angle.sin_cos_pi(),
            azimuth.sin_cos_pi(),
            times(arb.pi(), rates),
        )
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
            self.c, self.omega, self.drag = (
                times(self.h**2, balls.c),
                times(self.h, balls.omega),
                self.h * balls.drag,
            )
            self.whole, self.off = fixed(
                [self.omega[2], self.omega[2] ** 2, self.drag, *self.c[1:]], bits
            )
            self.c_size, self.omega_size, self.drag_size = (
                size(self.c),
                size(self.omega),
                upper(self.drag),
            )
            self.speed, self.below, self.above = (
                balls.speed * self.h,
                balls.below * self.h**2,
                balls.above * self.h**2,
            )


scaled = lru_cache(maxsize=16)(Scaled)  # steps of the same length follow each other
