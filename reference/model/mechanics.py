"""The model, written once: every function takes numbers of any type (mpf, binary64, heyoka expression).

Axes x east, y north, z up, origin at the suspension. Inside a formulation lengths are divided by the
cord length l, so that n = r/l, and times stay in seconds. The force per mass over l is, with the
constants of `constants.Constants` (c = pull, Ω = turn, γ = drag),

    F(n, v) = c - Ω × (Ω × n) - 2 Ω × v - γ v,

and n'' = F - n (v·v + n·F) keeps |n| = 1. An exact zero is the int 0; it drops out of every sum and
product here, so the system of a scene holds only the terms that the scene has.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from .constants import Constants, Vector, is_zero

State = Sequence[Any]


class Functions(Protocol):
    """Elementary functions of a number type: an mpmath context, or the module heyoka."""

    def sqrt(self, x: Any, /) -> Any:
        """Square root."""

    def sin(self, x: Any, /) -> Any:
        """Sine."""

    def cos(self, x: Any, /) -> Any:
        """Cosine."""


def times(*factors: Any) -> Any:
    """The product, or the int 0 if any factor is exactly zero."""
    product, started = 0, False
    for factor in factors:
        if is_zero(factor):
            return 0
        product, started = (product * factor if started else factor), True
    return product


def plus(*terms: Any) -> Any:
    """The sum of the terms that are not exactly zero."""
    total: Any = 0
    for term in terms:
        if not is_zero(term):
            total = term if is_zero(total) else total + term
    return total


def minus(a: Any, b: Any) -> Any:
    """The difference, leaving out what is exactly zero."""
    return a if is_zero(b) else (-b if is_zero(a) else a - b)


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return (
        minus(times(a[1], b[2]), times(a[2], b[1])),
        minus(times(a[2], b[0]), times(a[0], b[2])),
        minus(times(a[0], b[1]), times(a[1], b[0])),
    )


def dot(a: Vector, b: Vector) -> Any:
    """Scalar product."""
    return plus(*(times(p, q) for p, q in zip(a, b, strict=True)))


def scale(k: Any, a: Vector) -> Vector:
    """The vector k a."""
    return (times(k, a[0]), times(k, a[1]), times(k, a[2]))


def add(a: Vector, b: Vector) -> Vector:
    """The vector a + b."""
    return (plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2]))


def subtract(a: Vector, b: Vector) -> Vector:
    """The vector a - b."""
    return (minus(a[0], b[0]), minus(a[1], b[1]), minus(a[2], b[2]))


def force(n: Vector, v: Vector, k: Constants) -> Vector:
    """Force per mass over l, without the cord: c - Ω × (Ω × n) - 2 Ω × v - γ v, in 1/s²."""
    xx, yy, yz, zz = k.centrifugal
    spread = (times(xx, n[0]), plus(times(yy, n[1]), times(yz, n[2])), plus(times(yz, n[1]), times(zz, n[2])))
    bent = scale(2, cross(k.turn, v))
    return subtract(subtract(add(k.pull, spread), bent), scale(k.drag, v))


def tension(n: Vector, v: Vector, k: Constants) -> Any:
    """Pull of the cord per mass over l, v·v + n·F; below zero the rod is pushed and rounding leaves the sphere."""
    return plus(dot(v, v), dot(n, force(n, v, k)))


def acceleration(n: Vector, v: Vector, k: Constants) -> Vector:
    """N'' = F - n (v·v + n·F), in 1/s²."""
    return subtract(force(n, v, k), scale(tension(n, v, k), n))


def invariant(n: Vector, v: Vector, k: Constants) -> Any:
    """H = v²/2 + g z - Ω²/2 (x² + q²) in m²/s², q = R - s y + c z; constant when there is no drag."""
    q = plus(k.axis_distance, times(-1, k.sin, n[1]), times(k.cos, n[2]))
    turning = times(k.rate, k.rate, plus(times(n[0], n[0]), times(q, q)))
    doubled = minus(plus(dot(v, v), times(2, k.gravity, n[2])), turning)
    return times(k.length, k.length, doubled) / 2


class Formulation(Protocol):
    """One way to write the same system as a first-order system, usable for a run."""

    @property
    def name(self) -> str:
        """The word for it on the command line."""

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the state's variables, in order."""

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """State of a bob at n = r/l with velocity v = r'/l."""

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """N and n' of a state."""

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Time derivative of a state, in the order of `variables`."""


class Momentum:
    """H = n × (n' + Ω × n): n' = (H - Ω) × n, H' = n × c + H × Ω - γ n × n'; quadratic, neutral off the sphere."""

    name = "momentum"
    variables = ("nx", "ny", "nz", "Hx", "Hy", "Hz")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """State of a bob at n with velocity v."""
        return (*n, *cross(n, add(v, cross(k.turn, n))))

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """N and (H - Ω) × n."""
        n, momentum = _halves(state)
        return n, cross(subtract(momentum, k.turn), n)

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Lines of the class's docstring."""
        n, momentum = _halves(state)
        _, v = self.cartesian(state, k, functions)
        torque = subtract(add(cross(n, k.pull), cross(momentum, k.turn)), scale(k.drag, cross(n, v)))
        return (*v, *torque)


class Inertial:
    """V = n' + Ω × n: n' = V - Ω × n, V' = c - Ω × V - n (V·V + n·c) - γ n'; off the sphere only while a step lasts."""

    name = "inertial"
    variables = ("nx", "ny", "nz", "Vx", "Vy", "Vz")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """State of a bob at n with velocity v."""
        return (*n, *add(v, cross(k.turn, n)))

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """N and V - Ω × n."""
        n, whole = _halves(state)
        return n, subtract(whole, cross(k.turn, n))

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Lines of the class's docstring."""
        n, whole = _halves(state)
        _, v = self.cartesian(state, k, functions)
        pull = plus(dot(whole, whole), dot(n, k.pull))
        steady = subtract(k.pull, cross(k.turn, whole))
        return (*v, *subtract(subtract(steady, scale(pull, n)), scale(k.drag, v)))


class Space:
    """n'' = F - n (v·v + n·F): polynomial, but rounding leaves the sphere wherever the cord is pushed."""

    name = "space"
    variables = ("nx", "ny", "nz", "vx", "vy", "vz")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """State of a bob at n with velocity v."""
        return (*n, *v)

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """The state itself."""
        return _halves(state)

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """V and the acceleration."""
        n, v = _halves(state)
        return (*v, *acceleration(n, v, k))


class Spin:
    """w = n × v: n' = w × n, w' = n × F; cubic, and like `momentum` neutral off the sphere at every angle."""

    name = "spin"
    variables = ("nx", "ny", "nz", "wx", "wy", "wz")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """State of a bob at n with velocity v."""
        return (*n, *cross(n, v))

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """N and w × n."""
        n, spin = _halves(state)
        return n, cross(spin, n)

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """Lines of the class's docstring."""
        n, v = self.cartesian(state, k, functions)
        return (*v, *cross(n, force(n, v, k)))


class Plane:
    """Mathar (32)-(43) over l: x, y and their rates, z = -sqrt(1 - x² - y²); below the suspension only."""

    name = "plane"
    variables = ("x", "y", "vx", "vy")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """State of a bob below the suspension."""
        if not n[2] < 0:
            raise ValueError("the plane formulation holds below the suspension only")
        return (n[0], n[1], v[0], v[1])

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """The third components from |n| = 1 and n·v = 0."""
        x, y, vx, vy = state
        depth = functions.sqrt(1 - x * x - y * y)
        return (x, y, -depth), (vx, vy, (x * vx + y * vy) / depth)

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """(43), with β of (33)-(35), (39)-(41) divided by |z|³ and the constant terms folded into c."""
        x, y, vx, vy = state
        _, north, up = k.turn
        _, yy, yz, zz = k.centrifugal
        square = 1 - x * x - y * y
        depth = functions.sqrt(square)
        area = x * vy - y * vx
        drive = minus((vx * vx + vy * vy - area * area) / (square * depth), k.pull[2])
        beta_x = plus(
            x * drive,
            times(2, vy, minus(times(y, north), times(depth, up))),
            times(-1, x, plus(times(yy, depth), times(yz, y))),
        )
        beta_y = plus(
            y * drive,
            times(-2, vx, minus(times(y, north), times(depth, up))),
            times(depth, minus(times(y, minus(zz, yy)), k.pull[1])),
            times(yz, square - y * y),
        )
        ax = (x * y * beta_y - (y * y + square) * beta_x) / depth
        ay = (x * y * beta_x - (x * x + square) * beta_y) / depth
        return (vx, vy, minus(ax, times(k.drag, vx)), minus(ay, times(k.drag, vy)))


class Angles:
    """Mathar (24), (26): cord angle φ from straight down, azimuth λ from east to north; singular at the vertical."""

    name = "angles"
    variables = ("phi", "lambda", "phi_rate", "lambda_rate")

    def start(self, n: Vector, v: Vector, k: Constants, functions: Any) -> State:
        """State of a bob off the vertical; `functions` needs atan2 and sqrt."""
        square = n[0] * n[0] + n[1] * n[1]
        if not square > 0:
            raise ValueError("the angles formulation has no azimuth on the vertical")
        aside = functions.sqrt(square)
        return (
            functions.atan2(aside, -n[2]),
            functions.atan2(n[1], n[0]),
            v[2] / aside,
            (n[0] * v[1] - n[1] * v[0]) / square,
        )

    def cartesian(self, state: State, k: Constants, functions: Functions) -> tuple[Vector, Vector]:
        """(7) and (10) over l."""
        phi, azimuth, phi_rate, azimuth_rate = state
        sp, cp = functions.sin(phi), functions.cos(phi)
        sl, cl = functions.sin(azimuth), functions.cos(azimuth)
        v = (phi_rate * cp * cl - azimuth_rate * sp * sl, phi_rate * cp * sl + azimuth_rate * sp * cl, phi_rate * sp)
        return (sp * cl, sp * sl, -cp), v

    def derivatives(self, state: State, k: Constants, functions: Functions) -> State:
        """(24) and (26) solved for the second derivatives; R Ω² and g folded into c."""
        phi, azimuth, phi_rate, azimuth_rate = state
        sp, cp = functions.sin(phi), functions.cos(phi)
        sl, cl = functions.sin(azimuth), functions.cos(azimuth)
        _, north, up = k.turn
        along = minus(times(north, sp, sl), times(up, cp))
        across = plus(times(up, sp), times(north, cp, sl))
        phi_second = plus(
            times(k.pull[1], cp, sl),
            times(k.pull[2], sp),
            times(-2, sp, along, azimuth_rate),
            times(-1, across, along),
            cp * sp * azimuth_rate * azimuth_rate,
            times(-1, k.drag, phi_rate),
        )
        turning = plus(
            -2 * cp * phi_rate * azimuth_rate,
            times(k.pull[1], cl),
            times(-1, along, minus(times(north, cl), 2 * phi_rate)),
        )
        return (phi_rate, azimuth_rate, phi_second, minus(turning / sp, times(k.drag, azimuth_rate)))


class Lagrangian(Angles):
    """The system that `heyoka.lagrangian()` derives from L = K - V, Mathar (16)-(21), in the angles of (7)."""

    name = "lagrangian"

    def lagrangian(self, state: State, k: Constants, functions: Functions) -> Any:
        """L / (m l²) = (α0 + α1 Ω + α2 Ω²)/2 + (g/l) cos φ, with α of (17)-(19)."""
        phi, azimuth, phi_rate, azimuth_rate = state
        sp, cp = functions.sin(phi), functions.cos(phi)
        sl, cl = functions.sin(azimuth), functions.cos(azimuth)
        alpha_0 = phi_rate * phi_rate + sp * sp * azimuth_rate * azimuth_rate
        alpha_1 = plus(
            times(2, k.axis_distance, phi_rate * cp * cl - azimuth_rate * sp * sl),
            times(2, sp * azimuth_rate, plus(times(k.sin, sp), times(k.cos, cp * sl))),
            times(-2, k.cos, phi_rate * cl),
        )
        arm = plus(k.axis_distance, times(-1, k.cos, cp), times(-1, k.sin, sp * sl))
        alpha_2 = plus(times(arm, arm), sp * sp * cl * cl)
        kinetic = plus(alpha_0, times(alpha_1, k.rate), times(alpha_2, k.rate, k.rate)) / 2
        return plus(kinetic, times(k.gravity, cp))


_ALL: tuple[Formulation, ...] = (Momentum(), Inertial(), Space(), Spin(), Plane(), Angles(), Lagrangian())
FORMULATIONS: dict[str, Formulation] = {made.name: made for made in _ALL}


def _halves(state: State) -> tuple[Vector, Vector]:
    return (state[0], state[1], state[2]), (state[3], state[4], state[5])


def rest_position(k: Constants, ctx: Any) -> Vector:
    """Where the bob hangs at rest, n = (0, sin θ, -cos θ): the tangential force vanishes, Mathar (44), (46).

    Args:
        k: constants in the mpmath context `ctx`.
        ctx: the context; θ is exact to its last few bits.

    Raises:
        ValueError: nothing pulls, so that every point is a rest position.
    """
    if is_zero(k.pull[1]) and is_zero(k.centrifugal[2]):
        if is_zero(k.pull[2]) and is_zero(k.centrifugal[3]):
            raise ValueError("without gravity and rotation every point is a rest position")
        return (0, 0, ctx.mpf(-1))

    def tangential(theta: Any) -> Any:
        sin, cos = ctx.sin(theta), ctx.cos(theta)
        pulled = force((0, sin, -cos), (0, 0, 0), k)
        return plus(times(pulled[1], cos), times(pulled[2], sin))

    theta = ctx.findroot(tangential, ctx.atan2(k.pull[1], -k.pull[2]))
    return (0, ctx.sin(theta), -ctx.cos(theta))
