"""The constants of the equations, and the release (position and velocity), from a scene's exact inputs.

Constants are combined here in high precision and rounded once: a run that added gravity and the centrifugal force in
double would carry that rounding error to its end. A constant that is zero by the exact inputs (at a pole, on the
equator, without rotation, without drag) is the int 0, and its terms drop out of the equations (`algebra`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from ..precision import to_mpf
from ..scene import Inputs
from .earth import axis_distance

Vector = tuple[Any, Any, Any]


@dataclass(frozen=True)
class Constants:
    """The constants of the equations of motion; all are numbers of one type, or the int 0.

    Attributes:
        length: cord length l in m.
        turn: rotation vector Ω in rad/s on the axes east, north, up.
        pull: gravity plus centrifugal force at the pivot, over l, in 1/s².
        centrifugal: Ω², Ωz², -Ωy Ωz, Ωy², the entries xx, yy, yz, zz of |Ω|² - Ω Ωᵀ, in 1/s².
        drag: γ in 1/s.
        gravity: g/l in 1/s².
        axis_distance: R/l.
        rate: |Ω| with its sign, in rad/s.
        sin: sine of the geodetic latitude.
        cos: cosine of the geodetic latitude.
    """

    length: Any
    turn: Vector
    pull: Vector
    centrifugal: tuple[Any, Any, Any, Any]
    drag: Any
    gravity: Any
    axis_distance: Any
    rate: Any
    sin: Any
    cos: Any

    def converted(self, convert: Callable[[Any], Any]) -> Constants:
        """Return the same constants in another number type; exact zeros stay the int 0."""

        def one(value: Any) -> Any:
            return value if is_zero(value) else convert(value)

        entries = {
            name: tuple(map(one, value)) if isinstance(value, tuple) else one(value)
            for name, value in vars(self).items()
        }
        return replace(self, **entries)


def is_zero(value: Any) -> bool:
    """Return whether a value is the int 0, which stands for an exact zero."""
    return isinstance(value, int) and value == 0


def constants(inputs: Inputs, ctx: Any) -> Constants:
    """Return the constants of a scene, in the precision of `ctx`: a run's own and `precision.GUARD_BITS` more."""

    def number(value: Any) -> Any:
        return 0 if value == 0 else value

    sin = number(ctx.sinpi(to_mpf(inputs.latitude / 180, ctx)))
    cos = number(ctx.cospi(to_mpf(inputs.latitude / 180, ctx)))
    length, gravity = to_mpf(inputs.length, ctx), to_mpf(inputs.gravity, ctx)
    rate = to_mpf(inputs.rotation_rate, ctx)
    radius, flattening, altitude = (
        to_mpf(v, ctx) for v in (inputs.equatorial_radius, inputs.flattening, inputs.altitude)
    )
    distance = axis_distance(radius, flattening, altitude, sin, cos, ctx.sqrt)
    north, up = rate * cos, rate * sin
    outward = rate * rate * distance
    return Constants(
        length=length,
        turn=(0, number(north), number(up)),
        pull=(0, number(-outward * sin / length), number((outward * cos - gravity) / length)),
        centrifugal=(number(rate * rate), number(up * up), number(-north * up), number(north * north)),
        drag=number(to_mpf(inputs.drag, ctx)),
        gravity=number(gravity / length),
        axis_distance=number(distance / length),
        rate=number(rate),
        sin=sin,
        cos=cos,
    )


def release(inputs: Inputs, ctx: Any) -> tuple[Vector, Vector]:
    """Return position in m and velocity in m/s at t = 0: Mathar (7), (10), or x, y, vx, vy completed to the sphere."""
    length = to_mpf(inputs.length, ctx)
    if inputs.position is not None:
        x, y, vx, vy = (to_mpf(value, ctx) for value in inputs.position)
        z = -ctx.sqrt(length * length - x * x - y * y)
        return (x, y, z), (vx, vy, -(x * vx + y * vy) / z)
    assert inputs.angles is not None
    angle, azimuth = (to_mpf(value / 180, ctx) for value in inputs.angles[:2])
    angle_rate, azimuth_rate = (to_mpf(value, ctx) * ctx.pi / 180 for value in inputs.angles[2:])
    sa, ca, sl, cl = ctx.sinpi(angle), ctx.cospi(angle), ctx.sinpi(azimuth), ctx.cospi(azimuth)
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
