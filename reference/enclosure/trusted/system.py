"""TRUSTED. The system of THEOREM.md, section 1: a scene's constants and release in balls, and in the time of a step.

Lengths are divided by that of the rod. Axes: x east, w along the Earth's axis, m in the meridian; without rotation
x, y, z. An index 0 marks the scene's constants, with which polynomials and K = p × (p' + Ω₀ × p) are formed. In a proof
of a point they are the pendulum's own; in a box of inputs (section 11) Ω and γ are balls that hold those of each
pendulum, while c has one value for all (Lemma 11.1).

| name                   | symbol                                | unit                 |
|------------------------|---------------------------------------|----------------------|
| `length`               | l                                     | m                    |
| `c`                    | c                                     | 1/s²; h² c in a step |
| `omega`, `omega_0`     | Ω, Ω₀                                 | 1/s; h Ω             |
| `drag`, `drag_0`       | γ, γ₀                                 | 1/s; h γ             |
| `r`, `v`               | r(0), r'(0)                           | 1, 1/s               |
| `H`                    | H(0), with Ω₀                         | 1/s                  |
| `w0`, `w`              | w₀, w = h w₀                          | 1/s, 1               |
| `S`                    | S >= |H| at all times                 | 1/s; h S             |
| `lambda_minus`         | λ−                                    | 1/s²; h² λ−          |
| `lambda_plus`          | λ+                                    | 1/s²; h² λ+          |
| `J`                    | J(0)                                  | 1/s²                 |
| `c_size`, `omega_size` | bounds of |c|, |Ω|                    | 1, of a step         |
| `drag_size`            | a bound of γ                          | 1, of a step         |
| `theta`                | ϑ, what the integers miss (section 6) | 1, of a step         |
"""

from fractions import Fraction
from functools import lru_cache
from typing import Any, NamedTuple

from flint import arb, ctx, fmpz

from .balls import Vector, add, ball, cross, demand, dot, fixed, size, times, upper


class SceneBalls:
    """The scene's constants and release as balls at `prec` bits, from its exact inputs alone.

    Exact zeros of the inputs stay exact.
    """

    def __init__(self, inputs: Any, prec: int, audit: Any = None) -> None:
        demand(
            inputs.drag >= 0 and inputs.length > 0,
            "not a pendulum: the theorems take a length > 0 and a drag >= 0",
        )
        self.inputs = inputs
        # what is proved with these balls is proved of this: the inputs, or a box of them
        self.claim: Any = inputs
        self.prec = prec
        self.audit = audit  # takes what compiled code returns for a step
        with ctx.workprec(prec):
            self.length = ball(inputs.length)
            self.drag = ball(inputs.drag)
            self.drag_0 = self.drag
            rate = ball(inputs.rotation_rate)
            self.omega: Vector = [arb(0), arb(0), rate]
            self.omega_0 = self.omega

            sin, cos = ball(inputs.latitude / 180).sin_cos_pi()
            self.tilt = (arb(1), arb(0)) if rate.is_zero() else (sin, cos)
            weight = _weight(inputs, sin, cos)
            self.release = self._release(inputs)
            position, velocity = self.release
            _, _, z = position
            demand(
                not inputs.position or z < 0,
                "a release by x and y must be below the suspension",
            )
            _, north, _ = weight
            _, _, vz = velocity
            self.c = self.turned(times(1 / self.length, weight), 1)
            self.r = self.turned(position, 1)
            self.v = self.turned(velocity, 1)

            self._find_exact_zeros((sin * cos * rate).is_zero())
            # (13.2d): whether the velocity at the release is exactly horizontal, and c exactly vertical
            self.level = _horizontal(inputs, vz)
            self.upright = north.is_zero()
            self._bound_the_motion()

    def _find_exact_zeros(self, vertical_rest: bool) -> None:
        """Find out what exact zeros of the inputs say of xdot (section 8, t = 0 and ẋ = 0 for ever).

        `vertical_rest`: at rest on the vertical the pendulum stays, as gravity is vertical too.
        """
        position, _ = self.release
        x, y, _ = (q.is_zero() for q in position)
        vx, vm, vw = (q.is_zero() for q in self.v)
        at_rest = vx and vm and vw
        _, _, rate = self.omega

        self.slow = vx  # ẋ(0) = 0 exactly
        self.flat = at_rest and x  # ẍ(0) = 0 exactly as well
        in_a_fixed_plane = x and vx and rate.is_zero()
        on_the_vertical = x and y and at_rest and vertical_rest
        self.still = in_a_fixed_plane or on_the_vertical  # ẋ = 0 for ever

    def _bound_the_motion(self) -> None:
        """Take H at the release, the weight w₀, and what the energy bounds for all times (section 4)."""
        self.H = cross(self.r, add(self.v, cross(self.omega_0, self.r)))
        H = cross(self.r, add(self.v, cross(self.omega, self.r)))  # the pendulum's own
        c = size(self.c)
        omega = size(self.omega)

        # any positive number is a valid weight
        rates = (c.sqrt(), omega + size(H), arb(1))
        self.w0 = next(rate.mid() for rate in rates if rate > 0)

        J = dot(H, H) / 2 - dot(self.omega, H) - dot(self.c, self.r)  # (1.1)
        self.lambda_minus = upper(self.w0**2 + omega**2 / 2 + J)  # (4.5)
        self.lambda_plus = upper(c - self.w0**2)  # (4.6)
        self.S = upper(omega + upper(omega**2 + 2 * (J + c)).sqrt())  # (4.7)

    def turned(self, a: Vector, way: int) -> Vector:
        """Turn east, north, up to the axes x, m, w; with `way` -1 back."""
        sin, cos = self.tilt
        return [a[0], a[1] * sin - way * a[2] * cos, a[2] * sin + way * a[1] * cos]

    def _release(self, inputs: Any) -> tuple[Vector, Vector]:
        """Return position and velocity at the release over the length, east, north, up."""
        if inputs.position:
            x, y, vx, vy = (ball(q) / self.length for q in inputs.position)
            z = -(1 - x * x - y * y).sqrt()
            return [x, y, z], [vx, vy, -(x * vx + y * vy) / z]

        # of the angles in half turns
        angle, azimuth, angle_rate, azimuth_rate = (ball(q / 180) for q in inputs.angles)
        sin, cos = angle.sin_cos_pi()
        sin_az, cos_az = azimuth.sin_cos_pi()
        angle_rate = arb.pi() * angle_rate
        azimuth_rate = arb.pi() * azimuth_rate
        position = [sin * cos_az, sin * sin_az, -cos]
        velocity = [
            cos * cos_az * angle_rate - sin * sin_az * azimuth_rate,
            cos * sin_az * angle_rate + sin * cos_az * azimuth_rate,
            sin * angle_rate,
        ]
        return position, velocity


