"""Output times counted in grains, a power of two in s: an integer, and limbs for the remaining part of a grain."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from .limb import Array
from .size import LIMB_BITS, fraction_bits

Counts = npt.NDArray[np.int64]


def limbs_of_fractions(times: Sequence[Fraction], grain: Fraction, limb_count: int) -> tuple[Counts, Array]:
    """Return exact times in s as whole grains and the limbs of the remainders, cut after the last limb.

    Shapes (times,) and (times * limb_count,).
    """
    bits = fraction_bits(limb_count)
    parts = [divmod(t.numerator * grain.denominator, t.denominator * grain.numerator) for t in times]
    whole = np.array([top for top, _ in parts], dtype=np.int64)
    limbs = np.zeros((len(times), limb_count))
    broken = [i for i, (_, remainder) in enumerate(parts) if remainder]
    if broken:
        left = np.array([(parts[i][1] << bits) // (times[i].denominator * grain.numerator) for i in broken])
        left = left.astype(object)
        half, mask = 1 << (LIMB_BITS - 1), (1 << LIMB_BITS) - 1
        for q in range(limb_count - 1, 0, -1):
            limb = ((left + half) & mask) - half
            limbs[broken, q] = limb.astype(np.float64)
            left = (left - limb) >> LIMB_BITS
        limbs[broken, 0] = left.astype(np.float64)
    return whole, limbs.ravel()
