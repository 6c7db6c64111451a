"""Zeros of a rate on a step, on all lanes at once: each half of it has none or one, then Newton's method.

A half of the step has no zero if the rate at its middle is larger than slope, second derivative and
a bound of the third can change it. It is monotone, with one zero if the signs at its ends differ,
if the slope is larger than the higher derivatives can change it. A lane with a half of neither
kind, or with two zeros, is in doubt: all its zeros are found one by one, by subdivision
(`all_zeros`).

A highest point of the swing is a zero of u'. It is found by the signs at the ends and the middle of
a step: half a period of u passes between a highest and a lowest point, which is longer than half a
step, so that no sign is missed.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...numbers.precision import Array
from ..simd.lanes import (
    LANES,
    aligned,
    at_least,
    compiled,
    fma,
    get_row,
    inlined,
    larger,
    magnitude,
    set_row,
    spread,
    where,
)
from ..simd.polynomial import FREE, MONOTONE, classify, crossing, value_and_slope
from .series import MOST_ORDER, LaneSeries, Vector, plus_multiple, position

# thresholds of the last correction by Newton's method, of a step
CONVERGED = 2.0**-27  # after a larger one, another would change the digits
CONVERGED_HIGHEST = (
    2.0**-20
)  # u' is nearly antisymmetric about its zero: the next correction is far smaller
MOST_ZEROS = 16  # of one step
DOUBT = -1  # returned where a sign is lost in rounding
_NOISE = 2.0**-44  # of the sum of a polynomial's terms: a smaller value is taken for rounding
_NEWTON_STEPS = 3
_CUT = 0.4871  # of an interval: not in the middle, where symmetry could put a zero
_NARROWEST = 2.0**-40  # half of the shortest interval that is cut
_DEEPEST = 64  # intervals, one in another, down to the narrowest


class LaneZeros(NamedTuple):
    """Zeros of a rate on the steps of eight lanes: where they are sought, what is known of them.

    Attributes:
        before, after: the rate at the step's start and end; only the sign of `before` counts.
        sought: 1 where zeros are looked for.
        hit: 1 where there is exactly one zero.
        doubt: 1 where the number of zeros is undecided.
        low, high: the interval that holds the zero.
        place, slope: the zero, and the rate's derivative there.
    """

    before: Array
    after: Array
    sought: Array
    hit: Array
    doubt: Array
    low: Array
    high: Array
    place: Array
    slope: Array


def empty_zeros() -> LaneZeros:
    """Return lanes in which nothing is known."""
    return LaneZeros(*(aligned(LANES) for _ in LaneZeros._fields))


class _Jet(NamedTuple):
    """A polynomial at a place: value, slope and half the second derivative, in each lane."""

    value: Any
    slope: Any
    bend: Any


class _Bounds(NamedTuple):
    """Bounds on the whole step, in each lane.

    Attributes:
        third: of a sixth of the third derivative, times a quarter of the step.
        noise: of the rounding of a value, as an estimate; a smaller value has no certain sign.
        slope_noise: of the rounding of a slope, times a quarter of the step, as an estimate.
    """

    third: Any
    noise: Any
    slope_noise: Any


class _Halves(NamedTuple):
    """A polynomial on the two halves of a step: at their middles, and between them."""

    early: _Jet
    late: _Jet
    middle_value: Any
    bounds: _Bounds


@compiled
def seek(z: LaneZeros, f: Array, length: Array, time: Array, order: int) -> None:
    """Find which lanes have one zero of the polynomial f on the step, and about where.

    At time 0 all are in doubt.
    """
    # many names, as each is a quantity of one formula in each lane
    h = get_row(length, 0)
    zero = spread(0.0)
    halves = _halves(f, h, order)
    noise = halves.bounds.noise

    quarter = h * spread(0.25)
    decided = _is_decided(halves.early, halves.bounds, quarter)
    decided = decided * _is_decided(halves.late, halves.bounds, quarter)
    before = get_row(z.before, 0)
    after = get_row(z.after, 0)
    decided = decided * at_least(magnitude(halves.middle_value), noise)
    decided = decided * at_least(magnitude(after), noise)

    # 1 where the sign changes on the first and on the second half; if on both, the lane is in doubt
    early = at_least(zero, before * halves.middle_value)
    late = at_least(zero, halves.middle_value * after)
    decided = decided * (spread(1.0) - early * late)
    decided = decided * (spread(1.0) - at_least(zero, get_row(time, 0)))
    low, high = _keep(z, h, _Crossings(early, late, decided, decided))

    # one step of Chebyshev's method, from the middle of the half
    slope = where(late, halves.late.slope, halves.early.slope)
    bend = where(late, halves.late.bend, halves.early.bend)
    step = where(late, halves.late.value, halves.early.value) / slope
    start = where(late, h * spread(0.5) + quarter, quarter)
    place = start - fma(step, bend / slope * step, step)
    set_row(z.place, 0, _between(place, low, high))


@inlined
def _halves(f: Array, h: Any, order: int) -> _Halves:
    """Return the polynomial f at the middles of both halves of a step of length h, by Horner's rule."""
    zero = spread(0.0)
    middle = h * spread(0.5)
    early_place = h * spread(0.25)
    late_place = middle + early_place
    early = _Jet(zero, zero, zero)
    late = _Jet(zero, zero, zero)
    middle_value = zero
    total = zero  # of the terms' sizes at the end
    third = zero
    for k in range(order - 1, -1, -1):
        coefficient = get_row(f, k)
        size = magnitude(coefficient)
        early = _horner(early, coefficient, early_place)
        late = _horner(late, coefficient, late_place)
        middle_value = fma(coefficient, middle_value, middle)
        total = fma(size, total, h)
        if k >= 3:
            third = fma(size * spread(k * (k - 1) * (k - 2) / 6.0), third, h)

    noise = total * spread(_NOISE)
    bounds = _Bounds(third * early_place, noise, noise * spread(float(order)))
    return _Halves(early, late, middle_value, bounds)


