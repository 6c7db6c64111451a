"""The parts of one compiled Taylor step: constants, order 0, step size, sum of the series, projection onto the sphere.

Step lengths are integer multiples m of a grain, a power of two in s; a step of GRAINS grains is the
unit of time in which velocities are kept between steps. So times are exact, and a change of m costs
a multiplication by m.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...numbers.precision import Array
from ..simd.lanes import LANES, at_least, compiled, get_row, plus_product, set_row, shuffled, spread
from .limb import DOUBLED, INVERSE, RADIX, UNIT, carry, carry_scalar, divide, double_of
from .series import SPIN, TENSION, VM, VW, VX, LimbSeries, LinearTerms, M, X, positions
from .size import LIMB_BITS

GRAINS = 1024
MOST_GRAINS = 4 * GRAINS
_SHIFT = RADIX / GRAINS  # times m, and one limb down: a multiplication by m / GRAINS
# a step with at least this step-size factor is accepted as it is; the order is chosen accordingly
LEAST_FACTOR = 0.9
SAFETY_FACTOR = 0.98  # of the next length, against the one that the last coefficients allow
# units of the last limb: smaller coefficients say nothing about the decay of the series
_RESOLVED = 4.0
# the length stays as it is while the new one would be within these multiples of it
_KEEP_FROM = 0.94
_KEEP_TO = 1.03
_STEADY = LinearTerms._fields.index("steady")
_LN_2 = 0.6931471805599453
_ROOT_HALF = 0.7071067811865476

_swapped_halves = shuffled((3, 4, 5, 0, 1, 2, -1, -1), "_swapped_halves")
_speeds = shuffled((-1, -1, -1, 3, 4, 5, -1, -1), "_speeds")
_aside = shuffled((-1, -1, -1, -1, 1, 2, -1, -1), "_aside")
_across = shuffled((4, 3, -1, -1, -1, -1, -1, -1), "_across")


class LimbModel(NamedTuple):
    """A scene's constants in limbs, in the unit of time, and the settings of its integration.

    Attributes:
        limb_count, order: of the series.
        drag: whether there is any.
        tolerance: the size that the last coefficients of a series must not exceed.
        longest: longest step in grains.
        terms: the linear terms at m = GRAINS, in limb_count + 1 rows, not doubled.
        powers: of m in them, lane by lane: one array of eight for each array of `terms`.
        along, across: lane by lane the matrix from these axes to east, north, up, for
            `dense_output.to_cartesian`.
    """

    limb_count: int
    order: int
    drag: bool
    tolerance: float
    longest: int
    terms: LinearTerms
    powers: LinearTerms
    along: Array
    across: Array


@compiled
def scale_terms(to: LinearTerms, model: LimbModel, m: int) -> None:
    """Write the linear terms for a step of m grains."""
    for i in range(len(to)):
        rows = to[i]
        factor = spread(1.0 if i == _STEADY else DOUBLED)
        for r in range(model.limb_count + 1):
            set_row(rows, r, get_row(model.terms[i], r))
        for power in range(1, 4):
            _multiply(rows, model.powers[i], power, m, model.limb_count)
        for r in range(model.limb_count + 1):
            set_row(rows, r, get_row(rows, r) * factor)


@compiled
def _multiply(rows: Array, powers: Array, power: int, m: int, limb_count: int) -> None:
    """Multiply the lanes that hold at least this power of m by m / GRAINS.

    The others stay as they are.
    """
    has_power = at_least(get_row(powers, 0), spread(power - 0.5))
    factor = spread(_SHIFT * GRAINS) + has_power * spread(_SHIFT * (m - GRAINS))
    for r in range(limb_count, -1, -1):
        set_row(rows, r + 1, get_row(rows, r) * factor)
    set_row(rows, 0, spread(0.0))
    carry(rows, 0, limb_count + 1)


@compiled
def lane_products(to: Array, a: Array, b: Array, limb_count: int) -> None:
    """Write rows 0 … limb_count of the product a b in each lane, not carried."""
    for r in range(limb_count + 1):
        total = spread(0.0)
        for q in range(r):
            total = plus_product(total, get_row(a, r - 1 - q), get_row(b, q))
        set_row(to, r, total * spread(DOUBLED))


@compiled
def order_zero(s: LimbSeries, terms: LinearTerms, now: Array, m: int, limb_count: int) -> None:
    """Write the coefficients of order 0 from the state: n, h V, the tension λ = V·V + n·c and j."""
    # n, and V in units of the step
    scale = spread(_SHIFT * m)
    s.total[:] = 0.0
    for r in range(limb_count):
        set_row(s.total, r + 1, _speeds(get_row(now, r)) * scale)
    carry(s.total, 0, limb_count)
    for r in range(limb_count):
        set_row(s.c, r, positions(get_row(now, r)) + get_row(s.total, r))

    # n·c, then V·V
    for r in range(limb_count):
        set_row(s.partners, r, _aside(get_row(s.c, r)))
    lane_products(s.total, terms.steady, s.partners, limb_count)
    for r in range(limb_count + 1):
        s.scalar[r] = s.total[LANES * r + VM] + s.total[LANES * r + VW]
    lane_products(s.total, s.c, s.c, limb_count)
    for r in range(limb_count + 1):
        at = LANES * r
        s.scalar[r] += s.total[at + VX] + s.total[at + VM] + s.total[at + VW]
    _set_lane(s, TENSION, limb_count)

    # j = x Vm - m Vx
    for r in range(limb_count):
        set_row(s.other, r, _across(get_row(s.c, r)))
    lane_products(s.total, s.c, s.other, limb_count)
    for r in range(limb_count + 1):
        s.scalar[r] = s.total[LANES * r + X] - s.total[LANES * r + M]
    _set_lane(s, SPIN, limb_count)


@compiled
def _set_lane(s: LimbSeries, lane: int, limb_count: int) -> None:
    """Carry the limbs in `scalar` and write them to a lane of order 0."""
    carry_scalar(s.scalar, limb_count)
    for r in range(limb_count):
        s.c[LANES * r + lane] = s.scalar[r]


@compiled
def step_size_factor(s: LimbSeries, order: int, limb_count: int, tolerance: float) -> float:
    """Return the multiple of the step, at most 2, at whose end the last coefficients of n and V reach the tolerance.

    It is estimated from the last two resolved coefficients (Jorba and Zou 2005), assuming geometric
    decay.
    """
    least_size = math.ldexp(_RESOLVED, 1 - LIMB_BITS * limb_count)
    target = _log2(tolerance) / order
    least = 2.0
    resolved_orders = 0
    k = order
    while resolved_orders < 2 and 2 * k > order:
        size = 0.0
        for lane in range(6):
            size = max(size, abs(double_of(s.c, limb_count, k * limb_count * LANES + lane, LANES)))
        if size >= least_size:
            least = min(least, _exp2(target - _log2(size) / k))
            resolved_orders += 1
        k -= 1
    return least


@compiled
def _log2(x: float) -> float:
    """Return log2(x) of a positive number, to some units in the last place.

    Libm's differs from CPU to CPU.
    """
    fraction, exponent = math.frexp(x)
    y = (fraction - _ROOT_HALF) / (fraction + _ROOT_HALF)
    square = y * y
    total = 0.0
    for n in range(21, 0, -2):
        total = total * square + 1.0 / n
    return exponent - 0.5 + 2.0 / _LN_2 * y * total


@compiled
def _exp2(x: float) -> float:
    """Return 2**x, likewise."""
    whole = np.rint(x)
    exponent = (x - whole) * _LN_2
    total = 1.0
    for n in range(15, 0, -1):
        total = 1.0 + total * exponent / n
    return math.ldexp(total, int(whole))


@compiled
def next_length(m: int, factor: float, longest: int) -> int:
    """Return the next step in grains."""
    target = m * factor * SAFETY_FACTOR
    if m * _KEEP_FROM <= target <= m * _KEEP_TO:
        return min(m, longest)
    return max(1, min(int(target), 2 * m, longest))


@compiled
def sum_series(to: Array, s: LimbSeries, order: int, limb_count: int) -> None:
    """Write the sum of all coefficients: all lanes at the step's end."""
    to[:] = 0.0
    for k in range(order, -1, -1):
        for r in range(s.first[k], limb_count):
            set_row(to, r, get_row(to, r) + get_row(s.c, k * limb_count + r))
    carry(to, 0, limb_count - 1)


