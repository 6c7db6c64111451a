"""An audit of the sums of digits: they must be FLINT's integers for the same polynomials."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flint import arb

from ..numbers.taylor_step import Digits
from .trusted.shapes import Covered


class SumsChecked:
    """Follows a course that is proved by FLINT alone; steps without digits need no check."""

    def advance(self, covered: Covered) -> None:
        """Raise ArithmeticError unless the sums of a step's digits are FLINT's."""
        if isinstance(covered.piece.rows, Digits):
            from .trusted.digits import norms

            compare(covered.piece, norms)


def compare(piece: Any, norms: Callable[..., list[arb]]) -> None:
    """Raise ArithmeticError unless sums of a piece's digits are those it was proved with.

    All rows of digits give the same integers; the rows that a proof takes bound them.
    """
    table = piece.rows.table
    integers = piece.constants.integers
    _, count, _ = table.shape
    exact = norms(table, integers, count - 1)
    bounds = norms(table, integers)
    for own, sum_of_all, bound in zip(piece.norms, exact, bounds, strict=True):
        if not (sum_of_all == own and bound >= own):
            raise ArithmeticError("audit: the sums of digits are not FLINT's")
