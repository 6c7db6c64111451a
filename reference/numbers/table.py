"""Tables of exact numbers: named columns with bounds, how far two are apart, and how they are printed.

How many decimals to print a solved scene says (solver/solution.py), how to round precision.py.

Numbers are integers over a power of two. Whole columns of them can be put into formulas (`FixedPoint`).
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np

from .columns import KINDS, Framed, place_of
from .precision import Array, decimals_for, rounded, to_fraction, with_decimal_point

Integers = Any  # an array of integers of any size: dtype object, shape (rows,)
NOISE = 8  # a column whose largest number is within this many times its error is taken for zero


@dataclass(frozen=True)
class Table(Framed):
    """Named columns of numbers, as integers over 2**bits, with error bounds in the same form where they are known.

    `table["x"]` is a column as the nearest doubles, `len(table)` the number of rows.

    Attributes:
        columns: names of the columns.
        bits: the unit of `values` and `errors` is 2**-bits.
        values: rows of integers.
        errors: bounds on the errors of the values, of the same shape; empty where none are known.
    """

    columns: tuple[str, ...]
    bits: int
    values: list[tuple[int, ...]] = field(repr=False)
    errors: list[tuple[int, ...]] = field(default_factory=list, repr=False)

    @classmethod
    def of_intervals(
        cls, columns: tuple[str, ...], rows: Iterable[Sequence[Any]], bits: int
    ) -> Table:
        """Return the middles of intervals (exact ends `low`, `high`), and their half-widths as errors, rounded up."""
        values, errors = [], []
        for row in rows:
            lows = [(x.low.numerator << bits) // x.low.denominator for x in row]
            highs = [-((-x.high.numerator << bits) // x.high.denominator) for x in row]
            middles = tuple((low + high) // 2 for low, high in zip(lows, highs, strict=True))
            values.append(middles)
            errors.append(tuple(high - middle for high, middle in zip(highs, middles, strict=True)))
        return cls(columns, bits, values, errors)

    def with_errors(self, errors: Mapping[str, Fraction]) -> Table:
        """Return the table with error bounds for all rows, by column name, rounded up."""
        bounds = tuple(math.ceil(errors[name] * (1 << self.bits)) for name in self.columns)
        return Table(self.columns, self.bits, self.values, [bounds] * len(self))

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.values)

    def __getitem__(self, name: str) -> Array:
        """Return a column as the nearest doubles, shape (rows,)."""
        i, unit = place_of(name, self.columns), 1 << self.bits
        return np.array([row[i] / unit for row in self.values], dtype=np.float64)

    array = __getitem__

    def exact(self, name: str) -> list[Fraction]:
        """Return the values of a column, exactly as computed."""
        i = place_of(name, self.columns)
        return [Fraction(row[i], 1 << self.bits) for row in self.values]

    def bound(self, name: str) -> list[Fraction]:
        """Return the bounds on the errors of a column's values."""
        i = place_of(name, self.columns)
        return [Fraction(row[i], 1 << self.bits) for row in self.errors]

    def whole(self, name: str, bits: int) -> list[int]:
        """Return the values of a column as integers over 2**bits; `bits` is at least the table's."""
        i, up = place_of(name, self.columns), bits - self.bits
        return [row[i] << up for row in self.values]

    def only(self, columns: tuple[str, ...]) -> Table:
        """Return the table with just these columns."""
        if columns == self.columns:
            return self
        places = [place_of(name, self.columns) for name in columns]
        values, errors = (
            [tuple(row[i] for i in places) for row in rows] for rows in (self.values, self.errors)
        )
        return Table(columns, self.bits, values, errors)

    def distance(self, other: Table) -> Table:
        """Return the absolute differences of two tables with as many rows, in this table's columns."""
        other, bits = other.only(self.columns), max(self.bits, other.bits)
        up, other_up = bits - self.bits, bits - other.bits
        rows = zip(self.values, other.values, strict=True)
        gaps = [
            tuple(abs((p << up) - (q << other_up)) for p, q in zip(a, b, strict=True))
            for a, b in rows
        ]
        return Table(self.columns, bits, gaps)

    def largest(self) -> dict[str, Fraction]:
        """Return the largest absolute value of each column."""
        return self._maxima(self.values)

    def largest_bounds(self) -> dict[str, Fraction]:
        """Return the largest bound of each column."""
        return self._maxima(self.errors)

    def _maxima(self, rows: Sequence[tuple[int, ...]]) -> dict[str, Fraction]:
        unit, columns = (
            1 << self.bits,
            zip(*rows, strict=True) if rows else ((0,) for _ in self.columns),
        )
        return {
            name: Fraction(max(map(abs, column)), unit)
            for name, column in zip(self.columns, columns, strict=True)
        }

    def printed(self, decimals: Mapping[str, int]) -> list[tuple[str, ...]]:
        """Return the rows as text, each number rounded to its column's digits after the point."""
        places = [decimals[name] for name in self.columns]
        scales, unit = [10**count for count in places], 1 << self.bits
        return [
            tuple(
                with_decimal_point(rounded(value * scale, unit), count)
                for value, scale, count in zip(row, scales, places, strict=True)
            )
            for row in self.values
        ]

    def undecided(
        self, decimals: Mapping[str, int], exact: Container[str] = ()
    ) -> tuple[Fraction, str, str] | None:
        """Return the least known of the numbers of which the bounds do not decide each printed digit, or None.

        It comes as its bound in units of the last printed digit, its column and its text. A number is decided if every
        number within the bound is printed alike. `exact` are columns whose first number is known exactly.
        """
        scales, unit = [10 ** decimals[name] for name in self.columns], 1 << self.bits
        worst: tuple[Fraction, str, str] | None = None
        for k, (row, errors) in enumerate(zip(self.values, self.errors, strict=True)):
            for name, value, error, scale in zip(self.columns, row, errors, scales, strict=True):
                if k == 0 and name in exact:
                    continue
                if rounded((value - error) * scale, unit) != rounded((value + error) * scale, unit):
                    text = with_decimal_point(rounded(value * scale, unit), decimals[name])
                    worst = max(
                        (Fraction(error * scale, unit), name, text), worst or (Fraction(0), "", "")
                    )
        return worst


