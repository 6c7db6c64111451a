"""The zeros of xdot on a step: each bracketed in double precision, signs decided in limbs; then refined in limbs.

An interval needs no further cut if the polynomial about its middle cannot vanish on it, is monotone
there, or is convex or concave (a dip: the close pair near the north-south passage); otherwise it is
halved. Where a sign depends on the last bits of a double, the limbs decide. The sign at a step's
end is that of the next step's start, so that no zero at the edge is lost or counted twice.
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
# of a polynomial evaluated in double, against the sum of its coefficients' sizes
_ROUNDING = 2.0**-46
# a dip whose bottom is less than this many times that rounding is solved as a parabola
_SHALLOW = 2.0**26
# the series is cut where two coefficients in a row are smaller, against the largest
_NEGLIGIBLE = 2.0**-60
# last bits of a number in limbs that rounding may have spoilt: they do not decide a sign
_NOISE_BITS = 12
_NARROWEST = 2.0**-40  # half of the shortest interval that is cut
_DEEPEST = 256  # intervals, one in another, down to the narrowest
_NEWTON_STEPS = 30
_DERIVATIVE_BITS = 44  # correct bits of the derivative, a double, that Newton's method divides by
# of a step: after a smaller correction the next is smaller by the bits of the derivative
_NEAR_BITS = 46
_EDGE = 2.0**-30  # of a step: a zero may lie this far outside its interval


class Search(NamedTuple):
    """Working arrays for the zeros of a step.

    Attributes:
        f, slope: the coefficients of xdot in double, and those of its derivative.
        stack: intervals that are still to be examined, the next one on top: their ends, and the
            signs of xdot there.
        low, high, guess, direction: per zero its interval, its approximate place and the sign of
            its crossing.
        number: of zeros so far.
        place: limbs of a place in the step.
    """

    f: Array
    slope: Array
    stack: Array
    low: Array
    high: Array
    guess: Array
    direction: Counts
    number: Counts
    place: Array


def empty_search(order: int, limb_count: int) -> Search:
    """Return working arrays for a series of an order."""
    return Search(
        f=np.zeros(order + 2),
        slope=np.zeros(order + 2),
        stack=np.zeros(2 * _DEEPEST),
        low=np.zeros(MOST_ZEROS),
        high=np.zeros(MOST_ZEROS),
        guess=np.zeros(MOST_ZEROS),
        direction=np.zeros(MOST_ZEROS, dtype=np.int64),
        number=np.zeros(1, dtype=np.int64),
        place=np.zeros(limb_count + 2),
    )


class _Polynomial(NamedTuple):
    """A polynomial on the step, in double.

    Attributes:
        f: coefficients.
        size: how many of them count.
        noise: the rounding of its values, as an estimate.
    """

    f: Array
    size: int
    noise: float


class _Interval(NamedTuple):
    """An interval of the step, and the signs of xdot at its ends."""

    low: float
    high: float
    before: int
    after: int


@compiled
def bracket_zeros(
    z: Search, step: Step, before: int, after: int, multiplicity: int, model: LimbModel
) -> bool:
    """Bracket the zeros on 0 < s <= 1, in order; return false if a grazing zero cannot be resolved.

    Args:
        z: where the zeros are written.
        step: the step.
        before: sign of xdot at the start, or just after it.
        after: sign at the end.
        multiplicity: of the zero that xdot has exactly at the start; 0 if none.
        model: the scene.
    """
    z.number[0] = 0
    if before == 0 or after == 0:
        return False
    xdot = _polynomial(z, step.s, multiplicity, model)
    z.stack[0] = 1.0
    z.stack[1] = after
    depth = 1
    low = 0.0
    while depth > 0:
        high = z.stack[2 * depth - 2]
        after = int(z.stack[2 * depth - 1])
        middle = 0.5 * (low + high)
        half = 0.5 * (high - low)
        behaviour = classify(xdot.f, xdot.size, middle, half, xdot.noise)
        if behaviour.kind == UNDECIDED:
            if half < _NARROWEST or depth == _DEEPEST:
                return False
            z.stack[2 * depth] = middle
            z.stack[2 * depth + 1] = _sign_at(z, middle, behaviour.value, xdot.noise, step, model)
            depth += 1
            continue

        has_crossing = before != after
        if (behaviour.kind == FREE and has_crossing) or z.number[0] + 2 > MOST_ZEROS:
            return False
        if has_crossing:
            _record(z, low, high, crossing(xdot.f, xdot.size, low, high, before), after)
        bends_to_zero = behaviour.kind == CONVEX and (behaviour.bend > 0.0) == (before > 0)
        is_dip = bends_to_zero and not has_crossing
        if is_dip and not _dip(z, xdot, _Interval(low, high, before, after), step, model):
            return False
        low = high
        before = after
        depth -= 1
    return True


@compiled
def _polynomial(z: Search, s: LimbSeries, multiplicity: int, model: LimbModel) -> _Polynomial:
    """Return xdot / s**multiplicity in doubles, cut where the tail is negligible."""
    limb_count = model.limb_count
    size = model.order - multiplicity
    largest = 0.0
    small_in_a_row = 0
    for k in range(multiplicity, model.order):
        # a double holds three limbs; those below make no difference to it
        limbs = min(s.first[k + 1] + 4, limb_count)
        value = (k + 1.0) * double_of(s.c, limbs, (k + 1) * limb_count * LANES + X, LANES)
        z.f[k - multiplicity] = value
        largest = max(largest, abs(value))
        small_in_a_row = small_in_a_row + 1 if abs(value) < largest * _NEGLIGIBLE else 0
        if small_in_a_row == 2:
            size = k - multiplicity - 1
            break

    total = 0.0
    for k in range(size):
        total += abs(z.f[k])
    return _Polynomial(z.f, size, _ROUNDING * total)


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
def _record(z: Search, low: float, high: float, guess: float, direction: int) -> None:
    """Add a zero to those found so far."""
    n = z.number[0]
    z.low[n] = low
    z.high[n] = high
    z.guess[n] = guess
    z.direction[n] = direction
    z.number[0] = n + 1


@merged
def _dip(z: Search, xdot: _Polynomial, interval: _Interval, step: Step, model: LimbModel) -> bool:
    """Record no zero or two where xdot has one sign at both ends and bends towards zero.

    Returns false if its sign at the bottom of the dip is lost in rounding.
    """
    low = interval.low
    high = interval.high
    side = interval.before
    for k in range(xdot.size - 1):
        z.slope[k] = (k + 1.0) * xdot.f[k + 1]
    flat = crossing(z.slope, xdot.size - 1, low, high, -side)
    at_bottom = classify(xdot.f, xdot.size, flat, 0.0, xdot.noise)
    bottom = at_bottom.value
    is_shallow = abs(bottom) <= _SHALLOW * xdot.noise
    if is_shallow:
        # the bottom of a shallow dip is noise in double
        bottom = _bottom_in_limbs(z, flat, at_bottom.bend, step, model)
        if abs(bottom) < 2.0 ** (_NOISE_BITS - (LIMB_BITS * model.limb_count - 1)):
            return False

    if (bottom > 0.0) == (side > 0):
        return True
    if is_shallow:
        # the zeros of a parabola
        distance = np.sqrt(abs(bottom / at_bottom.bend))
        _record(z, low, flat + _EDGE, flat - distance, -side)
        _record(z, flat - _EDGE, high, flat + distance, side)
    else:
        _record(z, low, flat, crossing(xdot.f, xdot.size, low, flat, side), -side)
        _record(z, flat, high, crossing(xdot.f, xdot.size, flat, high, -side), side)
    return True


@merged
def _bottom_in_limbs(z: Search, flat: float, bend: float, step: Step, model: LimbModel) -> float:
    """Return xdot at the bottom of a dip, found in limbs by Newton's method on xddot from the place `flat`."""
    set_double(z.place, flat, model.limb_count)
    bottom = 0.0
    for _ in range(_NEWTON_STEPS):
        bottom = xdot_at(z.place, step, model)
        shift = -xddot_of(step, bottom, model) / (2.0 * bend)
        if abs(shift) < 2.0**-50:
            break
        add_double(z.place, shift, model.limb_count)
    return bottom


@compiled
def polish(z: Search, i: int, step: Step, model: LimbModel) -> bool:
    """Write the place of zero i to `place`, all lanes there to `rows`.

    False if Newton's method leaves its interval.
    """
    limb_count = model.limb_count
    enough = 2.0 ** min(_DERIVATIVE_BITS - (LIMB_BITS * limb_count - 1), -_NEAR_BITS)
    previous = 1.0
    set_double(z.place, z.guess[i], limb_count)
    for _ in range(_NEWTON_STEPS):
        xdot = xdot_at(z.place, step, model)
        xddot = xddot_of(step, xdot, model)
        shift = -xdot / xddot if xddot != 0.0 else 1.0
        if not abs(shift) < 1.0:
            return False
        add_double(z.place, shift, limb_count)
        # where xdot is small against its last limb, rounding ends convergence before the shift is
        # small enough
        has_stalled = abs(shift) > 0.25 * previous and previous < _EDGE
        previous = abs(shift)
        if has_stalled or abs(shift) < enough:
            evaluate(step.rows, step.s, z.place, model.order, limb_count)
            place = double_of(z.place, limb_count)
            return bool(z.low[i] - _EDGE <= place <= z.high[i] + _EDGE)
    return False
