"""The Taylor step: the polynomials of one step of an integrator, as integers over a power of two. It only declares."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

LOCAL = ("x", "y", "z")  # n east, north and up
EARTH = ("x", "m", "w", "tension")  # n in the axes of the proof (`SceneBalls` in enclosure/bound.py), and h² λ


class TaylorStep(NamedTuple):
    """Polynomials of s = (time - centre)/h for -1 <= low <= s <= high <= 1: a row of integers over 2**bits each.

    Attributes:
        centre: in s, exact.
        h: unit of s in s, exact.
        low: where the step begins, in units of h.
        high: where it ends.
        bits: coefficients are integers over 2**bits.
        rows: a row of coefficients for each of `columns`, lowest order first; or a function that computes them, as a
            proof reads only every second step of a run.
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
        """The rows: lists of integers, `packing.Digits`, or FLINT's polynomials; a function is called now."""
        return self.rows() if callable(self.rows) else self.rows
