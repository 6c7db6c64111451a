"""All zeros of one lane's polynomial on a step, by halving: where the lanes at once cannot tell."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..limbs.lanes import LANES, compiled
from ..limbs.limb import Array
from ..limbs.polynomial import FREE, MONOTONE, classify, crossing, value_at
from .series import MOST_ORDER
from .zeros import NOISE

MOST_ZEROS = 16  # of one step
DOUBT = -1  # returned where a sign is lost in rounding
_CUT = 0.4871  # of an interval: no special place, where symmetry could put a zero
_NARROWEST = 2.0**-40
_DEEPEST = 128


class LongWay(NamedTuple):
    """Working arrays: the polynomial, intervals still to be examined, the zeros and the slopes there."""

    f: Array
    stack: Array
    places: Array
    slopes: Array


def empty_long_way() -> LongWay:
    """Return working arrays."""
    return LongWay(np.zeros(MOST_ORDER + 1), np.zeros(4 * _DEEPEST), np.zeros(MOST_ZEROS), np.zeros(MOST_ZEROS))


@compiled
def all_zeros(
    w: LongWay, f: Array, lane: int, length: float, before: float, after: float, multiplicity: int, order: int
) -> int:
    """Write the zeros on 0 < s <= length, in order; return their number, or DOUBT.

    Args:
        w: where they are written.
        f: the polynomials of all lanes.
        lane: which of them.
        length: of the step.
        before: the value at the start; its sign counts.
        after: the value at the end.
        multiplicity: of a zero at the start that is exact; -1 where the start's value alone gives the sign.
        order: number of coefficients.
    """
    skipped = max(multiplicity, 0)
    size, total, count, depth = order - skipped, 0.0, 0, 1
    for k in range(size):
        w.f[k] = f[LANES * (k + skipped) + lane]
    for k in range(size - 1, -1, -1):
        total = total * length + abs(w.f[k])
    noise = NOISE * total
    left = before if multiplicity < 0 else w.f[0]
    right = value_at(w.f, size, length)
    # the polynomial is cut off: the state's own value has to be on the same side
    if abs(left) <= noise or abs(right) <= noise or (right > 0.0) != (after > 0.0):
        return DOUBT
    w.stack[0], w.stack[1], w.stack[2], w.stack[3] = 0.0, length, left, right
    while depth > 0:
        depth -= 1
        low, high, left, right = (
            w.stack[4 * depth],
            w.stack[4 * depth + 1],
            w.stack[4 * depth + 2],
            w.stack[4 * depth + 3],
        )
        half = 0.5 * (high - low)
        kind = classify(w.f, size, low + half, half, noise)[0]
        same = (left > 0.0) == (right > 0.0)
        if kind in (FREE, MONOTONE):
            if kind == FREE and not same:
                return DOUBT
            if not same:
                if count == MOST_ZEROS:
                    return DOUBT
                w.places[count] = crossing(w.f, size, low, high, 1 if left > 0.0 else -1)
                count += 1
            continue
        cut = low + _CUT * (high - low)
        value = value_at(w.f, size, cut)
        if half < _NARROWEST or depth + 2 > _DEEPEST or not abs(value) > noise:
            return DOUBT
        top = 4 * depth
        w.stack[top], w.stack[top + 1], w.stack[top + 2], w.stack[top + 3] = cut, high, value, right
        w.stack[top + 4], w.stack[top + 5], w.stack[top + 6], w.stack[top + 7] = low, cut, left, value
        depth += 2
    for i in range(count):
        slope = value = 0.0
        for k in range(order - 1, -1, -1):
            slope, value = slope * w.places[i] + value, value * w.places[i] + f[LANES * k + lane]
        w.slopes[i] = slope
    return count