@inlined
def _horner(jet: _Jet, coefficient: Any, place: Any) -> _Jet:
    """Return the jet at a place of s f(s) + coefficient, from that of f."""
    return _Jet(
        fma(coefficient, jet.value, place),
        fma(jet.value, jet.slope, place),
        fma(jet.slope, jet.bend, place),
    )


@inlined
def _is_decided(jet: _Jet, bounds: _Bounds, radius: Any) -> Any:
    """Return 1 where a polynomial has no zero within a radius of a place, or is monotone there, else 0."""
    slope = magnitude(jet.slope) * radius
    bend = fma(magnitude(jet.bend), bounds.third, spread(1.0)) * radius * radius
    is_free = at_least(magnitude(jet.value), slope + bend + bounds.noise)
    slope_change = fma(bend + bend, bounds.third * radius, radius)
    return larger(is_free, at_least(slope, slope_change + bounds.slope_noise))


class _Crossings(NamedTuple):
    """Where the sign changes on a step, 1 or 0 in each lane.

    Attributes:
        early, late: on its first and on its second half.
        single: if at all, by a single zero.
        decided: the signs are known, and with them the number of zeros.
    """

    early: Any
    late: Any
    single: Any
    decided: Any


@inlined
def _keep(z: LaneZeros, h: Any, crossings: _Crossings) -> tuple[Any, Any]:
    """Write which lanes of steps of length h have a zero, and which are in doubt.

    Return the half that holds it.
    """
    sought = get_row(z.sought, 0)
    middle = h * spread(0.5)
    low = where(crossings.late, middle, spread(0.0))
    high = where(crossings.late, h, middle)
    set_row(z.doubt, 0, (spread(1.0) - crossings.decided) * sought)
    set_row(z.hit, 0, (crossings.early + crossings.late) * crossings.single * sought)
    set_row(z.low, 0, low)
    set_row(z.high, 0, high)
    return low, high


