"""All zeros of xdot on a step: isolated on its polynomial in double, polished in digits.

An interval is settled if the polynomial about its middle cannot vanish on it, or is monotone there, or bends one
way (a dip: the close pair near the north-south passage); else it is halved. Where a sign hangs on the last bits of
a double, the digits decide; the sign at a step's end is that of the next step's start, so that no zero on the edge
is lost or taken twice.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .dense_output import evaluate, shift_part, slope
from .lanes import LANES, compiled, load, store
from .limb import DIGIT_BITS, DOUBLED, INVERSE, Array, carry_scalar
from .series import PULL, VM, VX, Counts, Line, M, Series, X, expand, room
from .step import Model, leading

FOUND = 24  # zeros of one step at most
GRAZING = -1  # instead of a number of zeros: xdot touches zero, or all but does
ROUNDING = 2.0**-46  # of a polynomial evaluated in double, against the sum of its coefficients
SHALLOW = 2.0**-20  # a dip whose bottom is less than this of the polynomial is solved as a parabola
NEGLIGIBLE = 2.0**-60  # two coefficients in a row that are smaller, against the largest, end a polynomial in double
NOISE_BITS = 12  # digits' last bits that say nothing about a sign
NARROWEST = 2.0**-40
HALVINGS = 60
POLISHINGS = 30
NEAR_BITS = 46
NEAR = 2.0**-NEAR_BITS  # of a step: a guess in double is not off by more, but for zeros that all but meet
DERIVATIVE_BITS = 44  # of the slope that Newton's rule divides by
EDGE = 2.0**-30  # how far beyond its interval a zero may come out

FREE, MONOTONE, BENT, MIXED = range(4)


class Search(NamedTuple):
    """Room to look for zeros in; of those found an interval each, a guess, the sign of the crossing."""

    f: Array
    g: Array
    stack: Array
    low: Array
    high: Array
    guess: Array
    way: Counts
    place: Array
    aside: Array
    near: Series


def search_room(order: int, limbs: int) -> Search:
    """For series of an order."""
    return Search(
        f=np.zeros(order + 2),
        g=np.zeros(order + 2),
        stack=np.zeros(4 * 256),
        low=np.zeros(FOUND),
        high=np.zeros(FOUND),
        guess=np.zeros(FOUND),
        way=np.zeros(FOUND, dtype=np.int64),
        place=np.zeros(limbs + 2),
        aside=np.zeros(limbs + 2),
        near=room(near_order(limbs), limbs),
    )


@compiled
def near_order(limbs: int) -> int:
    """Of a series that is used no further than NEAR."""
    return DIGIT_BITS * limbs // NEAR_BITS + 1


@compiled
def sign_of(digits: Array, limbs: int) -> int:
    """The sign of carried digits."""
    for q in range(limbs):
        if digits[q] != 0.0:
            return 1 if digits[q] > 0.0 else -1
    return 0


@compiled
def value_of(digits: Array, limbs: int) -> float:
    """Carried digits as about the nearest double."""
    value = 0.0
    for q in range(limbs - 1, -1, -1):
        value = (value + digits[q]) * INVERSE
    return DOUBLED * value


@compiled
def sign_now(now: Array, turn: Array, s: Series, limbs: int) -> int:
    """The sign of xdot = Vx + ω m for a state; `turn` as in the model's line, not doubled."""
    for r in range(limbs):
        s.scalar[r] = now[LANES * r + VX]
    s.scalar[limbs] = 0.0
    for p in range(limbs):
        factor = DOUBLED * turn[LANES * p]
        for q in range(limbs - p):
            s.scalar[p + q + 1] += factor * now[LANES * q + M]
    carry_scalar(s.scalar, limbs)
    return sign_of(s.scalar, limbs)


@compiled
def sign_leaving(s: Series, multiplicity: int, limbs: int) -> int:
    """The sign of xdot just after a release at which it vanishes so many times over."""
    block = (multiplicity + 1) * limbs * LANES
    for q in range(limbs):
        digit = s.c[block + LANES * q + X]
        if digit != 0.0:
            return 1 if digit > 0.0 else -1
    return 0


