"""The golden function: motion at any time, from Chebyshev series in doubles (docs/format.md)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from .columns import STATE
from .precision import Array


@dataclass(frozen=True)
class States:
    """States at times.

    `t` (s), `x`, `y`, `z` (m), `vx`, `vy`, `vz` (m/s) have the shape of the times asked for.

    Attributes:
        bound: bound on the error of all numbers of a component, by its name, in m or m/s.
    """

    t: Array
    x: Array
    y: Array
    z: Array
    vx: Array
    vy: Array
    vz: Array
    bound: Mapping[str, float]

    @classmethod
    def of(cls, t: Array, columns: Iterable[Array], bound: Mapping[str, float]) -> States:
        """Build from times of any shape and the six components, shape (times,).

        A single time gives plain numbers.
        """
        shaped = {}
        for name, column in zip(STATE, columns, strict=True):
            shaped[name] = column.reshape(t.shape)[()]
        return cls(t=t[()], **shaped, bound=bound)


@dataclass(frozen=True, repr=False)
class GoldenFunction:
    """The motion at any time of a span, from Chebyshev series in doubles.

    There is one for each piece of the span and each component.

    Attributes:
        times: ends of the pieces in s, increasing from 0, shape (pieces + 1,).
        coefficients: shape (degree + 1, components, pieces); the components are x, y, and z where
            it has a series.
        square: square of the length in m², from which z follows if it has no series.
        bound: proven bound on the error of any value of a component, rounding included, by its
            name, in m or m/s.
    """

    times: Array
    coefficients: Array = field(repr=False)
    square: float | None
    bound: Mapping[str, float]

    @classmethod
    def of(
        cls, facts: Mapping[str, Any], bounds: Mapping[str, Fraction | str], data: bytes
    ) -> GoldenFunction:
        """Build from function.json, its bounds, and the bytes of function.f64."""
        times = np.array([float.fromhex(text) for text in facts["times"]])
        shape = (len(times) - 1, len(facts["components"]), facts["degree"] + 1)
        coefficients = np.frombuffer(data, "<f8").astype(np.float64).reshape(shape)
        coefficients = np.ascontiguousarray(coefficients.transpose(2, 1, 0))
        square = facts["length_squared"] and float.fromhex(facts["length_squared"])
        in_doubles = {}
        for name, bound in bounds.items():
            in_doubles[name] = math.nextafter(float(bound), math.inf)
        return cls(times, coefficients, square, in_doubles)

    def at(self, t: npt.ArrayLike) -> States:
        """Return the states at times in s, of any shape and in any order.

        Raises:
            InputError: a time lies outside of the span, or is not finite.
        """
        moments = moments_of(t, self.times[-1])
        return States.of(moments, self._evaluated(moments.ravel()), self.bound)

    def _evaluated(self, t: Array) -> tuple[Array, ...]:
        """Return x, y, z, vx, vy, vz, operation by operation as specified."""
        last_piece = len(self.times) - 2
        piece = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, last_piece)
        begin, end = self.times[piece], self.times[piece + 1]
        width = end - begin
        u = ((t - begin) - (end - t)) / width
        twice = u + u

        # Clenshaw's recurrences of the series (b) and of its derivative (d)
        zero = np.zeros((self.coefficients.shape[1], len(t)))
        b1 = b2 = d1 = d2 = zero
        for k in range(len(self.coefficients) - 1, 0, -1):
            c = self.coefficients[k][:, piece]
            b1, b2 = (twice * b1 - b2) + c, b1
            d1, d2 = (twice * d1 - d2) + k * c, d1
        position = (u * b1 - b2) + self.coefficients[0][:, piece]
        velocity = (d1 + d1) / width

        if self.square is None:
            return (*position, *velocity)
        x, y = position
        vx, vy = velocity
        z = -np.sqrt(self.square - (x * x + y * y))
        vz = -(x * vx + y * vy) / z
        return x, y, z, vx, vy, vz


def moments_of(times: npt.ArrayLike, end: float | Fraction, later: float = 0.0) -> Array:
    """Return times as doubles.

    Raises:
        InputError: one is no number, not finite, before 0, or more than `later` s after the scene's
            `end` in s.
    """
    expected = f"times from 0 to {float(end):.17g} s"
    try:
        t = np.asarray(times, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError("t", times, expected) from None
    outside = t[~((t >= 0) & (t <= float(end) + later))]
    if outside.size:
        advice = "The scene ends there: a larger run.t_end solves a longer one."
        raise InputError("t", f"{outside[0]:.17g}", expected, advice)
    return t
