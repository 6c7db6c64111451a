"""Rows in the axes of the plumb line, x east, p in the meridian, u up along -c: there a small swing loses no digits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from ..numbers.double_double import DoubleDouble, square_root
from ..numbers.precision import Array
from .batch_interface import Rows

_SAME = 2.0**-94  # of a row's velocities: u' that is less at the release is zero


@dataclass(frozen=True)
class PlumbAxes:
    """Constants and releases of n rows in these axes, each number of shape (n,).

    Attributes:
        size: |c|, in 1/s²; c points down.
        sin, cos: the direction up, north and up.
        turn: Ω without its part to the east, which is 0.
        n, V: as in `Rows`.
        udot: u', the rate at which the bob rises at the release, over l.
        speed: a bound of the velocities over l.
        level: whether u' is exactly zero at the release.
    """

    size: DoubleDouble
    sin: DoubleDouble
    cos: DoubleDouble
    turn: tuple[DoubleDouble, DoubleDouble]
    n: tuple[DoubleDouble, DoubleDouble, DoubleDouble]
    V: tuple[DoubleDouble, DoubleDouble, DoubleDouble]
    udot: DoubleDouble
    speed: Array
    level: Any

    @classmethod
    def of(cls, rows: Rows) -> Self:
        """Turn rows into these axes."""
        of = DoubleDouble.from_pairs
        north, up = of(rows.pull[:, 1]), of(rows.pull[:, 2])
        size = square_root(north * north + up * up)
        sin, cos = plumb_line(north, up, size, np.where(size.vanishes, 1.0, 0.0))
        turn = turned(of(rows.turn[:, 1]), of(rows.turn[:, 2]), sin, cos)
        n, V = ((of(part[:, 0]), *turned(of(part[:, 1]), of(part[:, 2]), sin, cos)) for part in (rows.n, rows.V))
        udot = V[2] + turn[0] * n[0]
        speed = np.abs(rows.V[:, :, 0]).sum(1) + np.abs(rows.turn[:, :, 0]).sum(1)
        return cls(size, sin, cos, turn, n, V, udot, speed, np.abs(udot.high) <= _SAME * speed)


def moved(numbers: Array, way: int) -> Array:
    """Return numbers one ulp further from zero, or nearer to it where `way` is -1; as they are where it is 0."""
    beyond = np.copysign(np.inf, numbers) if way > 0 else 0.0
    return np.where(numbers == 0, 0.0, np.nextafter(numbers, beyond)) if way else numbers


def plumb_line(north: Any, up: Any, size: Any, none: Array) -> tuple[Any, Any]:
    """Return the unit vector up along -c; the vertical where there is no force, `none` 1 instead of 0."""
    return -north / (size + none), (none - up) / (size + none)


def turned(north: Any, up: Any, sin: Any, cos: Any) -> tuple[Any, Any]:
    """Return a vector's parts in the meridian and along the plumb line, which leans by (sin, cos) from the vertical."""
    return cos * north - sin * up, sin * north + cos * up