@compiled
def xdot_at(z: Search, s: Series, line: Line, rows: Array, model: Model) -> float:
    """Xdot times h at the place in `z`, as a double with the digits' sign; all lanes in `rows`."""
    evaluate(rows, s, z.place, model.order, model.limbs)
    slope(s, line, rows, model.limbs)
    return value_of(s.scalar, model.limbs)


@compiled
def xddot_at(rows: Array, speed: float, line: Line, model: Model) -> float:
    """Xddot times h² from all lanes, as a double."""
    limbs = model.limbs
    turn = leading(line.turn, 0, 0, limbs) / DOUBLED
    x, across, pull = leading(rows, 0, X, limbs), leading(rows, 0, VM, limbs), leading(rows, 0, PULL, limbs)
    value = turn * (2.0 * across - turn * x) - pull * x
    if model.drag:
        value += leading(line.drag, 0, VX, limbs) / DOUBLED * speed
    return value


@compiled
def _put(place: Array, value: float, limbs: int) -> None:
    place[:] = 0.0
    shift_part(place, value, limbs)


@compiled
def _shifted(z: Search, size: int, low: float, high: float) -> None:
    """The polynomial in u, -1 <= u <= 1 from `low` to `high`."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    f, g = z.f, z.g
    for k in range(size):
        g[k] = f[k]
    for i in range(size - 1):
        for k in range(size - 2, i - 1, -1):
            g[k] += middle * g[k + 1]
    power = 1.0
    for k in range(size):
        g[k] *= power
        power *= half


@compiled
def _look(f: Array, size: int, middle: float, half: float, noise: float) -> tuple[int, float, float]:
    """What the polynomial can do within `half` of the middle; there its value and half its second derivative."""
    high = middle + half
    value = slope = bend = 0.0
    total = slopes = bends = rest = 0.0  # the same of the coefficients' sizes at the upper end, to the third derivative
    for k in range(size - 1, -1, -1):
        bend, slope, value = bend * middle + slope, slope * middle + value, value * middle + f[k]
        rest, bends, slopes = rest * high + bends, bends * high + slopes, slopes * high + total
        total = total * high + abs(f[k])
    rest *= half
    kind = MIXED
    if abs(value) > half * (abs(slope) + half * (abs(bend) + rest)) + noise:
        kind = FREE
    elif abs(slope) > half * (2.0 * abs(bend) + 3.0 * rest) + size * noise:
        kind = MONOTONE
    elif abs(bend) > 3.0 * rest + size * size * noise:
        kind = BENT
    return kind, value, bend


@compiled
def _value(g: Array, size: int, u: float) -> float:
    value = 0.0
    for k in range(size - 1, -1, -1):
        value = value * u + g[k]
    return value


@compiled
def _slope(g: Array, size: int, u: float) -> float:
    value = 0.0
    for k in range(size - 1, 0, -1):
        value = value * u + k * g[k]
    return value


@compiled
def _crossing(g: Array, size: int, low: float, high: float, before: int) -> float:
    """Where the polynomial changes sign between `low` and `high`, by Newton's rule kept inside by halving."""
    u = 0.5 * (low + high)
    for _ in range(HALVINGS):
        value = rate = 0.0
        for k in range(size - 1, -1, -1):
            rate, value = rate * u + value, value * u + g[k]
        if (value > 0.0) == (before > 0):
            low = u
        else:
            high = u
        new = u - value / rate if rate != 0.0 else u
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - u) < 2.0**-52:
            return new
        u = new
    return u


@compiled
def _flat(g: Array, size: int) -> float:
    """Where the slope of a polynomial that bends one way changes sign, or the end that is nearer to it."""
    low, high = -1.0, 1.0
    rising = _slope(g, size, 1.0) > 0.0
    for _ in range(HALVINGS):
        u = 0.5 * (low + high)
        if (_slope(g, size, u) > 0.0) == rising:
            high = u
        else:
            low = u
    return high


