"""All zeros of one lane's polynomial on a step, by halving: where the lanes at once cannot tell."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..limbs.compiling import compiled
from ..limbs.lanes import LANES
from ..limbs.limb import Array
from ..limbs.polynomial import FREE, MONOTONE, classify, crossing, value_at
from .lane_zeros import NOISE, Zeros
from .series import MOST_ORDER

MOST_ZEROS = 16  # of one step
DOUBT = -1  # returned where a sign is lost in rounding
_CUT = 0.4871  # of an interval: no special place, where symmetry could put a zero
_NARROWEST = 2.0**-40
_DEEPEST = 64  # halves of a step, one in another, down to the narrowest


class Bisection(NamedTuple):
    """Working arrays: the polynomial, the ends of intervals still to be examined, the zeros and the slopes there."""

    f: Array
    stack: Array
    places: Array
    slopes: Array


def empty_bisection() -> Bisection:
    """Return working arrays."""
    return Bisection(np.zeros(MOST_ORDER + 1), np.zeros(2 * _DEEPEST), np.zeros(MOST_ZEROS), np.zeros(MOST_ZEROS))


@compiled
def all_zeros(w: Bisection, z: Zeros, f: Array, lane: int, length: float, multiplicity: int, order: int) -> int:
    """Write the zeros on 0 < s <= length, in order; return their number, or DOUBT.

    Args:
        w: where they are written.
        z: the values at the start, of which the sign counts, and at the end.
        f: the polynomials of all lanes.
        lane: which of them.
        length: of the step.
        multiplicity: of a zero at the start that is exact; -1 where the start's value alone gives the sign.
        order: number of coefficients.
    """
    skipped = max(multiplicity, 0)
    size, total, count = order - skipped, 0.0, 0
    for k in range(size - 1, -1, -1):
        w.f[k] = f[LANES * (k + skipped) + lane]
        total = total * length + abs(w.f[k])
    noise = NOISE * total
    left = z.before[lane] if multiplicity < 0 else w.f[0]
    right = value_at(w.f, size, length)
    # the polynomial is cut off: the state's own value has to be on the same side
    if abs(left) <= noise or abs(right) <= noise or (right > 0.0) != (z.after[lane] > 0.0):
        return DOUBT
    low, n = 0.0, 0  # the stack holds the intervals' ends, and the values there: the next interval's on top
    w.stack[0], w.stack[1] = length, right
    while n >= 0:
        high, right = w.stack[2 * n], w.stack[2 * n + 1]
        half, same = 0.5 * (high - low), (left > 0.0) == (right > 0.0)
        kind = classify(w.f, size, low + half, half, noise)[0]
        if kind not in (FREE, MONOTONE):
            cut = low + _CUT * (high - low)
            value = value_at(w.f, size, cut)
            if half < _NARROWEST or not abs(value) > noise:
                return DOUBT
            n += 1
            w.stack[2 * n], w.stack[2 * n + 1] = cut, value
            continue
        if not same:
            if kind == FREE or count == MOST_ZEROS:
                return DOUBT
            w.places[count] = crossing(w.f, size, low, high, 1 if left > 0.0 else -1)
            count += 1
        low, left, n = high, right, n - 1
    for i in range(count):
        slope = value = 0.0
        for k in range(order - 1, -1, -1):
            slope, value = slope * w.places[i] + value, value * w.places[i] + f[LANES * k + lane]
        w.slopes[i] = slope
    return count