@inlined
def _between(place: Any, low: Any, high: Any) -> Any:
    """Return a place moved into its interval; its low end where it is not a number."""
    zero = spread(0.0)
    return zero - larger(zero - larger(place, low), zero - high)


@compiled
def refine(z: LaneZeros, f: Array, length: Array, order: int, converged: float) -> None:
    """Refine the zeros that were found; those whose last correction is large are in doubt."""
    low = get_row(z.low, 0)
    high = get_row(z.high, 0)
    place = get_row(z.place, 0)
    correction = spread(0.0)
    slope = spread(0.0)
    for _ in range(_NEWTON_STEPS):
        value, slope = _value_and_slope(f, place, order)
        new = _between(place - value / slope, low, high)
        correction = magnitude(new - place)
        place = new

    hit = get_row(z.hit, 0)
    good = at_least(get_row(length, 0) * spread(converged), correction) * hit
    set_row(z.doubt, 0, larger(get_row(z.doubt, 0), hit - good))
    set_row(z.hit, 0, good)
    set_row(z.place, 0, place)
    set_row(z.slope, 0, slope)


@inlined
def _value_and_slope(f: Array, place: Any, order: int) -> tuple[Any, Any]:
    """Return the polynomial f and its derivative at a place of each lane.

    `order`, the number of terms, is even.
    """
    # even and odd powers are summed separately: this halves the chain of dependent operations
    even = spread(0.0)
    even_slope = spread(0.0)
    odd = spread(0.0)
    odd_slope = spread(0.0)
    square = place * place
    for k in range(order - 2, -1, -2):
        even_slope = fma(even, even_slope, square)
        even = fma(get_row(f, k), even, square)
        odd_slope = fma(odd, odd_slope, square)
        odd = fma(get_row(f, k + 1), odd, square)

    # f = even(s²) + s odd(s²)
    slope = fma(odd, fma(even_slope, odd_slope, place), place + place)
    return fma(even, odd, place), slope


@compiled
def seek_highest(z: LaneZeros, g: Array, length: Array, order: int) -> None:
    """Find which lanes have a highest point on the step.

    `doubt` is where a sign is lost in rounding.
    """
    # many names, as each is a quantity of one formula in each lane
    h = get_row(length, 0)
    zero = spread(0.0)
    one = spread(1.0)
    middle = h * spread(0.5)
    middle_value = zero
    total = zero
    for k in range(order - 1, -1, -1):
        coefficient = get_row(g, k)
        middle_value = fma(coefficient, middle_value, middle)
        total = fma(magnitude(coefficient), total, h)
    noise = total * spread(_NOISE)

    before = get_row(z.before, 0)
    after = get_row(z.after, 0)
    decided = at_least(magnitude(middle_value), noise) * at_least(magnitude(after), noise)
    rises_before = at_least(before, zero)
    rises_in_middle = at_least(middle_value, zero)
    early = rises_before * (one - rises_in_middle)
    late = rises_in_middle * (one - at_least(after, zero))
    low, high = _keep(z, h, _Crossings(early, late, one, decided))

    # where the chord crosses zero
    at_low = where(late, middle_value, before)
    at_high = where(late, after, middle_value)
    set_row(z.place, 0, fma(low, high - low, at_low / (at_low - at_high)))


@compiled
def place_highest(top: Array, c: LaneSeries, z: LaneZeros, order: int) -> None:
    """Write x, p and u at the place of each lane, a row of eight each."""
    place = get_row(z.place, 0)
    zero = spread(0.0)
    n = Vector(zero, zero, zero)
    for k in range(order, -1, -1):
        n = plus_multiple(position(c, k), place, n)
    set_row(top, 0, n.x)
    set_row(top, 1, n.p)
    set_row(top, 2, n.u)


class Bisection(NamedTuple):
    """Working arrays: the polynomial, the ends of intervals still to be examined, the zeros and the slopes there."""

    f: Array
    stack: Array
    places: Array
    slopes: Array


