"""How many limbs a precision takes, and the highest precision that limbs have; needs no compiler."""

from __future__ import annotations

from ...numbers.precision import LONG_DOUBLE_BITS

LIMB_BITS = 22
_MOST_LIMBS = 18  # with more, and the order that goes with them, sums could pass 2**53
# the limbs go this much below the precision, as the sums of a step round at the last limb
_ROUNDING_BITS = 9


def fraction_bits(limb_count: int) -> int:
    """Return b such that a number of `limb_count` limbs is an integer over 2**b."""
    return LIMB_BITS * limb_count - 1


def limb_count_for(prec: int) -> int:
    """Return how many limbs keep `prec` bits of numbers up to 1 through a step."""
    return max(3, -(-(prec + _ROUNDING_BITS + 1) // LIMB_BITS))


def highest_prec(limb_count: int) -> int:
    """Return the highest precision for which `limb_count` limbs suffice."""
    return fraction_bits(limb_count) - _ROUNDING_BITS


LEAST_PREC = LONG_DOUBLE_BITS + 1
MOST_PREC = highest_prec(_MOST_LIMBS)
