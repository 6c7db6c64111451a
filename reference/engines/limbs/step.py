"""One step: constants for its length, coefficients of order 0, how far the series reaches, the state at its end.

Lengths are whole multiples m of a grain, a power of two in s; a step of GRAINS of them is the unit of time in
which velocities are kept between steps. So times are exact, and a change of m costs a multiplication by m.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .lanes import LANES, at_least, compiled, load, plus_product, shuffled, spread, store
from .limb import DIGIT_BITS, DOUBLED, INVERSE, RADIX, UNIT, Array, carry, carry_scalar, clear, divide
from .series import PULL, SPIN, Line, Series

GRAINS = 1024
MOST_GRAINS = 4 * GRAINS
SHIFT = RADIX / GRAINS  # times m, and one digit down: a multiplication by m / GRAINS
SLIP = 0.9  # a series that reaches this part of its step is used to its end all the same; its order is chosen so
AIM = 0.98  # of the length that the last coefficients promise
RESOLVED = 4.0  # last digits from which on a coefficient's size is believed
LEAST, MOST = 0.94, 1.03  # a step is not changed while the wanted one is within these parts of it

_swapped_halves = shuffled((3, 4, 5, 0, 1, 2, -1, -1), "_swapped_halves")
_positions = shuffled((0, 1, 2, -1, -1, -1, -1, -1), "_positions")
_speeds = shuffled((-1, -1, -1, 3, 4, 5, -1, -1), "_speeds")
_aside = shuffled((-1, -1, -1, -1, 1, 2, -1, -1), "_aside")
_across = shuffled((4, 3, -1, -1, -1, -1, -1, -1), "_across")


class Model(NamedTuple):
    """A scene in digits, in the unit of time.

    Attributes:
        limbs, order: of the series.
        drag: whether there is any.
        tolerance: the size of coefficients at which a series ends.
        most: longest step in grains.
        line: the constants at m = GRAINS, in limbs + 1 rows, not doubled.
        powers: of m in them, lane by lane: one array of eight for each array of `line`.
        along, across: lane by lane the matrix from these axes to east, north, up, for `dense_output.finish`.
    """

    limbs: int
    order: int
    drag: bool
    tolerance: float
    most: int
    line: Line
    powers: Line
    along: Array
    across: Array


@compiled
def scale_line(to: Line, model: Model, m: int) -> None:
    """The constants for a step of m grains."""
    _scale(to.turn, model.line.turn, model.powers.turn, m, model.limbs, DOUBLED)
    _scale(to.steady, model.line.steady, model.powers.steady, m, model.limbs, 1.0)
    if model.drag:
        _scale(to.drag, model.line.drag, model.powers.drag, m, model.limbs, DOUBLED)
        _scale(to.drag_pull, model.line.drag_pull, model.powers.drag_pull, m, model.limbs, DOUBLED)
        _scale(to.drag_axial, model.line.drag_axial, model.powers.drag_axial, m, model.limbs, DOUBLED)


@compiled
def _scale(to: Array, given: Array, powers: Array, m: int, limbs: int, factor: float) -> None:
    for r in range(limbs + 1):
        store(to, LANES * r, load(given, LANES * r))
    for power in range(1, 4):
        _multiply(to, powers, power, m, limbs)
    for r in range(limbs + 1):
        store(to, LANES * r, load(to, LANES * r) * spread(factor))


@compiled
def _multiply(rows: Array, powers: Array, power: int, m: int, limbs: int) -> None:
    """Lanes with at least this power of m times m / GRAINS; the rest stays."""
    f = spread(SHIFT * GRAINS) + at_least(load(powers, 0), spread(power - 0.5)) * spread(SHIFT * (m - GRAINS))
    for r in range(limbs, -1, -1):
        store(rows, LANES * (r + 1), load(rows, LANES * r) * f)
    store(rows, 0, spread(0.0))
    carry(rows, 0, limbs + 1)


@compiled
def lanewise(to: Array, a: Array, b: Array, limbs: int) -> None:
    """Rows 0 … limbs of the product of two numbers in each lane, not carried."""
    for r in range(limbs + 1):
        total = spread(0.0)
        for q in range(r):
            total = plus_product(total, load(a, LANES * (r - 1 - q)), load(b, LANES * q))
        store(to, LANES * r, total * spread(DOUBLED))


@compiled
def begin(s: Series, line: Line, now: Array, m: int, limbs: int) -> None:
    """Coefficients of order 0 from the state: n, h V, the pull λ = V·V + n·A and j."""
    speed = spread(SHIFT * m)
    clear(s.total, limbs + 1)
    for r in range(limbs):
        store(s.total, LANES * (r + 1), _speeds(load(now, LANES * r)) * speed)
    carry(s.total, 0, limbs)
    for r in range(limbs):
        store(s.c, LANES * r, _positions(load(now, LANES * r)) + load(s.total, LANES * r))
        store(s.partners, LANES * r, _aside(load(s.c, LANES * r)))
        store(s.other, LANES * r, _across(load(s.c, LANES * r)))
    lanewise(s.total, line.steady, s.partners, limbs)
    for r in range(limbs + 1):
        s.scalar[r] = s.total[LANES * r + 4] + s.total[LANES * r + 5]
    lanewise(s.total, s.c, s.c, limbs)
    for r in range(limbs + 1):
        at = LANES * r
        s.scalar[r] += s.total[at + 3] + s.total[at + 4] + s.total[at + 5]
    _enter_scalar(s, PULL, limbs)
    lanewise(s.total, s.c, s.other, limbs)
    for r in range(limbs + 1):
        s.scalar[r] = s.total[LANES * r] - s.total[LANES * r + 1]
    _enter_scalar(s, SPIN, limbs)


@compiled
def _enter_scalar(s: Series, lane: int, limbs: int) -> None:
    """Carry the digits in `scalar` and make them a lane of order 0."""
    carry_scalar(s.scalar, limbs)
    for r in range(limbs):
        s.c[LANES * r + lane] = s.scalar[r]


@compiled
def leading(rows: Array, start: int, lane: int, limbs: int) -> float:
    """A number as the nearest double, about."""
    value = 0.0
    for q in range(limbs - 1, -1, -1):
        value = (value + rows[start + LANES * q + lane]) * INVERSE
    return DOUBLED * value


@compiled
def reach(s: Series, order: int, limbs: int, tolerance: float) -> float:
    """The part of the step at which the last coefficients of n and V are as small as the tolerance.

    It is told from the last two that have digits enough, and the geometric fall of those before them.
    """
    least, seen, k = 2.0, 0, order
    resolved, wanted = RESOLVED * 2.0 ** (1 - DIGIT_BITS * limbs), tolerance ** (1.0 / order)
    while seen < 2 and 2 * k > order:
        size = 0.0
        for lane in range(6):
            size = max(size, abs(leading(s.c, k * limbs * LANES, lane, limbs)))
        if size >= resolved:
            least = min(least, wanted * size ** (-1.0 / k))
            seen += 1
        k -= 1
    return least


@compiled
def next_length(m: int, part: float, most: int) -> int:
    """The next step in grains."""
    wanted = m * part * AIM
    if m * LEAST <= wanted <= m * MOST:
        return min(m, most)
    return max(1, min(int(wanted), 2 * m, most))


@compiled
def end(to: Array, s: Series, order: int, limbs: int) -> None:
    """The sum of all coefficients: everything at the step's end."""
    clear(to, limbs + 1)
    for k in range(order, -1, -1):
        for r in range(s.first[k], limbs):
            store(to, LANES * r, load(to, LANES * r) + load(s.c, LANES * (k * limbs + r)))
    carry(to, 0, limbs - 1)


