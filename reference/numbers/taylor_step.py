"""The Taylor step: polynomials of an integrator's step, as integers or digits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

LOCAL = ("x", "y", "z")  # n east, north and up
# n in the axes of the proof (`SceneBalls` in enclosure/trusted/system.py), and h² λ
EARTH = ("x", "m", "w", "tension")
DIGIT_BITS = 22  # what limbs are, and what a proof sums


class Digits(Sequence[list[int]]):
    """Rows of integers as digits of radix 2^22, to hand on without making them.

    Attributes:
        table: shape (rows, digits, length of a row), highest digit first; digits may be negative.
    """

    def __init__(self, table: npt.NDArray[np.int32]) -> None:
        self.table = table

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.table)

    def __getitem__(self, row: Any) -> Any:
        """Return the integers of a row."""
        return whole(self.table[row]).tolist()


def whole(digits: npt.NDArray[Any]) -> Any:
    """Return integers, as objects, from arrays of their digits of radix 2^22, highest first."""
    total, *low = digits.astype(object)
    for digit in low:
        total = (total << DIGIT_BITS) + digit
    return total


class TaylorStep(NamedTuple):
    """Polynomials of s = (time - centre)/h for -1 <= low <= s <= high <= 1.

    Each is a row of integers over 2**bits.

    Attributes:
        centre: in s, exact.
        h: unit of s in s, exact.
        low: where the step begins, in units of h.
        high: where it ends.
        bits: coefficients are integers over 2**bits.
        rows: a row of coefficients for each of `columns`, lowest order first; or a function that
            computes them, as a proof reads only every second step of a run.
        columns: what the rows are: `LOCAL`, after which an engine may add further rows, or `EARTH`.
    """

    centre: Fraction
    h: Fraction
    low: Fraction
    high: Fraction
    bits: int
    rows: Sequence[Any] | Callable[[], Sequence[Any]]
    columns: tuple[str, ...] = EARTH

    @property
    def coefficients(self) -> Sequence[Any]:
        """The rows: lists of integers, `Digits`, or FLINT's polynomials; a function is called."""
        return self.rows() if callable(self.rows) else self.rows