@compiled
def _note(z: Search, found: int, low: float, high: float, guess: float, way: int) -> int:
    z.low[found], z.high[found], z.guess[found], z.way[found] = low, high, guess, way
    return found + 1


@compiled
def _sign_at(z: Search, place: float, value: float, noise: float, s: Series, line: Line, rows: Array, m: Model) -> int:
    """The sign of xdot at a place where its value in double is known within the noise."""
    if abs(value) > noise:
        return 1 if value > 0.0 else -1
    _put(z.place, place, m.limbs)
    exact = xdot_at(z, s, line, rows, m)
    return 1 if exact >= 0.0 else -1


@compiled
def bracket_zeros(
    z: Search, s: Series, line: Line, rows: Array, before: int, after: int, multiplicity: int, model: Model
) -> int:
    """The zeros on 0 < s <= 1, in order, into `z`; how many, or GRAZING.

    Args:
        z: room.
        s: the step's series.
        line: its constants.
        rows: room.
        before: sign of xdot at the start, or just after it.
        after: sign at the end.
        multiplicity: how often over xdot vanishes at the start exactly.
        model: the scene.
    """
    size = _polynomial(z, s, multiplicity, model)
    total = 0.0
    for k in range(size):
        total += abs(z.f[k])
    noise, found, depth = ROUNDING * total, 0, 1
    z.stack[0], z.stack[1], z.stack[2], z.stack[3] = 0.0, 1.0, before, after
    while depth > 0:
        depth -= 1
        low, high = z.stack[4 * depth], z.stack[4 * depth + 1]
        left, right = int(z.stack[4 * depth + 2]), int(z.stack[4 * depth + 3])
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        kind, value, bend = _look(z.f, size, middle, half, noise)
        if kind == FREE and left == right:
            continue
        if kind == FREE or found + 2 > FOUND or left == 0 or right == 0:
            return GRAZING
        if kind == MIXED:
            if half < NARROWEST or depth + 2 > len(z.stack) // 4:
                return GRAZING
            between = _sign_at(z, middle, value, noise, s, line, rows, model)
            top = 4 * depth
            z.stack[top], z.stack[top + 1], z.stack[top + 2], z.stack[top + 3] = middle, high, between, right
            z.stack[top + 4], z.stack[top + 5], z.stack[top + 6], z.stack[top + 7] = low, middle, left, between
            depth += 2
        elif left != right:
            found = _note(z, found, low, high, _crossing(z.f, size, low, high, left), right)
        elif kind == BENT and (bend > 0.0) == (left > 0):
            _shifted(z, size, low, high)
            found = _dip(z, found, size, middle, half, left, noise, s, line, rows, model)
            if found == GRAZING:
                return GRAZING
    return found


@compiled
def _polynomial(z: Search, s: Series, multiplicity: int, model: Model) -> int:
    """Xdot / s**multiplicity in doubles, cut where it ends in double; returns its number of coefficients."""
    limbs, most, small = model.limbs, 0.0, 0
    for k in range(multiplicity, model.order):
        # a double holds three digits; those below make no difference to it
        value = (k + 1.0) * leading(s.c, (k + 1) * limbs * LANES, X, min(s.first[k + 1] + 4, limbs))
        z.f[k - multiplicity] = value
        most = max(most, abs(value))
        small = small + 1 if abs(value) < most * NEGLIGIBLE else 0
        if small == 2:
            return k - multiplicity - 1
    return model.order - multiplicity


