"""The sums of digits checked: they must be the integers that FLINT finds for the same polynomials."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flint import arb

from ..numbers.taylor_step import Digits
from .balls import total


def check_sums(piece: Any) -> None:
    """Raise ArithmeticError unless sums of a piece's digits are FLINT's; what did not come as digits needs no check."""
    if isinstance(piece.rows, Digits):
        from .digits import norms

        compare(piece, norms)


def compare(piece: Any, norms: Callable[..., list[arb]]) -> None:
    """Raise ArithmeticError unless a piece's exact sums are FLINT's integers and shortened ones bound them."""
    table, whole = piece.rows.table, piece.k.whole
    rows = zip(piece.measured(), norms(table, whole, table.shape[1] - 1), norms(table, whole), strict=True)
    for f, exact, bound in rows:
        own = total(f, 2 * piece.step.bits)
        if not (exact == own and bound >= own):
            raise ArithmeticError("audit: the sums of digits are not FLINT's")
