"""The zeros of xdot on a step: each bracketed in double precision, signs decided in limbs; then refined in limbs.

An interval needs no further cut if the polynomial about its middle cannot vanish on it, is monotone there, or is
convex or concave (a dip: the close pair near the north-south passage); else it is halved. Where a sign hangs on the
last bits of a double, the limbs decide; the sign at a step's end is that of the next step's start, so that no zero on
the edge is lost or counted twice.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...numbers.precision import Array
from ..simd.lanes import LANES, compiled, merged
from ..simd.polynomial import CONVEX, FREE, UNDECIDED, classify, crossing
from .dense_output import evaluate, xddot_of, xdot_at
from .limb import add_double, double_of, set_double
from .series import Counts, LimbSeries, Step, X
from .size import LIMB_BITS
from .step import LimbModel

MOST_ZEROS = 24  # of one step
GRAZING = -1  # returned when a grazing zero cannot be resolved
# of a polynomial evaluated in double, against the sum of its coefficients' sizes
ROUNDING = 2.0**-46
# a dip whose bottom is less than this many times that rounding is solved as a parabola
SHALLOW = 2.0**26
# the series is cut where two coefficients in a row are smaller, against the largest
NEGLIGIBLE = 2.0**-60
# last bits of a number in limbs that rounding may have spoilt: they do not decide a sign
NOISE_BITS = 12
NARROWEST = 2.0**-40  # half of the shortest interval that is cut
DEEPEST = 256  # intervals, one in another, down to the narrowest
NEWTON_STEPS = 30
DERIVATIVE_BITS = 44  # correct bits of the derivative, a double, that Newton's method divides by
# of a step: after a smaller correction the next is smaller by the bits of the derivative
NEAR_BITS = 46
EDGE = 2.0**-30  # of a step: a zero may lie this far outside its interval


class Search(NamedTuple):
    """Working arrays for the zeros of a step.

    Attributes:
        f, slope: the coefficients of xdot in double, and those of its derivative.
        stack: intervals that are still to be examined, the next one on top: their ends, and the signs of xdot there.
        low, high, guess, direction: per zero its interval, its approximate place and the sign of its crossing.
        place: limbs of a place in the step.
    """

    f: Array
    slope: Array
    stack: Array
    low: Array
    high: Array
    guess: Array
    direction: Counts
    place: Array


def empty_search(order: int, limb_count: int) -> Search:
    """Return working arrays for a series of an order."""
    return Search(
        f=np.zeros(order + 2),
        slope=np.zeros(order + 2),
        stack=np.zeros(2 * DEEPEST),
        low=np.zeros(MOST_ZEROS),
        high=np.zeros(MOST_ZEROS),
        guess=np.zeros(MOST_ZEROS),
        direction=np.zeros(MOST_ZEROS, dtype=np.int64),
        place=np.zeros(limb_count + 2),
    )


@compiled
def bracket_zeros(
    z: Search, step: Step, before: int, after: int, multiplicity: int, model: LimbModel
) -> int:
    """Bracket the zeros on 0 < s <= 1, in order; return their number, or GRAZING.

    Args:
        z: where the zeros are written.
        step: the step.
        before: sign of xdot at the start, or just after it.
        after: sign at the end.
        multiplicity: of the zero that xdot has exactly at the start; 0 if none.
        model: the scene.
    """
    if before == 0 or after == 0:
        return GRAZING
    size = _polynomial(z, step.s, multiplicity, model)
    total = 0.0
    for k in range(size):
        total += abs(z.f[k])
    noise, count, depth = ROUNDING * total, 0, 1
    low, left = 0.0, before
    z.stack[0], z.stack[1] = 1.0, after
    while depth > 0:
        high, right = z.stack[2 * depth - 2], int(z.stack[2 * depth - 1])
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        kind, value, bend = classify(z.f, size, middle, half, noise)
        if kind == UNDECIDED:
            if half < NARROWEST or depth == DEEPEST:
                return GRAZING
            z.stack[2 * depth] = middle
            z.stack[2 * depth + 1] = _sign_at(z, middle, value, noise, step, model)
            depth += 1
            continue
        if (kind == FREE and left != right) or count + 2 > MOST_ZEROS:
            return GRAZING
        if left != right:
            count = _record(z, count, low, high, crossing(z.f, size, low, high, left), right)
        elif kind == CONVEX and (bend > 0.0) == (left > 0):
            count = _dip(z, count, size, low, high, left, noise, step, model)
            if count == GRAZING:
                return GRAZING
        low, left, depth = high, right, depth - 1
    return count


@compiled
def _polynomial(z: Search, s: LimbSeries, multiplicity: int, model: LimbModel) -> int:
    """Write xdot / s**multiplicity in doubles, cut where the tail is negligible; return the number of coefficients."""
    limb_count, largest, small = model.limb_count, 0.0, 0
    for k in range(multiplicity, model.order):
        # a double holds three limbs; those below make no difference to it
        limbs = min(s.first[k + 1] + 4, limb_count)
        value = (k + 1.0) * double_of(s.c, limbs, (k + 1) * limb_count * LANES + X, LANES)
        z.f[k - multiplicity] = value
        largest = max(largest, abs(value))
        small = small + 1 if abs(value) < largest * NEGLIGIBLE else 0
        if small == 2:
            return k - multiplicity - 1
    return model.order - multiplicity


@merged
def _sign_at(
    z: Search, place: float, value: float, noise: float, step: Step, model: LimbModel
) -> int:
    """Return the sign of xdot at a place where its value in double is known within the noise."""
    if abs(value) > noise:
        return 1 if value > 0.0 else -1
    set_double(z.place, place, model.limb_count)
    exact = xdot_at(z.place, step, model)
    return 1 if exact >= 0.0 else -1


@compiled
def _record(z: Search, count: int, low: float, high: float, guess: float, direction: int) -> int:
    z.low[count], z.high[count], z.guess[count], z.direction[count] = low, high, guess, direction
    return count + 1


@merged
def _dip(
    z: Search,
    count: int,
    size: int,
    low: float,
    high: float,
    side: int,
    noise: float,
    step: Step,
    model: LimbModel,
) -> int:
    """Record none or two zeros where xdot has one sign at both ends and bends towards zero.

    Returns the number of zeros so far, or GRAZING.
    """
    for k in range(size - 1):
        z.slope[k] = (k + 1.0) * z.f[k + 1]
    flat = crossing(z.slope, size - 1, low, high, -side)
    _, bottom, bend = classify(z.f, size, flat, 0.0, noise)
    shallow = abs(bottom) <= SHALLOW * noise
    if shallow:
        # the bottom of a shallow dip is noise in double: Newton's method on xddot gives its place, limbs its value
        set_double(z.place, flat, model.limb_count)
        for _ in range(NEWTON_STEPS):
            bottom = xdot_at(z.place, step, model)
            shift = -xddot_of(step, bottom, model) / (2.0 * bend)
            if abs(shift) < 2.0**-50:
                break
            add_double(z.place, shift, model.limb_count)
        if abs(bottom) < 2.0 ** (NOISE_BITS - (LIMB_BITS * model.limb_count - 1)):
            return GRAZING
    if (bottom > 0.0) == (side > 0):
        return count
    if shallow:
        aside = np.sqrt(abs(bottom / bend))
        count = _record(z, count, low, flat + EDGE, flat - aside, -side)
        return _record(z, count, flat - EDGE, high, flat + aside, side)
    count = _record(z, count, low, flat, crossing(z.f, size, low, flat, side), -side)
    return _record(z, count, flat, high, crossing(z.f, size, flat, high, -side), side)


@merged
def polish(z: Search, i: int, step: Step, model: LimbModel) -> bool:
    """Write the place of zero i to `place`, all lanes there to `rows`; false if Newton's method leaves its interval."""
    enough = 2.0 ** min(DERIVATIVE_BITS - (LIMB_BITS * model.limb_count - 1), -NEAR_BITS)
    previous = 1.0
    set_double(z.place, z.guess[i], model.limb_count)
    for _ in range(NEWTON_STEPS):
        xdot = xdot_at(z.place, step, model)
        xddot = xddot_of(step, xdot, model)
        shift = -xdot / xddot if xddot != 0.0 else 1.0
        if not abs(shift) < 1.0:
            return False
        add_double(z.place, shift, model.limb_count)
        # where xdot is small against its last limb, rounding ends convergence before the shift is small enough
        stalled, previous = abs(shift) > 0.25 * previous and previous < EDGE, abs(shift)
        if stalled or abs(shift) < enough:
            evaluate(step.rows, step.s, z.place, model.order, model.limb_count)
            place = double_of(z.place, model.limb_count)
            return bool(z.low[i] - EDGE <= place <= z.high[i] + EDGE)
    return False