def empty_bisection() -> Bisection:
    """Return working arrays."""
    return Bisection(
        f=np.zeros(MOST_ORDER + 1),
        stack=np.zeros(2 * _DEEPEST),
        places=np.zeros(MOST_ZEROS),
        slopes=np.zeros(MOST_ZEROS),
    )


class LanePolynomial(NamedTuple):
    """The polynomial of one lane on its step.

    Attributes:
        f: coefficients of all lanes, rows of eight.
        lane: which of them.
        order: number of coefficients.
        length: of the step.
    """

    f: Array
    lane: int
    order: int
    length: float


@compiled
def all_zeros(w: Bisection, z: LaneZeros, polynomial: LanePolynomial, multiplicity: int) -> int:
    """Write the zeros on 0 < s <= length, in order; return their number, or DOUBT.

    Args:
        w: where they are written.
        z: the values at the start, whose sign counts, and at the end.
        polynomial: whose zeros.
        multiplicity: of a zero at the start that is exact; -1 where the start's value alone gives
            the sign.
    """
    lane = polynomial.lane
    skipped = max(multiplicity, 0)
    noise = _copy_polynomial(w, polynomial, skipped)
    size = polynomial.order - skipped
    before = z.before[lane] if multiplicity < 0 else w.f[0]
    after = value_and_slope(w.f, size, polynomial.length)[0]

    # the polynomial is cut off: the state's own value has to be on the same side
    is_same_side = (after > 0.0) == (z.after[lane] > 0.0)
    if abs(before) <= noise or abs(after) <= noise or not is_same_side:
        return DOUBT
    count = _isolate(w, size, noise, _LaneInterval(0.0, polynomial.length, before, after))
    for i in range(count):
        w.slopes[i] = _lane_slope(polynomial, w.places[i])
    return count


@compiled
def _copy_polynomial(w: Bisection, polynomial: LanePolynomial, skipped: int) -> float:
    """Copy the coefficients of one lane from order `skipped` on.

    Return the noise of the polynomial's values.
    """
    total = 0.0
    for k in range(polynomial.order - skipped - 1, -1, -1):
        w.f[k] = polynomial.f[LANES * (k + skipped) + polynomial.lane]
        total = total * polynomial.length + abs(w.f[k])
    return _NOISE * total


class _LaneInterval(NamedTuple):
    """An interval, and the polynomial's values at its ends."""

    low: float
    high: float
    before: float
    after: float


@compiled
def _isolate(w: Bisection, size: int, noise: float, whole: _LaneInterval) -> int:
    """Write the zeros of the polynomial `w.f` of `size` coefficients, in order.

    Return their number, or DOUBT.
    """
    # the stack holds upper ends of intervals, and the values there: the next interval's on top
    w.stack[0] = whole.high
    w.stack[1] = whole.after
    depth = 1
    low = whole.low
    before = whole.before
    count = 0
    while depth > 0:
        high = w.stack[2 * depth - 2]
        after = w.stack[2 * depth - 1]
        half = 0.5 * (high - low)
        kind = classify(w.f, size, low + half, half, noise).kind
        if kind not in (FREE, MONOTONE):
            cut = low + _CUT * (high - low)
            value = value_and_slope(w.f, size, cut)[0]
            if half < _NARROWEST or not abs(value) > noise:
                return DOUBT
            w.stack[2 * depth] = cut
            w.stack[2 * depth + 1] = value
            depth += 1
            continue

        if (before > 0.0) != (after > 0.0):
            if kind == FREE or count == MOST_ZEROS:
                return DOUBT
            w.places[count] = crossing(w.f, size, low, high, 1 if before > 0.0 else -1)
            count += 1
        low = high
        before = after
        depth -= 1
    return count


@compiled
def _lane_slope(polynomial: LanePolynomial, place: float) -> float:
    """Return the derivative of one lane's polynomial at a place."""
    value = 0.0
    slope = 0.0
    for k in range(polynomial.order - 1, -1, -1):
        slope = slope * place + value
        value = value * place + polynomial.f[LANES * k + polynomial.lane]
    return slope
