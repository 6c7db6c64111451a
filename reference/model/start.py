"""The start of a run: a scene's constants, and position and velocity at the release, in one precision.

Where xdot is exactly zero, at all times or at the release only, the inputs alone tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Self

from ..errors import UnreachableError
from ..numbers.precision import context, to_mpf
from ..scenes.inputs import Inputs
from .algebra import cross
from .constants import Constants, Vector, constants
from .force import force, rest_position

if TYPE_CHECKING:
    from .formulations import Formulation


@dataclass(frozen=True)
class Start:
    """A scene's constants and release, as mpf of one precision.

    Attributes:
        ctx: the mpmath context of all numbers here.
        k: constants of the equations of motion.
        position: x, y, z in m at t = 0.
        velocity: vx, vy, vz in m/s at t = 0.
    """

    ctx: Any
    k: Constants
    position: Vector
    velocity: Vector

    @classmethod
    def of(cls, inputs: Inputs, prec: int) -> Self:
        """Return the start of a scene from its exact inputs, computed in `prec` bits.

        A run takes `precision.GUARD_BITS` more than its own precision, and rounds each number once.
        """
        ctx = context(prec)
        return cls(ctx, constants(inputs, ctx), *release(inputs, ctx))

    @cached_property
    def n(self) -> Vector:
        """Position over l: a unit vector."""
        return scaled(self.position, self.k.length)

    @cached_property
    def v(self) -> Vector:
        """Velocity over l, in 1/s."""
        return scaled(self.velocity, self.k.length)

    @cached_property
    def rate(self) -> float:
        """Rate of a small swing, or of its decay if that is faster, in 1/s."""
        return max(float(self.ctx.sqrt(self.ctx.norm(self.k.pull))), float(self.k.drag))

    @cached_property
    def fastest_rate(self) -> float:
        """Sum of the rates of swing, release, rotation and drag, in 1/s."""
        ctx = self.ctx
        k = self.k
        return float(ctx.sqrt(ctx.norm(k.pull)) + ctx.norm(self.v) + abs(k.rate) + k.drag)

    @cached_property
    def rest(self) -> Vector:
        """Rest position over l, n = (0, sin θ, -cos θ), Mathar (46).

        Raises:
            UnreachableError: there is none, or the iteration does not converge.
        """
        try:
            return rest_position(self.k, self.ctx)
        except (ValueError, ZeroDivisionError):
            raise UnreachableError(
                "there is no single rest position for the bob to swing about."
            ) from None

    @cached_property
    def lean(self) -> Any:
        """Sine of the angle between the rest position and the plumb line at the pivot.

        Raises as `rest` does.
        """
        return self.ctx.norm(cross(self.rest, self.k.pull)) / self.ctx.norm(self.k.pull)

    def state(self, formulation: Formulation) -> Sequence[Any]:
        """Return the state at t = 0 in a formulation's variables; ValueError where it cannot express the release."""
        return formulation.start(self.n, self.v, self.k, self.ctx)


def release(inputs: Inputs, ctx: Any) -> tuple[Vector, Vector]:
    """Return position in m and velocity in m/s at t = 0: Mathar (7), (10), or x, y, vx, vy completed to the sphere."""
    length = to_mpf(inputs.length, ctx)
    if inputs.position is not None:
        x, y, vx, vy = (to_mpf(value, ctx) for value in inputs.position)
        z = -ctx.sqrt(
            to_mpf(inputs.length**2 - inputs.position[0] ** 2 - inputs.position[1] ** 2, ctx)
        )
        return (x, y, z), (vx, vy, -(x * vx + y * vy) / z)
    assert inputs.angles is not None
    angle, azimuth, angle_rate, azimuth_rate = inputs.angles
    return at_angles(length, _angle(angle, angle_rate, ctx), _angle(azimuth, azimuth_rate, ctx))


class Angle(NamedTuple):
    """Sine, cosine and rate (1/s) of an angle, in any number type."""

    sin: Any
    cos: Any
    rate: Any


def _angle(degrees: Fraction, degrees_per_s: Fraction, ctx: Any) -> Angle:
    half_turns = to_mpf(degrees / 180, ctx)
    rate = to_mpf(degrees_per_s, ctx) * ctx.pi / 180
    return Angle(ctx.sinpi(half_turns), ctx.cospi(half_turns), rate)


def at_angles(length: Any, angle: Angle, azimuth: Angle) -> tuple[Vector, Vector]:
    """Return position and velocity at an angle from the plumb line and an azimuth, in any number type."""
    sa, ca, angle_rate = angle
    sl, cl, azimuth_rate = azimuth
    position = (length * sa * cl, length * sa * sl, -length * ca)
    velocity = (
        length * (angle_rate * ca * cl - azimuth_rate * sa * sl),
        length * (angle_rate * ca * sl + azimuth_rate * sa * cl),
        length * angle_rate * sa,
    )
    return position, velocity


def scaled(vector: Vector, length: Any) -> Vector:
    """Return a position or velocity divided by the cord length."""
    return (vector[0] / length, vector[1] / length, vector[2] / length)


def xdot_vanishes(start: Start) -> bool:
    """Return whether xdot is zero at all times, decided from exact zeros only (lemma in enclosure/THEOREM.md).

    It is where the bob is released at rest and the force has no component along the sphere
    (straight up or down at a pole or on the equator, or no force at all), and without rotation also
    where it is released in the plane x = 0 with vx = 0.
    """
    n = start.n
    v = start.v
    if not any(v) and not any(cross(n, force(n, (0, 0, 0), start.k))):
        return True
    return not start.k.rate and n[0] == 0 and v[0] == 0


def zero_at_release(start: Start) -> int:
    """Return the multiplicity of xdot's zero at t = 0 by the exact inputs, 0 to 4.

    It is 1 where the bob is released with vx = 0, and more where the force has no x component
    either: 2 in the meridian at rest, or along the Earth's axis; 4 in the meridian at rest with the
    cord at right angles to the axis, as the bob then starts along it. Released at rest with a
    horizontal cord, to the east or at a pole, the bob falls straight down, and x shrinks like t⁴.
    """
    n = start.n
    v = start.v
    turn = start.k.turn
    at_pole = turn[1] == 0 and start.k.pull[1] == 0
    if v[0] != 0:
        return 0
    if any(v):
        return 2 if n[0] == 0 and _cancel(start, turn[1] * v[2], -turn[2] * v[1]) else 1
    if n[0] == 0:
        return 4 if _cancel(start, turn[1] * n[1], turn[2] * n[2]) else 2
    return 3 if n[2] == 0 and (at_pole or n[1] == 0) else 1


def _cancel(start: Start, a: Any, b: Any) -> bool:
    """Return whether two numbers of a start have no sum but their rounding."""
    return bool(abs(a + b) * 2 ** (start.ctx.prec - 8) <= abs(a) + abs(b))