@compiled
def _dip(
    z: Search,
    found: int,
    size: int,
    middle: float,
    half: float,
    side: int,
    noise: float,
    s: Series,
    line: Line,
    rows: Array,
    model: Model,
) -> int:
    """No zero or two where xdot has one sign at both ends and bends towards zero; the number so far, or GRAZING."""
    g = z.g
    u = _flat(g, size)
    bottom, total = _value(g, size, u), 0.0
    for k in range(size):
        total += abs(g[k])
    bend = 0.0
    for k in range(size - 1, 1, -1):
        bend = bend * u + k * (k - 1.0) * g[k]
    if abs(bottom) <= max(noise, SHALLOW * total):
        # in double the bottom of a shallow dip is noise: its place by Newton's rule for the slope, its value in digits
        _put(z.place, middle + half * u, model.limbs)
        for _ in range(POLISHINGS):
            bottom = xdot_at(z, s, line, rows, model)
            shift = -xddot_at(rows, bottom, line, model) / (bend / (half * half))
            if abs(shift) < 2.0**-50:
                break
            shift_part(z.place, shift, model.limbs)
        if abs(bottom) < 2.0 ** (NOISE_BITS - (DIGIT_BITS * model.limbs - 1)):
            return GRAZING
    if (bottom > 0.0) == (side > 0):
        return found
    low, flat, high = middle - half, middle + half * u, middle + half
    if abs(bottom) <= SHALLOW * total:
        aside = half * np.sqrt(abs(2.0 * bottom / bend))
        found = _note(z, found, low, flat + EDGE, flat - aside, -side)
        return _note(z, found, flat - EDGE, high, flat + aside, side)
    first, second = _crossing(g, size, -1.0, u, side), _crossing(g, size, u, 1.0, -side)
    found = _note(z, found, low, flat, middle + half * first, -side)
    return _note(z, found, flat, high, middle + half * second, side)


@compiled
def polish(z: Search, i: int, s: Series, line: Line, rows: Array, model: Model) -> bool:
    """The place of zero i in digits, and all lanes there in `rows`; False if Newton's rule leaves its interval.

    The guess is so good that a series about it needs few orders: the step's own is evaluated just once.
    """
    limbs, short, before = model.limbs, z.near, 1.0
    _put(z.place, z.guess[i], limbs)
    for _ in range(POLISHINGS):
        evaluate(rows, s, z.place, model.order, limbs)
        for r in range(limbs):
            store(short.c, LANES * r, load(rows, LANES * r))
        if not expand(short, line, near_order(limbs), limbs, model.drag):
            return False
        if not _settled(z, line, rows, model):
            return False
        for q in range(limbs):
            z.place[q] += z.aside[q]
        carry_scalar(z.place, limbs - 1)
        # where xdot is small beside the digits, their last bits keep the place from settling
        moved = abs(value_of(z.aside, limbs))
        settled, before = moved > 0.25 * before and before < EDGE, moved
        if settled and moved >= NEAR:
            evaluate(rows, s, z.place, model.order, limbs)
        if settled or moved < NEAR:
            place = value_of(z.place, limbs)
            return bool(z.low[i] - EDGE <= place <= z.high[i] + EDGE)
    return False


@compiled
def _settled(z: Search, line: Line, rows: Array, model: Model) -> bool:
    """Newton's rule on the short series, from where it begins: the place in `aside`, all lanes there in `rows`."""
    limbs, short, order = model.limbs, z.near, near_order(model.limbs)
    enough, before = 2.0 ** min(DERIVATIVE_BITS - (DIGIT_BITS * limbs - 1), -20), 1.0
    z.aside[:] = 0.0
    for _ in range(POLISHINGS):
        slope(short, line, rows, limbs)
        speed = value_of(short.scalar, limbs)
        rate = xddot_at(rows, speed, line, model)
        if rate == 0.0:
            return False
        shift = -speed / rate
        if not abs(shift) < 1.0:
            return False
        shift_part(z.aside, shift, limbs)
        evaluate(rows, short, z.aside, order, limbs)
        settled, before = abs(shift) > 0.25 * before and before < EDGE, abs(shift)
        if settled or abs(shift) < enough or not abs(value_of(z.aside, limbs)) < NEAR:
            return True
    return False
