"""The Taylor polynomials of a step as integers, made where they are asked for."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from ...packing import WORD_BITS, Words
from .lanes import LANES, entry
from .limb import DIGIT_BITS, Array, fraction_bits
from .series import PULL, M, W, X

ROWS = np.array((X, M, W, PULL))


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
    def coefficients(self) -> Words:
        """Rows x, m, w and h² λ, lowest order first; made when asked for: a proof needs every second expansion."""
        words, orders = DIGIT_BITS * self.limbs // WORD_BITS + 1, len(self._series) // (LANES * self.limbs)
        table = np.empty((len(ROWS), words, orders), dtype=np.int64)
        write_words(table, self._series, ROWS, self.limbs)
        return Words(table)


@entry
def write_words(to: npt.NDArray[np.int64], series: Array, rows: npt.NDArray[np.int64], limbs: int) -> None:
    """Digits as words, shape (rows, words, orders)."""
    for i in range(to.shape[0]):
        for k in range(to.shape[2]):
            held, bits, over, word = 0, 0, 0, 0
            for q in range(limbs - 1, -1, -1):
                value = int(series[(k * limbs + q) * LANES + rows[i]]) + over
                over = value >> DIGIT_BITS
                digit, room = value - (over << DIGIT_BITS), WORD_BITS - bits
                if room <= DIGIT_BITS:
                    to[i, word, k] = held | (digit & ((1 << room) - 1)) << bits
                    held, bits, word = digit >> room, DIGIT_BITS - room, word + 1
                else:
                    held |= digit << bits
                    bits += DIGIT_BITS
            to[i, word, k] = held + (over << bits)
