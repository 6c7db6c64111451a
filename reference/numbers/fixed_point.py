"""Arithmetic with whole columns of numbers, as integers over one power of two: many times as fast as number by number.

It serves the equations of `model`, which take numbers of any type.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from .precision import Array, to_fraction

Integers = Any  # an array of integers of any size: dtype object, shape (rows,)


@dataclass(frozen=True, eq=False)
class FixedPoint:
    """A number or a column of numbers; each operation rounds down to the unit 2**-bits.

    Attributes:
        values: an integer, or an array of integers of any size (dtype object), in units of 2**-bits.
        bits: the same for both operands of an operation.
    """

    values: Any
    bits: int

    @classmethod
    def of(cls, number: Any, bits: int) -> FixedPoint:
        """Return a number, a Fraction or an mpf, rounded down."""
        exact = number if isinstance(number, Fraction) else to_fraction(number)
        return cls((exact.numerator << bits) // exact.denominator, bits)

    @classmethod
    def column(cls, numbers: Integers, unit: int, bits: int) -> FixedPoint:
        """Return numbers that are given as integers over `unit`, shape (rows,), rounded down."""
        return cls((numbers << bits) // unit, bits)

    def __add__(self, other: FixedPoint) -> FixedPoint:
        """Return the sum."""
        return FixedPoint(self.values + other.values, self.bits)

    def __sub__(self, other: FixedPoint) -> FixedPoint:
        """Return the difference."""
        return FixedPoint(self.values - other.values, self.bits)

    def __neg__(self) -> FixedPoint:
        """Return the number with the other sign."""
        return FixedPoint(-self.values, self.bits)

    def __mul__(self, other: Any) -> FixedPoint:
        """Return the product with another number, or with an integer or integers."""
        if isinstance(other, FixedPoint):
            return FixedPoint((self.values * other.values) >> self.bits, self.bits)
        return FixedPoint(self.values * other, self.bits)

    __rmul__ = __mul__

    def __truediv__(self, other: FixedPoint | int) -> FixedPoint:
        """Return the quotient."""
        if isinstance(other, int):
            return FixedPoint(self.values // other, self.bits)
        return FixedPoint((self.values << self.bits) // other.values, self.bits)

    def sqrt(self) -> FixedPoint:
        """Return the square root of a column, 0 where a number is below zero."""
        return FixedPoint(integers(math.isqrt(max(0, value) << self.bits) for value in self.values), self.bits)

    def __getitem__(self, rows: Array) -> FixedPoint:
        """Return some of the numbers of a column."""
        return FixedPoint(self.values[rows], self.bits)

    def fractions(self) -> list[Fraction]:
        """Return the numbers of a column exactly."""
        unit = 1 << self.bits
        return [Fraction(value, unit) for value in self.values]


def integers(values: Iterable[int]) -> Integers:
    """Return integers as an array."""
    found = list(values)
    array = np.empty(len(found), dtype=object)
    array[:] = found
    return array
