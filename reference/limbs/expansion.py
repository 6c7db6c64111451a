"""The Taylor polynomials of a step as integers, made where they are asked for."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from .digits import Array, fraction_bits, joined
from .lanes import LANES
from .series import PULL, M, W, X


@dataclass(frozen=True)
class Expansion:
    """Taylor polynomials of n and h² λ at t, of s = (time - t)/h, to be used up to t + h, in the axes of `series`.

    Attributes:
        t: centre in s, exact.
        h: step in s, exact.
        limbs: digits of a coefficient.
    """

    t: Fraction
    h: Fraction
    limbs: int
    _series: Array = field(repr=False)

    @property
    def bits(self) -> int:
        """Coefficients are integers over 2**bits."""
        return fraction_bits(self.limbs)

    @property
    def coefficients(self) -> tuple[list[int], ...]:
        """Rows x, m, w and h² λ, lowest order first; made when asked for: a proof needs every second expansion."""
        digits = self._series.reshape(-1, self.limbs, LANES)
        return tuple(joined(digits[:, :, lane]).tolist() for lane in (X, M, W, PULL))
