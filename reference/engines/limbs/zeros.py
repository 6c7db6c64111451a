"""The zeros of xdot on a step: each bracketed in double precision, signs decided in limbs; then refined in limbs.

An interval needs no further cut if the polynomial about its middle cannot vanish on it, is monotone there, or is
convex or concave (a dip: the close pair near the north-south passage); else it is halved. Where a sign hangs on the
last bits of a double, the limbs decide; the sign at a step's end is that of the next step's start, so that no zero on
the edge is lost or counted twice.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .dense_output import evaluate, xddot_of, xdot_at, xdot_of
from .lanes import LANES, compiled, load, merged, store
from .limb import Array, add_double, carry_scalar, double_of, double_of_lane, set_double
from .polynomial import CONVEX, FREE, UNDECIDED, classify, crossing, extremum, recentre, value_at
from .recurrence import taylor_coefficients
from .series import Counts, LinearTerms, Series, X, empty_series
from .size import LIMB_BITS
from .step import Model

MOST_ZEROS = 24  # of one step
GRAZING = -1  # returned when a grazing zero cannot be resolved
ROUNDING = 2.0**-46  # of a polynomial evaluated in double, against the sum of its coefficients' sizes
SHALLOW = 2.0**-20  # a dip whose bottom is less than this of the polynomial is solved as a parabola
NEGLIGIBLE = 2.0**-60  # the series is cut where two coefficients in a row are smaller, against the largest
NOISE_BITS = 12  # last bits of a number in limbs that rounding may have spoilt: they do not decide a sign
NARROWEST = 2.0**-40  # half of the shortest interval that is cut
NEWTON_STEPS = 30
DERIVATIVE_BITS = 44  # correct bits of the derivative, a double, that Newton's method divides by
NEAR_BITS = 46
NEAR = 2.0**-NEAR_BITS  # of a step: the error of a guess in double, unless two zeros all but meet
EDGE = 2.0**-30  # of a step: a zero may lie this far outside its interval


class Search(NamedTuple):
    """Working arrays for the zeros of a step.

    Attributes:
        f: the coefficients of xdot in double.
        g: the same about the middle of an interval.
        stack: intervals that are still to be examined: ends, and the signs of xdot there.
        low, high, guess, direction: per zero its interval, its approximate place and the sign of its crossing.
        place, aside: limbs of a place in the step, and of the distance from the centre of `near`.
        near: the series about a guess.
    """

    f: Array
    g: Array
    stack: Array
    low: Array
    high: Array
    guess: Array
    direction: Counts
    place: Array
    aside: Array
    near: Series


def empty_search(order: int, limb_count: int) -> Search:
    """Return working arrays for a series of an order."""
    return Search(
        f=np.zeros(order + 2),
        g=np.zeros(order + 2),
        stack=np.zeros(4 * 256),
        low=np.zeros(MOST_ZEROS),
        high=np.zeros(MOST_ZEROS),
        guess=np.zeros(MOST_ZEROS),
        direction=np.zeros(MOST_ZEROS, dtype=np.int64),
        place=np.zeros(limb_count + 2),
        aside=np.zeros(limb_count + 2),
        near=empty_series(near_order(limb_count), limb_count),
    )


@compiled
def near_order(limb_count: int) -> int:
    """Return the order of a series that is used no further than NEAR."""
    return LIMB_BITS * limb_count // NEAR_BITS + 1


@compiled
def bracket_zeros(
    z: Search, s: Series, terms: LinearTerms, rows: Array, before: int, after: int, multiplicity: int, model: Model
) -> int:
    """Bracket the zeros on 0 < s <= 1, in order; return their number, or GRAZING.

    Args:
        z: where the zeros are written.
        s: the step's series.
        terms: the step's linear terms.
        rows: working array.
        before: sign of xdot at the start, or just after it.
        after: sign at the end.
        multiplicity: of the zero that xdot has exactly at the start; 0 if none.
        model: the scene.
    """
    size = _polynomial(z, s, multiplicity, model)
    total = 0.0
    for k in range(size):
        total += abs(z.f[k])
    noise, count, depth = ROUNDING * total, 0, 1
    z.stack[0], z.stack[1], z.stack[2], z.stack[3] = 0.0, 1.0, before, after
    while depth > 0:
        depth -= 1
        low, high = z.stack[4 * depth], z.stack[4 * depth + 1]
        left, right = int(z.stack[4 * depth + 2]), int(z.stack[4 * depth + 3])
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        kind, value, bend = classify(z.f, size, middle, half, noise)
        if kind == FREE and left == right:
            continue
        if kind == FREE or count + 2 > MOST_ZEROS or left == 0 or right == 0:
            return GRAZING
        if kind == UNDECIDED:
            if half < NARROWEST or depth + 2 > len(z.stack) // 4:
                return GRAZING
            between = _sign_at(z, middle, value, noise, s, terms, rows, model)
            top = 4 * depth
            z.stack[top], z.stack[top + 1], z.stack[top + 2], z.stack[top + 3] = middle, high, between, right
            z.stack[top + 4], z.stack[top + 5], z.stack[top + 6], z.stack[top + 7] = low, middle, left, between
            depth += 2
        elif left != right:
            count = _record(z, count, low, high, crossing(z.f, size, low, high, left), right)
        elif kind == CONVEX and (bend > 0.0) == (left > 0):
            recentre(z.g, z.f, size, low, high)
            count = _dip(z, count, size, middle, half, left, noise, s, terms, rows, model)
            if count == GRAZING:
                return GRAZING
    return count


@compiled
def _polynomial(z: Search, s: Series, multiplicity: int, model: Model) -> int:
    """Write xdot / s**multiplicity in doubles, cut where the tail is negligible; return the number of coefficients."""
    limb_count, largest, small = model.limb_count, 0.0, 0
    for k in range(multiplicity, model.order):
        # a double holds three limbs; those below make no difference to it
        value = (k + 1.0) * double_of_lane(s.c, (k + 1) * limb_count * LANES, X, min(s.first[k + 1] + 4, limb_count))
        z.f[k - multiplicity] = value
        largest = max(largest, abs(value))
        small = small + 1 if abs(value) < largest * NEGLIGIBLE else 0
        if small == 2:
            return k - multiplicity - 1
    return model.order - multiplicity


@merged
def _sign_at(
    z: Search, place: float, value: float, noise: float, s: Series, terms: LinearTerms, rows: Array, model: Model
) -> int:
    """Return the sign of xdot at a place where its value in double is known within the noise."""
    if abs(value) > noise:
        return 1 if value > 0.0 else -1
    set_double(z.place, place, model.limb_count)
    exact = xdot_at(z.place, s, terms, rows, model)
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
    middle: float,
    half: float,
    side: int,
    noise: float,
    s: Series,
    terms: LinearTerms,
    rows: Array,
    model: Model,
) -> int:
    """Record none or two zeros where xdot has one sign at both ends and bends towards zero.

    Returns the number of zeros so far, or GRAZING.
    """
    g = z.g
    u = extremum(g, size)
    bottom, total = value_at(g, size, u), 0.0
    for k in range(size):
        total += abs(g[k])
    bend = 0.0
    for k in range(size - 1, 1, -1):
        bend = bend * u + k * (k - 1.0) * g[k]
    if abs(bottom) <= max(noise, SHALLOW * total):
        # the bottom of a shallow dip is noise in double: Newton's method on xddot gives its place, limbs its value
        set_double(z.place, middle + half * u, model.limb_count)
        for _ in range(NEWTON_STEPS):
            bottom = xdot_at(z.place, s, terms, rows, model)
            shift = -xddot_of(rows, bottom, terms, model) / (bend / (half * half))
            if abs(shift) < 2.0**-50:
                break
            add_double(z.place, shift, model.limb_count)
        if abs(bottom) < 2.0 ** (NOISE_BITS - (LIMB_BITS * model.limb_count - 1)):
            return GRAZING
    if (bottom > 0.0) == (side > 0):
        return count
    low, flat, high = middle - half, middle + half * u, middle + half
    if abs(bottom) <= SHALLOW * total:
        aside = half * np.sqrt(abs(2.0 * bottom / bend))
        count = _record(z, count, low, flat + EDGE, flat - aside, -side)
        return _record(z, count, flat - EDGE, high, flat + aside, side)
    first, second = crossing(g, size, -1.0, u, side), crossing(g, size, u, 1.0, -side)
    count = _record(z, count, low, flat, middle + half * first, -side)
    return _record(z, count, flat, high, middle + half * second, side)


@merged
def polish(z: Search, i: int, s: Series, terms: LinearTerms, rows: Array, model: Model) -> bool:
    """Write the place of zero i to `place`, all lanes there to `rows`; false if Newton's method leaves its interval.

    The guess is so good that a series about it needs few orders: the step's own is evaluated just once.
    """
    limb_count, short, previous = model.limb_count, z.near, 1.0
    set_double(z.place, z.guess[i], limb_count)
    for _ in range(NEWTON_STEPS):
        evaluate(rows, s, z.place, model.order, limb_count)
        for r in range(limb_count):
            store(short.c, LANES * r, load(rows, LANES * r))
        if not taylor_coefficients(short, terms, near_order(limb_count), limb_count, model.drag):
            return False
        if not _newton(z, terms, rows, model):
            return False
        for q in range(limb_count):
            z.place[q] += z.aside[q]
        carry_scalar(z.place, limb_count - 1)
        # where xdot is small against its last limb, rounding ends convergence before the shift is small enough
        shift = abs(double_of(z.aside, limb_count))
        stalled, previous = shift > 0.25 * previous and previous < EDGE, shift
        if stalled and shift >= NEAR:
            evaluate(rows, s, z.place, model.order, limb_count)
        if stalled or shift < NEAR:
            place = double_of(z.place, limb_count)
            return bool(z.low[i] - EDGE <= place <= z.high[i] + EDGE)
    return False


@merged
def _newton(z: Search, terms: LinearTerms, rows: Array, model: Model) -> bool:
    """Apply Newton's method to the short series, from its centre: the place to `aside`, all lanes there to `rows`."""
    limb_count, short, order = model.limb_count, z.near, near_order(model.limb_count)
    enough, previous = 2.0 ** min(DERIVATIVE_BITS - (LIMB_BITS * limb_count - 1), -20), 1.0
    z.aside[:] = 0.0
    for _ in range(NEWTON_STEPS):
        xdot_of(rows, short, terms.turn, 1.0, limb_count)
        xdot = double_of(short.scalar, limb_count)
        xddot = xddot_of(rows, xdot, terms, model)
        if xddot == 0.0:
            return False
        shift = -xdot / xddot
        if not abs(shift) < 1.0:
            return False
        add_double(z.aside, shift, limb_count)
        evaluate(rows, short, z.aside, order, limb_count)
        stalled, previous = abs(shift) > 0.25 * previous and previous < EDGE, abs(shift)
        if stalled or abs(shift) < enough or not abs(double_of(z.aside, limb_count)) < NEAR:
            return True
    return False