def _weight(inputs: Any, sin: arb, cos: arb) -> Vector:
    """Return the pull at the pivot in m/s², east, north, up, from sine and cosine of the latitude."""
    centrifugal = arb(0)  # which effective gravity contains
    if inputs.gravity_is != "effective":
        f = ball(inputs.flattening)
        normal = ball(inputs.equatorial_radius) / (1 - f * (2 - f) * sin * sin).sqrt()
        rate = ball(inputs.rotation_rate)
        centrifugal = rate * rate * (normal + ball(inputs.altitude)) * cos
    return [arb(0), -sin * centrifugal, cos * centrifugal - ball(inputs.gravity)]


def _horizontal(inputs: Any, vz: arb) -> bool:
    """Return whether the velocity at the release is exactly horizontal; `vz` is a ball of its vertical component."""
    if inputs.position and all(isinstance(q, Fraction) for q in inputs.position):
        x, y, vx, vy = inputs.position
        # (13.2d), of exact inputs: r·v = 0 leaves z vz = -(x vx + y vy), and z < 0 is demanded
        return bool(x * vx + y * vy == 0)
    return vz.is_zero()


class Integers(NamedTuple):
    """Integers over 2^bits near the scene's constants in the time of a step: ω, ω², γ, c_m, c_w (section 6)."""

    omega: fmpz
    omega_squared: fmpz
    drag: fmpz
    c_m: fmpz
    c_w: fmpz


class Scaled:
    """The constants in the time of a step: balls, the integers over 2^bits that stand for them, and sizes."""

    def __init__(self, balls: SceneBalls, h: Fraction, bits: int) -> None:
        with ctx.workprec(balls.prec):
            self.h = ball(h)
            self.w = balls.w0 * self.h
            self.c = times(self.h**2, balls.c)
            self.omega_0 = times(self.h, balls.omega_0)
            self.drag_0 = self.h * balls.drag_0
            self.omega = times(self.h, balls.omega)
            self.drag = self.h * balls.drag

            # (6.1): ω² has an integer of its own, not the square of that of ω
            _, c_m, c_w = self.c
            _, _, rate = self.omega_0
            integers, self.theta = fixed([rate, rate**2, self.drag_0, c_m, c_w], bits)
            self.integers = Integers(*integers)

            self.c_size = size(self.c)
            self.omega_size = size(self.omega)
            self.drag_size = upper(self.drag)
            self.S = balls.S * self.h
            self.lambda_minus = balls.lambda_minus * self.h**2
            self.lambda_plus = balls.lambda_plus * self.h**2


scaled = lru_cache(maxsize=16)(Scaled)  # steps of the same length follow each other
