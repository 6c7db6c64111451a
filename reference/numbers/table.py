"""Tables of exact numbers: named columns with bounds, the distance of two tables, and their text.

The number of decimals to print comes from solver/solution.py, rounding from precision.py. Numbers
are integers over a power of two. Whole columns of them can be put into formulas (`FixedPoint`).
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from .columns import KINDS, Framed, place_of
from .precision import Array, decimals_for, rounded, to_fraction, with_decimal_point

Integers = Any  # an array of integers of any size: dtype object, shape (rows,)
_NOISE = 8  # a column whose largest number is within this many times its error is taken for zero


@dataclass(frozen=True)
class Table(Framed):
    """Named columns of numbers, as integers over 2**bits, with error bounds where they are known.

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
        """Return the middles of intervals (exact ends `low`, `high`), with half-widths as errors.

        The errors are rounded up.
        """
        values = []
        errors = []
        for row in rows:
            middles = []
            halves = []
            for interval in row:
                low = (interval.low.numerator << bits) // interval.low.denominator
                high = -((-interval.high.numerator << bits) // interval.high.denominator)
                middle = (low + high) // 2
                middles.append(middle)
                halves.append(high - middle)
            values.append(tuple(middles))
            errors.append(tuple(halves))
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
        i = place_of(name, self.columns)
        unit = 1 << self.bits
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
        """Return a column as integers over 2**bits; `bits` is at least the table's."""
        i = place_of(name, self.columns)
        up = bits - self.bits
        return [row[i] << up for row in self.values]

    def only(self, columns: tuple[str, ...]) -> Table:
        """Return the table with just these columns."""
        if columns == self.columns:
            return self
        places = [place_of(name, self.columns) for name in columns]

        def chosen(row: tuple[int, ...]) -> tuple[int, ...]:
            return tuple(row[i] for i in places)

        values = [chosen(row) for row in self.values]
        errors = [chosen(row) for row in self.errors]
        return Table(columns, self.bits, values, errors)

    def distance(self, other: Table) -> Table:
        """Return the absolute differences of tables of as many rows, in this table's columns."""
        other = other.only(self.columns)
        bits = max(self.bits, other.bits)
        up = bits - self.bits
        other_up = bits - other.bits
        distances = []
        for row, other_row in zip(self.values, other.values, strict=True):
            pairs = zip(row, other_row, strict=True)
            distances.append(tuple(abs((p << up) - (q << other_up)) for p, q in pairs))
        return Table(self.columns, bits, distances)

    def largest(self) -> dict[str, Fraction]:
        """Return the largest absolute value of each column."""
        return self._maxima(self.values)

    def largest_bounds(self) -> dict[str, Fraction]:
        """Return the largest bound of each column."""
        return self._maxima(self.errors)

    def _maxima(self, rows: Sequence[tuple[int, ...]]) -> dict[str, Fraction]:
        if not rows:
            return dict.fromkeys(self.columns, Fraction(0))
        unit = 1 << self.bits
        maxima = {}
        for name, column in zip(self.columns, zip(*rows, strict=True), strict=True):
            maxima[name] = Fraction(max(map(abs, column)), unit)
        return maxima

    def printed(self, decimals: Mapping[str, int]) -> list[tuple[str, ...]]:
        """Return the rows as text, each number rounded to its column's digits after the point."""
        unit = 1 << self.bits
        places = [decimals[name] for name in self.columns]
        scales = [10**count for count in places]
        texts = []
        for row in self.values:
            numbers = zip(row, scales, places, strict=True)
            texts.append(
                tuple(
                    with_decimal_point(rounded(value * scale, unit), count)
                    for value, scale, count in numbers
                )
            )
        return texts

    def undecided(
        self, decimals: Mapping[str, int], exact: Container[str] = ()
    ) -> UndecidedNumber | None:
        """Return the number of widest bound whose printed digits are undecided, or None.

        A number is decided if every number within its bound is printed alike.

        Args:
            decimals: digits after the point of each column.
            exact: columns whose first number is known exactly.
        """
        unit = 1 << self.bits
        scales = [10 ** decimals[name] for name in self.columns]
        worst: UndecidedNumber | None = None
        for k, (row, errors) in enumerate(zip(self.values, self.errors, strict=True)):
            for name, value, error, scale in zip(self.columns, row, errors, scales, strict=True):
                if k == 0 and name in exact:
                    continue
                least = rounded((value - error) * scale, unit)
                largest = rounded((value + error) * scale, unit)
                if least == largest:
                    continue
                text = with_decimal_point(rounded(value * scale, unit), decimals[name])
                number = UndecidedNumber(Fraction(error * scale, unit), name, text)
                worst = number if worst is None else max(number, worst)
        return worst


class UndecidedNumber(NamedTuple):
    """A number whose bound does not decide its printed digits; wider bounds sort higher.

    Attributes:
        width: its bound, in units of the last printed digit.
        column: its column.
        text: as it would be printed.
    """

    width: Fraction
    column: str
    text: str


def resolved(
    largest: Mapping[str, Fraction], errors: Mapping[str, Fraction]
) -> dict[str, Fraction]:
    """Return the size of each column: its largest number, or that of its kind if it is all error.

    A coordinate that vanishes by symmetry comes out of a run as rounding noise, and noise has no
    significant digits.
    """
    sizes = {}
    for name, size in largest.items():
        is_noise = size <= _NOISE * errors[name]
        sizes[name] = Fraction(0) if is_noise else size
    of_kind = {}
    for name, size in sizes.items():
        of_kind[name] = size or max(sizes.get(column, Fraction(0)) for column in KINDS[name])
    return of_kind


def decimals_of(sizes: Mapping[str, Fraction], digits: int) -> dict[str, int]:
    """Return the digits after the point that give each column's size `digits` significant ones."""
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

    It serves the equations of `model`, which take numbers of any type, and is many times as fast as
    number by number.

    Attributes:
        values: an integer, or an array of integers of any size (dtype object), in units of
            2**-bits.
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
        roots = [math.isqrt(max(0, value) << self.bits) for value in self.values]
        return FixedPoint(integers(roots), self.bits)

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