def resolved(
    largest: Mapping[str, Fraction], errors: Mapping[str, Fraction]
) -> dict[str, Fraction]:
    """Return the size of each column: its largest number, or that of its kind if it is nothing but error.

    A coordinate that vanishes by symmetry comes out of a run as rounding noise, and noise has no significant digits.
    """
    sizes = {
        name: size if size > NOISE * errors[name] else Fraction(0) for name, size in largest.items()
    }
    return {
        name: size or max(sizes.get(column, Fraction(0)) for column in KINDS[name])
        for name, size in sizes.items()
    }


def decimals_of(sizes: Mapping[str, Fraction], digits: int) -> dict[str, int]:
    """Return the digits after the point that give the largest number of each column `digits` significant ones."""
    return {name: decimals_for(size, digits) for name, size in sizes.items()}


def bits_in(ratio: Fraction) -> int:
    """Return the smallest integer n with ratio <= 2**n; 0 if the ratio is 0."""
    if ratio <= 0:
        return 0
    power = ratio.numerator.bit_length() - ratio.denominator.bit_length()
    return power if ratio <= Fraction(2) ** power else power + 1


@dataclass(frozen=True, eq=False)
class FixedPoint:
    """A number or a column of numbers; each operation rounds down to the unit 2**-bits.

    It serves the equations of `model`, which take numbers of any type, and is many times as fast as number by number.

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
        return FixedPoint(
            integers(math.isqrt(max(0, value) << self.bits) for value in self.values), self.bits
        )

    def __getitem__(self, rows: Array) -> FixedPoint:
        """Return some of the numbers of a column."""
        return FixedPoint(self.values[rows], self.bits)

    def fractions(self) -> list[Fraction]:
        """Return the numbers of a column exactly."""
        unit = 1 << self.bits
        return [Fraction(value, unit) for value in self.values]


def integers(values: Iterable[int]) -> Integers:
    """Return integers as an array."""
    listed = list(values)
    array = np.empty(len(listed), dtype=object)
    array[:] = listed
    return array
