"""The sums of digits checked: they must be the integers that FLINT finds for the same polynomials."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flint import arb

from ..numbers.taylor_step import Digits
from .trusted.shapes import Covered


class SumsChecked:
    """Follows a course that is proved by FLINT alone; what did not come as digits needs no check."""

    def advance(self, covered: Covered) -> None:
        """Raise ArithmeticError unless sums of a step's digits are FLINT's."""
        if isinstance(covered.piece.rows, Digits):
            from .trusted.digits import norms

            compare(covered.piece, norms)


def compare(piece: Any, norms: Callable[..., list[arb]]) -> None:
    """Raise ArithmeticError unless a piece's exact sums are those it was proved with, and shortened ones bound them."""
    table, whole = piece.rows.table, piece.constants.integers
    sums = zip(
        piece.norms, norms(table, whole, table.shape[1] - 1), norms(table, whole), strict=True
    )
    if not all(exact == own and bound >= own for own, exact, bound in sums):
        raise ArithmeticError("audit: the sums of digits are not FLINT's")
