"""The constants of the equations of motion. A measured ("effective") g holds the centrifugal force: then R = 0 here.

Constants are combined here in high precision and rounded once: a run that added gravity and the
centrifugal force in double would carry that rounding error to its end. A constant that is zero by
the exact inputs (at a pole, on the equator, without rotation, without drag) is the int 0, and its
terms drop out of the equations (`algebra`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any, Self

from ..errors import BeyondDoublesError
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS, context, to_mpf
from ..scenes.inputs import Inputs

Vector = tuple[Any, Any, Any]


def axis_distance(
    equatorial_radius: Any, flattening: Any, altitude: Any, sin: Any, cos: Any, sqrt: Any
) -> Any:
    """Return the distance R = (N + h) cos(latitude) of the suspension from the axis, in m: Mathar (2), (3).

    Args:
        equatorial_radius: semi-major axis in m.
        flattening: f, 0 for a sphere; the squared eccentricity is f (2 - f).
        altitude: h above the ellipsoid in m.
        sin: sine of the geodetic latitude.
        cos: cosine of the geodetic latitude.
        sqrt: square root of the number type of the other arguments.
    """
    normal = equatorial_radius / sqrt(1 - flattening * (2 - flattening) * sin * sin)
    return (normal + altitude) * cos


@dataclass(frozen=True, kw_only=True)
class Constants:
    """The constants of the equations of motion; all are numbers of one type, or the int 0, as those not given.

    Attributes:
        length: cord length l in m.
        turn: rotation vector Ω in rad/s on the axes east, north, up.
        pull: gravity plus centrifugal force at the pivot, over l, in 1/s²; effective gravity is
            both together.
        centrifugal: Ω², Ωz², -Ωy Ωz, Ωy², the entries xx, yy, yz, zz of |Ω|² I - Ω Ωᵀ, in 1/s².
        drag: γ in 1/s.
        gravity: g/l in 1/s².
        axis_distance: R/l; 0 where gravity is effective.
        rate: Ω, positive where the Earth turns eastward, in rad/s.
        sin: sine of the geodetic latitude.
        cos: cosine of the geodetic latitude.
    """

    length: Any = 1
    turn: Vector = (0, 0, 0)
    pull: Vector = (0, 0, 0)
    centrifugal: tuple[Any, Any, Any, Any] = (0, 0, 0, 0)
    drag: Any = 0
    gravity: Any = 0
    axis_distance: Any = 0
    rate: Any = 0
    sin: Any = 0
    cos: Any = 0

    @classmethod
    def of(cls, entries: Mapping[str, Any]) -> Self:
        """Return the constants that have these `entries`, in any number type.

        Those not named are exactly zero.
        """

        def value(name: str, default: Any) -> Any:
            if isinstance(default, tuple):
                return tuple(entries.get(f"{name}_{i}", 0) for i in range(len(default)))
            return entries.get(name, default)

        return cls(**{field.name: value(field.name, field.default) for field in fields(cls)})

    def entries(self, *names: str) -> dict[str, Any]:
        """Return all numbers here that are not exactly zero, or those of some constants: "drag", "turn_1", "turn_2"."""
        numbers: dict[str, Any] = {}
        for name in names or vars(self):
            value = getattr(self, name)
            if isinstance(value, tuple):
                numbers |= {f"{name}_{i}": part for i, part in enumerate(value)}
            else:
                numbers[name] = value
        return {name: value for name, value in numbers.items() if not is_zero(value)}

    def converted(self, convert: Callable[[Any], Any]) -> Self:
        """Return the same constants in another number type; exact zeros stay the int 0."""
        return self.of({name: convert(value) for name, value in self.entries().items()})


def is_zero(value: Any) -> bool:
    """Return whether a value is the int 0, which stands for an exact zero."""
    return isinstance(value, int) and value == 0


def constants(inputs: Inputs, ctx: Any) -> Constants:
    """Return the constants of a scene, in the precision of `ctx`: a run's own and `precision.GUARD_BITS` more.

    Raises:
        BeyondDoublesError: the Earth is so flat that its normal at the site has no finite length.
    """

    def number(value: Any) -> Any:
        return 0 if value == 0 else value

    sin = number(ctx.sinpi(to_mpf(inputs.latitude / 180, ctx)))
    cos = number(ctx.cospi(to_mpf(inputs.latitude / 180, ctx)))
    names = ("length", "gravity", "rotation_rate", "equatorial_radius", "flattening", "altitude")
    length, gravity, rate, radius, flattening, altitude = (
        to_mpf(getattr(inputs, name), ctx) for name in names
    )
    # effective gravity contains the centrifugal force at the pivot: what is left is that of a pivot
    # on the axis
    carried = inputs.gravity_is == "ellipsoid"
    try:
        distance = (
            axis_distance(radius, flattening, altitude, sin, cos, ctx.sqrt) if carried else ctx.zero
        )
    except ZeroDivisionError:  # at the pole of an Earth as flat as a disc
        raise BeyondDoublesError from None
    north, up, pull_north, pull_up = turn_and_pull(length, gravity, rate, distance, sin, cos)
    xx, yy, yz, zz = centrifugal_products(rate, north, up)
    return Constants(
        length=length,
        turn=(0, number(north), number(up)),
        pull=(0, number(pull_north), number(pull_up)),
        centrifugal=(number(xx), number(yy), number(yz), number(zz)),
        drag=number(to_mpf(inputs.drag, ctx)),
        gravity=number(gravity / length),
        axis_distance=number(distance / length),
        rate=number(rate),
        sin=sin,
        cos=cos,
    )


@lru_cache(maxsize=64)
def constants_in_double(inputs: Inputs) -> Constants:
    """Return the constants that follow from a scene's exact inputs as doubles, each rounded once."""
    return constants(inputs, context(DOUBLE_BITS + GUARD_BITS)).converted(float)


def turn_and_pull(
    length: Any, gravity: Any, rate: Any, distance: Any, sin: Any, cos: Any
) -> tuple[Any, Any, Any, Any]:
    """Return what of Ω and of c points north and up, in any number type; `distance` is R."""
    outward = rate * rate * distance
    return rate * cos, rate * sin, -outward * sin / length, (outward * cos - gravity) / length


def centrifugal_products(rate: Any, north: Any, up: Any) -> tuple[Any, Any, Any, Any]:
    """Return the entries xx, yy, yz, zz of |Ω|² I - Ω Ωᵀ for Ω = (0, north, up), in any number type.

    `rate` is Ω, of which the square alone is used.
    """
    return rate * rate, up * up, -north * up, north * north
