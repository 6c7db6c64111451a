"""Output times in grains: a whole number, and the digits of what is beyond it."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from .limb import DIGIT_BITS, RADIX, UNIT, Array, fraction_bits

Counts = npt.NDArray[np.int64]


def digits_of_fractions(times: Sequence[Fraction], grain: Fraction, limbs: int) -> tuple[Counts, Array]:
    """Exact times in s; the digits beyond the whole grains are cut at the last, shape (times * limbs,)."""
    bits = fraction_bits(limbs)
    parts = [divmod(t.numerator * grain.denominator, t.denominator * grain.numerator) for t in times]
    whole = np.array([top for top, _ in parts], dtype=np.int64)
    rest = np.zeros((len(times), limbs))
    broken = [i for i, (_, left) in enumerate(parts) if left]
    if broken:
        left = np.array([(parts[i][1] << bits) // (times[i].denominator * grain.numerator) for i in broken])
        left = left.astype(object)
        half, mask = 1 << (DIGIT_BITS - 1), (1 << DIGIT_BITS) - 1
        for q in range(limbs - 1, 0, -1):
            digit = ((left + half) & mask) - half
            rest[broken, q] = digit.astype(np.float64)
            left = (left - digit) >> DIGIT_BITS
        rest[broken, 0] = left.astype(np.float64)
    return whole, rest.ravel()


def digits_of_doubles(times: Array, grain: float, limbs: int) -> tuple[Counts, Array]:
    """Times in s as doubles; exact, as the grain is a power of two."""
    scaled = times / grain
    whole = np.floor(scaled)
    left = (scaled - whole) * UNIT
    rest = np.zeros((len(times), limbs))
    for q in range(limbs):
        rest[:, q] = np.rint(left)
        left = (left - rest[:, q]) * RADIX
    return whole.astype(np.int64), rest.ravel()
