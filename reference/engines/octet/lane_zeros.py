"""Zeros of a rate on a step, on all lanes at once: how many in each half of it is proven, then Newton's method.

A half is free of zeros if the rate's value in its middle outweighs slope, bend and the third derivative's bound; it is
monotone, with one zero if the signs at its ends differ, if the slope does. Lanes that are neither, or have two zeros,
go the long way: all zeros of one lane, by halving (`all_zeros`).

A highest point of the swing is a zero of u', found by signs at the ends and the middle of a step: between a highest and
a lowest point passes half a period of u, longer than half a step, so signs miss none.
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
    inlined,
    larger,
    load,
    magnitude,
    spread,
    store,
    where,
)
from ..simd.polynomial import FREE, MONOTONE, classify, crossing, value_and_slope
from .series import MOST_ORDER, LaneSeries

NOISE = 2.0**-44  # of the sum of a polynomial's terms: a smaller value is taken for rounding
NEWTON_STEPS = 3
CONVERGED = 2.0**-27  # of a step: a larger last correction leaves digits to be gained
# of a step: a zero of u' is so nearly symmetric that the next correction would be none
TURNED = 2.0**-20
MOST_ZEROS = 16  # of one step
DOUBT = -1  # returned where a sign is lost in rounding
_CUT = 0.4871  # of an interval: no special place, where symmetry could put a zero
_NARROWEST = 2.0**-40
_DEEPEST = 64  # halves of a step, one in another, down to the narrowest


class LaneZeros(NamedTuple):
    """Knowledge of a rate's zeros, lane by lane.

    Attributes:
        before, after: the rate at the step's start and end; the former's sign alone counts.
        sought: 1 where zeros are looked for.
        hit: 1 where there is exactly one zero.
        doubt: 1 where the lanes cannot tell.
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


@compiled
def seek(z: LaneZeros, f: Array, length: Array, time: Array, order: int) -> None:
    """Find which lanes have one zero of the polynomial f on the step, and where about; at time 0 all are in doubt."""
    r, zero = load(length, 0), spread(0.0)
    h, middle = r * spread(0.25), r * spread(0.5)
    high = middle + h
    v = s = b = v3 = s3 = b3 = vm = total = third = zero
    for k in range(order - 1, -1, -1):
        a = load(f, LANES * k)
        b, s, v = fma(s, b, h), fma(v, s, h), fma(a, v, h)
        b3, s3, v3 = fma(s3, b3, high), fma(v3, s3, high), fma(a, v3, high)
        vm, size = fma(a, vm, middle), magnitude(a)
        total = fma(size, total, r)
        if k >= 3:
            third = fma(size * spread(k * (k - 1) * (k - 2) / 6.0), third, r)
    noise, third = total * spread(NOISE), third * h
    slack = noise * spread(float(order))
    known = _known(v, s, b, third, h, noise, slack) * _known(v3, s3, b3, third, h, noise, slack)
    before, after = load(z.before, 0), load(z.after, 0)
    known = known * at_least(magnitude(vm), noise) * at_least(magnitude(after), noise)
    early, late = at_least(zero, before * vm), at_least(zero, vm * after)
    known = known * (spread(1.0) - early * late) * (spread(1.0) - at_least(zero, load(time, 0)))
    low, top = keep(z, early, late, known, known, r)
    s = where(late, s3, s)
    step = where(late, v3, v) / s
    place = where(late, high, h) - fma(step, where(late, b3, b) / s * step, step)
    store(z.place, 0, _between(place, low, top))


@inlined
def keep(z: LaneZeros, early: Any, late: Any, sure: Any, known: Any, r: Any) -> tuple[Any, Any]:
    """Keep which lanes have a zero, if they are sure of it, and which are in doubt; return the half that holds it."""
    sought, middle = load(z.sought, 0), r * spread(0.5)
    low, high = where(late, middle, spread(0.0)), where(late, r, middle)
    store(z.doubt, 0, (spread(1.0) - known) * sought)
    store(z.hit, 0, (early + late) * sure * sought)
    store(z.low, 0, low)
    store(z.high, 0, high)
    return low, high


@inlined
def _known(v: Any, s: Any, b: Any, third: Any, h: Any, noise: Any, slack: Any) -> Any:
    """Return 1 where a polynomial has no zero within h of a place, or is monotone there, else 0."""
    slope, bend = magnitude(s) * h, fma(magnitude(b), third, spread(1.0)) * h * h
    free = at_least(magnitude(v), slope + bend + noise)
    return larger(free, at_least(slope, fma(bend + bend, third * h, h) + slack))