@compiled
def settle(now: Array, rows: Array, s: Series, m: int, limbs: int) -> None:
    """The state from the rows at a step's end: velocity in the unit of time, and back on the sphere."""
    for r in range(limbs):
        store(s.total, LANES * r, _speeds(load(rows, LANES * r)) * spread(GRAINS))
    store(s.total, LANES * limbs, spread(0.0))
    divide(s.total, 0, limbs, m)
    carry(s.total, 0, limbs)
    for r in range(limbs):
        store(now, LANES * r, _positions(load(rows, LANES * r)) + load(s.total, LANES * r))
    lanewise(s.total, now, now, limbs)
    too_long = _excess(s, limbs, UNIT)
    for r in range(limbs):
        store(s.partners, LANES * r, _swapped_halves(load(now, LANES * r)))
    lanewise(s.total, now, s.partners, limbs)
    outwards = _excess(s, limbs, 0.0)
    last = LANES * (limbs - 1)
    for lane in range(3):
        n = leading(now, 0, lane, limbs)
        now[last + lane] -= np.rint(0.5 * too_long * n)
        now[last + lane + 3] -= np.rint(outwards * n)
    carry(now, 0, limbs - 1)


@compiled
def _excess(s: Series, limbs: int, unit: float) -> float:
    """The sum of the first three lanes of `total` less a unit in the first digit, in units of the last digit."""
    for r in range(limbs + 1):
        at = LANES * r
        s.scalar[r] = s.total[at] + s.total[at + 1] + s.total[at + 2]
    s.scalar[0] -= unit
    carry_scalar(s.scalar, limbs)
    value = 0.0
    for r in range(limbs):
        value = value * RADIX + s.scalar[r]
    return float(value + s.scalar[limbs] * INVERSE)