@compiled
def project(now: Array, rows: Array, s: LimbSeries, m: int, limb_count: int) -> None:
    """Write the state from the rows at a step's end: V in the unit of time, n and V projected onto the sphere."""
    for r in range(limb_count):
        set_row(s.total, r, _speeds(get_row(rows, r)) * spread(GRAINS))
    set_row(s.total, limb_count, spread(0.0))
    divide(s.total, 0, limb_count, m)
    for r in range(limb_count):
        set_row(now, r, positions(get_row(rows, r)) + get_row(s.total, r))

    # n·n - 1 and n·V, in units of the last limb
    lane_products(s.total, now, now, limb_count)
    too_long = _excess(s, limb_count, UNIT)
    for r in range(limb_count):
        set_row(s.partners, r, _swapped_halves(get_row(now, r)))
    lane_products(s.total, now, s.partners, limb_count)
    outward = _excess(s, limb_count, 0.0)

    last = LANES * (limb_count - 1)
    for lane in range(3):
        n = double_of(now, limb_count, lane, LANES)
        now[last + lane] -= np.rint(0.5 * too_long * n)
        now[last + lane + 3] -= np.rint(outward * n)
    carry(now, 0, limb_count - 1)


@compiled
def _excess(s: LimbSeries, limb_count: int, unit: float) -> float:
    """Return the sum of the first three lanes of `total` less `unit` in the first limb, in units of the last limb."""
    for r in range(limb_count + 1):
        at = LANES * r
        s.scalar[r] = s.total[at] + s.total[at + 1] + s.total[at + 2]
    s.scalar[0] -= unit
    carry_scalar(s.scalar, limb_count)
    value = 0.0
    for r in range(limb_count):
        value = value * RADIX + s.scalar[r]
    return float(value + s.scalar[limb_count] * INVERSE)
