"""The fixed-point table: exact numbers as integers over a power of two, in named columns, each with a bound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from .precision import Array


@dataclass(frozen=True)
class Table:
    """Columns of numbers, as integers over 2**bits, with a bound of the same shape on every one."""

    columns: tuple[str, ...]
    bits: int
    values: list[tuple[int, ...]] = field(repr=False)
    errors: list[tuple[int, ...]] = field(repr=False)

    def exact(self, name: str) -> list[Fraction]:
        """A column's values, exactly as computed."""
        return self._fractions(self.values, name)

    def bound(self, name: str) -> list[Fraction]:
        """A column's bounds: how far the exact values may be from the truth."""
        return self._fractions(self.errors, name)

    def _fractions(self, rows: Sequence[tuple[int, ...]], name: str) -> list[Fraction]:
        i = self.columns.index(name)
        return [Fraction(row[i], 1 << self.bits) for row in rows]

    def largest(self) -> tuple[Fraction, ...]:
        """Per column the largest size of its values."""
        return self._maxima(self.values)

    def largest_bounds(self) -> tuple[Fraction, ...]:
        """Per column the largest of its bounds."""
        return self._maxima(self.errors)

    def _maxima(self, rows: Sequence[tuple[int, ...]]) -> tuple[Fraction, ...]:
        return tuple(
            Fraction(max((abs(row[i]) for row in rows), default=0), 1 << self.bits) for i in range(len(self.columns))
        )

    def array(self, name: str) -> Array:
        """A column as the nearest doubles, shape (rows,)."""
        i, unit = self.columns.index(name), 1 << self.bits
        return np.array([row[i] / unit for row in self.values])


def largest_of(rows: Sequence[tuple[int, ...]], bits: int) -> tuple[Fraction, ...]:
    """Largest size of each column of a table of integers over 2**bits."""
    return tuple(Fraction(max(map(abs, column)), 2**bits) for column in zip(*rows, strict=True))


def disagreement(
    a: Sequence[tuple[int, ...]], a_bits: int, b: Sequence[tuple[int, ...]], b_bits: int
) -> tuple[Fraction, ...]:
    """Largest difference of two tables, per column."""
    up_a, up_b = max(0, b_bits - a_bits), max(0, a_bits - b_bits)
    columns = zip(zip(*a, strict=True), zip(*b, strict=True), strict=True)
    common = 2 ** max(a_bits, b_bits)
    return tuple(
        Fraction(max(abs((p << up_a) - (q << up_b)) for p, q in zip(one, other, strict=True)), common)
        for one, other in columns
    )


def bits_in(ratio: Fraction) -> int:
    """The power of two at or above a ratio; 0 for nothing."""
    if ratio <= 0:
        return 0
    power = ratio.numerator.bit_length() - ratio.denominator.bit_length()
    return power if ratio <= Fraction(2) ** power else power + 1
