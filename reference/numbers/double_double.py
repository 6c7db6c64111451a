"""Arrays of unevaluated sums of two doubles, about 106 bits, without FMA.

They serve the constants of many rows at once.

Sums and products by Dekker (1971) and Knuth; relative errors of an operation are a few 2**-104
(Joldes, Muller and Popescu 2017), away from overflow and underflow.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any, Self

import numpy as np

from .precision import Array, context, to_fraction

_SPLIT = 134217729.0  # 2**27 + 1: cuts a double into two halves of 26 bits
_STEP = 2.5  # degrees between the angles whose sine and cosine are known
_TURN = 144  # of them in a turn


@dataclass(frozen=True)
class DoubleDouble:
    """Numbers high + low, |low| at most half an ulp of high; arrays whose shapes broadcast."""

    high: Array
    low: Array
    __array_ufunc__ = None  # numpy leaves operators to this class

    @classmethod
    def of(cls, values: Iterable[Fraction]) -> Self:
        """Return exact numbers, rounded to the nearest sum of two doubles, or to inf."""
        pairs = np.array([_pair(value) for value in values]).reshape(-1, 2)
        return cls(pairs[:, 0].copy(), pairs[:, 1].copy())

    @classmethod
    def from_pairs(cls, pairs: Array) -> Self:
        """Return the numbers of an array of shape (…, 2)."""
        return cls(pairs[..., 0], pairs[..., 1])

    @property
    def pairs(self) -> Array:
        """The numbers as a contiguous array of shape (…, 2), high and low."""
        return np.stack((self.high, self.low), axis=-1)

    @property
    def vanishes(self) -> Any:
        """Where a number is exactly zero."""
        return self.high == 0

    def __neg__(self) -> Self:
        return type(self)(-self.high, -self.low)

    def __add__(self, other: Any) -> Self:
        if not isinstance(other, DoubleDouble):
            total, error = _sum(self.high, other)
            return type(self)(*_quick(total, error + self.low))
        total, error = _sum(self.high, other.high)
        low, low_error = _sum(self.low, other.low)
        total, error = _quick(total, error + low)
        return type(self)(*_quick(total, error + low_error))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Self:
        return self.__add__(-other)

    def __rsub__(self, other: Any) -> Self:
        return (-self).__add__(other)

    def __mul__(self, other: Any) -> Self:
        high, low = (other.high, other.low) if isinstance(other, DoubleDouble) else (other, 0.0)
        product, error = _product(self.high, high)
        return type(self)(*_quick(product, error + (self.high * low + self.low * high)))

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Self:
        divisor = other if isinstance(other, DoubleDouble) else type(self)(other, 0.0 * other)
        first = self.high / divisor.high
        remainder = self - divisor * first
        second = remainder.high / divisor.high
        remainder = remainder - divisor * second
        return type(self)(*_quick(first, second)) + remainder.high / divisor.high

    def where(self, chosen: Any, other: Self) -> Self:
        """Return these numbers where `chosen`, the others elsewhere."""
        high = np.where(chosen, self.high, other.high)
        low = np.where(chosen, self.low, other.low)
        return type(self)(high, low)


def square_root(a: DoubleDouble) -> DoubleDouble:
    """Return the square root, of zero zero."""
    first = np.sqrt(a.high)
    remainder = a - DoubleDouble(*_product(first, first))
    zero = np.zeros_like(first)
    second = np.divide(0.5 * remainder.high, first, out=zero, where=first != 0)
    return DoubleDouble(*_quick(first, second))


def sine_and_cosine(degrees: DoubleDouble) -> tuple[DoubleDouble, DoubleDouble]:
    """Return sine and cosine of angles of at most 2**40 degrees.

    At the quarters of a turn they are exact.
    """
    sines, cosines, radian = _known_angles()
    near = np.rint(degrees.high / _STEP)
    r = DoubleDouble(*_quick(degrees.high - near * _STEP, degrees.low)) * radian

    # Taylor series; their terms of higher orders in double
    square = r * r
    s = square.high
    odd = s * (-1 / 5040 + s * (1 / 362880 + s * (-1 / 39916800 + s / 6227020800)))
    even = s * (1 / 40320 + s * (-1 / 3628800 + s * (1 / 479001600 - s / 87178291200)))
    sine = r + r * (square * (square * (_exactly(1, 120) + odd) - _exactly(1, 6)))
    # the cosine less 1
    cosine = square * (square * (_exactly(1, 24) + square * (even - _exactly(1, 720))) - 0.5)

    at = near.astype(np.int64) % _TURN
    sin, cos = (DoubleDouble(table.high[at], table.low[at]) for table in (sines, cosines))
    return sin + (sin * cosine + cos * sine), cos + (cos * cosine - sin * sine)


def in_radians(degrees: DoubleDouble) -> DoubleDouble:
    """Return angles in radians."""
    return degrees * _known_angles()[2]


@cache
def _exactly(numerator: int, denominator: int) -> DoubleDouble:
    return DoubleDouble.of([Fraction(numerator, denominator)])


@cache
def _known_angles() -> tuple[DoubleDouble, DoubleDouble, DoubleDouble]:
    """Return sine and cosine of the multiples of _STEP in a turn, and the radians of a degree."""
    ctx = context(160)
    angles = [ctx.mpf(_STEP) * k / 180 for k in range(_TURN)]
    sines = DoubleDouble.of(to_fraction(ctx.sinpi(angle)) for angle in angles)
    cosines = DoubleDouble.of(to_fraction(ctx.cospi(angle)) for angle in angles)
    radian = DoubleDouble.of([to_fraction(ctx.pi / 180)])
    return sines, cosines, radian


def _pair(value: Fraction) -> tuple[float, float]:
    try:
        high = float(value)
    except OverflowError:
        return (np.inf if value > 0 else -np.inf), 0.0
    return high, float(value - Fraction(high))


def _sum(a: Any, b: Any) -> tuple[Any, Any]:
    total = a + b
    other = total - a
    return total, (a - (total - other)) + (b - other)


def _quick(a: Any, b: Any) -> tuple[Any, Any]:
    """Return the sum and its error where |a| >= |b|."""
    total = a + b
    return total, b - (total - a)


def _halves(a: Any) -> tuple[Any, Any]:
    large = a * _SPLIT
    high = large - (large - a)
    return high, a - high


def _product(a: Any, b: Any) -> tuple[Any, Any]:
    product = a * b
    a_high, a_low = _halves(a)
    b_high, b_low = _halves(b)
    error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
    return product, error
