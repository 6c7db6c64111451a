"""An audit of the sums of digits: they must be the integers that FLINT finds for the same polynomials."""

from __future__ import annotations

from typing import Any

from flint import arb, fmpz

Measured = list[tuple[list[Any], int]]  # as `Piece.measured` returns


def compare(measured: Measured, digits: Any) -> None:
    """Raise ArithmeticError unless exact sums of digits are FLINT's integers, and shortened ones bound them."""
    rows = zip(measured, digits.norms(digits.count - 1), digits.norms(), strict=True)
    for (derivatives, bits), exact, bounds in rows:
        for f, x, bound in zip(derivatives, exact, bounds, strict=True):
            own = arb((sum(map(abs, f.coeffs()), fmpz(0)), fmpz(-bits)))
            if not (x == own and bound >= own):
                raise ArithmeticError("audit: the sums of digits are not FLINT's")
