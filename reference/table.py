"""The fixed-point table: exact numbers as integers over a power of two, in named columns, each with a bound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from .precision import Array


@dataclass(frozen=True)
class Table:
    """Named columns of numbers, as integers over 2**bits, with an error bound on each of them in the same form.

    Attributes:
        columns: names of the columns.
        bits: the unit of `values` and `errors` is 2**-bits.
        values: rows of integers.
        errors: bounds on the errors of the values, of the same shape.
    """

    columns: tuple[str, ...]
    bits: int
    values: list[tuple[int, ...]] = field(repr=False)
    errors: list[tuple[int, ...]] = field(repr=False)

    def exact(self, name: str) -> list[Fraction]:
        """Return the values of a column, exactly as computed."""
        return self._fractions(self.values, name)

    def bound(self, name: str) -> list[Fraction]:
        """Return the bounds on the errors of a column's values."""
        return self._fractions(self.errors, name)

    def _fractions(self, rows: Sequence[tuple[int, ...]], name: str) -> list[Fraction]:
        i = self.columns.index(name)
        return [Fraction(row[i], 1 << self.bits) for row in rows]

    def largest(self) -> tuple[Fraction, ...]:
        """Return the largest absolute value of each column."""
        return self._maxima(self.values)

    def largest_bounds(self) -> tuple[Fraction, ...]:
        """Return the largest bound of each column."""
        return self._maxima(self.errors)

    def _maxima(self, rows: Sequence[tuple[int, ...]]) -> tuple[Fraction, ...]:
        return tuple(
            Fraction(max((abs(row[i]) for row in rows), default=0), 1 << self.bits) for i in range(len(self.columns))
        )

    def array(self, name: str) -> Array:
        """Return a column as the nearest doubles, shape (rows,)."""
        i, unit = self.columns.index(name), 1 << self.bits
        return np.array([row[i] / unit for row in self.values])


def largest_of(rows: Sequence[tuple[int, ...]], bits: int) -> tuple[Fraction, ...]:
    """Return the largest absolute value of each column, for rows of integers over 2**bits."""
    return tuple(Fraction(max(map(abs, column)), 2**bits) for column in zip(*rows, strict=True))


def disagreement(
    a: Sequence[tuple[int, ...]], a_bits: int, b: Sequence[tuple[int, ...]], b_bits: int
) -> tuple[Fraction, ...]:
    """Return the largest absolute difference of two tables in each column.

    The rows of `a` are integers over 2**a_bits, those of `b` over 2**b_bits; shapes are equal.
    """
    shift_a, shift_b = max(0, b_bits - a_bits), max(0, a_bits - b_bits)
    columns = zip(zip(*a, strict=True), zip(*b, strict=True), strict=True)
    common = 2 ** max(a_bits, b_bits)
    return tuple(
        Fraction(max(abs((p << shift_a) - (q << shift_b)) for p, q in zip(column_a, column_b, strict=True)), common)
        for column_a, column_b in columns
    )


def bits_in(ratio: Fraction) -> int:
    """Return the smallest integer n with ratio <= 2**n; 0 if the ratio is 0."""
    if ratio <= 0:
        return 0
    power = ratio.numerator.bit_length() - ratio.denominator.bit_length()
    return power if ratio <= Fraction(2) ** power else power + 1