@inlined
def _between(place: Any, low: Any, high: Any) -> Any:
    """Return a place moved into its interval; its low end where it is not a number."""
    zero = spread(0.0)
    return zero - larger(zero - larger(place, low), zero - high)


@compiled
def refine(z: LaneZeros, f: Array, length: Array, order: int, converged: float) -> None:
    """Refine the zeros that were found; those whose last correction is large are in doubt."""
    low, high, place, zero = load(z.low, 0), load(z.high, 0), load(z.place, 0), spread(0.0)
    moved = slope = zero
    for _ in range(NEWTON_STEPS):
        # even and odd powers apart: half the chain of dependent operations
        even = even_slope = odd = odd_slope = zero
        square = place * place
        for k in range(order - 2, -1, -2):
            even_slope, even = fma(even, even_slope, square), fma(load(f, LANES * k), even, square)
            at = LANES * (k + 1)
            odd_slope, odd = fma(odd, odd_slope, square), fma(load(f, at), odd, square)
        slope = fma(odd, fma(even_slope, odd_slope, place), place + place)
        new = _between(place - fma(even, odd, place) / slope, low, high)
        moved, place = magnitude(new - place), new
    hit = load(z.hit, 0)
    good = at_least(load(length, 0) * spread(converged), moved) * hit
    store(z.doubt, 0, larger(load(z.doubt, 0), hit - good))
    store(z.hit, 0, good)
    store(z.place, 0, place)
    store(z.slope, 0, slope)


@compiled
def seek_highest(z: LaneZeros, g: Array, length: Array, order: int) -> None:
    """Find which lanes have a highest point on the step; `doubt` is where a sign is lost in rounding."""
    r, zero, one = load(length, 0), spread(0.0), spread(1.0)
    middle = r * spread(0.5)
    vm = total = zero
    for k in range(order - 1, -1, -1):
        a = load(g, LANES * k)
        vm, total = fma(a, vm, middle), fma(magnitude(a), total, r)
    noise, before, after = total * spread(NOISE), load(z.before, 0), load(z.after, 0)
    rising, high = at_least(before, zero), at_least(vm, zero)
    known = at_least(magnitude(vm), noise) * at_least(magnitude(after), noise)
    late = high * (one - at_least(after, zero))
    low, top = keep(z, rising * (one - high), late, one, known, r)
    left, right = where(late, vm, before), where(late, after, vm)
    store(z.place, 0, fma(low, top - low, left / (left - right)))


@compiled
def place_highest(top: Array, c: LaneSeries, z: LaneZeros, order: int) -> None:
    """Write x, p and u at the place of each lane, a row of eight each."""
    place = load(z.place, 0)
    x = p = u = spread(0.0)
    for k in range(order, -1, -1):
        at = LANES * k
        x, p, u = (
            fma(load(c.x, at), x, place),
            fma(load(c.p, at), p, place),
            fma(load(c.u, at), u, place),
        )
    store(top, 0, x)
    store(top, LANES, p)
    store(top, 2 * LANES, u)


class Bisection(NamedTuple):
    """Working arrays: the polynomial, the ends of intervals still to be examined, the zeros and the slopes there."""

    f: Array
    stack: Array
    places: Array
    slopes: Array


def empty_bisection() -> Bisection:
    """Return working arrays."""
    return Bisection(
        np.zeros(MOST_ORDER + 1), np.zeros(2 * _DEEPEST), np.zeros(MOST_ZEROS), np.zeros(MOST_ZEROS)
    )


@compiled
def all_zeros(
    w: Bisection, z: LaneZeros, f: Array, lane: int, length: float, multiplicity: int, order: int
) -> int:
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
    right = value_and_slope(w.f, size, length)[0]
    # the polynomial is cut off: the state's own value has to be on the same side
    if abs(left) <= noise or abs(right) <= noise or (right > 0.0) != (z.after[lane] > 0.0):
        return DOUBT
    # the stack holds the intervals' ends, and the values there: the next interval's on top
    low, n = 0.0, 0
    w.stack[0], w.stack[1] = length, right
    while n >= 0:
        high, right = w.stack[2 * n], w.stack[2 * n + 1]
        half, same = 0.5 * (high - low), (left > 0.0) == (right > 0.0)
        kind = classify(w.f, size, low + half, half, noise)[0]
        if kind not in (FREE, MONOTONE):
            cut = low + _CUT * (high - low)
            value = value_and_slope(w.f, size, cut)[0]
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
