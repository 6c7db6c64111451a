"""A polynomial in double precision: how it behaves on an interval, and where it crosses zero."""

from __future__ import annotations

from typing import NamedTuple

from ...numbers.precision import Array
from .lanes import compiled

_HALVINGS = 60  # more than a double has bits

# a polynomial on an interval: without a zero; monotone; convex or concave; none of these is certain
FREE, MONOTONE, CONVEX, UNDECIDED = range(4)


class Behaviour(NamedTuple):
    """How a polynomial behaves on an interval.

    Attributes:
        kind: FREE, MONOTONE, CONVEX or UNDECIDED.
        value: in the middle of the interval.
        bend: half the second derivative there.
    """

    kind: int
    value: float
    bend: float


@compiled
def classify(f: Array, size: int, middle: float, half: float, noise: float) -> Behaviour:
    """Return how a polynomial of `size` coefficients behaves within `half` of the middle.

    `noise` is the rounding of its values, as an estimate.
    """
    high = middle + half
    value = slope = bend = 0.0
    # bounds of value, slope, bend and a sixth of the third derivative, from the coefficients' sizes
    value_bound = slope_bound = bend_bound = third_bound = 0.0
    for k in range(size - 1, -1, -1):
        bend = bend * middle + slope
        slope = slope * middle + value
        value = value * middle + f[k]
        third_bound = third_bound * high + bend_bound
        bend_bound = bend_bound * high + slope_bound
        slope_bound = slope_bound * high + value_bound
        value_bound = value_bound * high + abs(f[k])

    third = third_bound * half
    kind = UNDECIDED
    if abs(value) > half * (abs(slope) + half * (abs(bend) + third)) + noise:
        kind = FREE
    elif abs(slope) > half * (2.0 * abs(bend) + 3.0 * third) + size * noise:
        kind = MONOTONE
    elif abs(bend) > 3.0 * third + size * size * noise:
        kind = CONVEX
    return Behaviour(kind, value, bend)


@compiled
def value_and_slope(g: Array, size: int, u: float) -> tuple[float, float]:
    """Return the polynomial's value and its derivative."""
    value = slope = 0.0
    for k in range(size - 1, -1, -1):
        slope = slope * u + value
        value = value * u + g[k]
    return value, slope


@compiled
def crossing(g: Array, size: int, low: float, high: float, before: int) -> float:
    """Return where the polynomial changes sign between `low` and `high`: Newton's method, safeguarded by bisection."""
    u = 0.5 * (low + high)
    for _ in range(_HALVINGS):
        value, slope = value_and_slope(g, size, u)
        if (value > 0.0) == (before > 0):
            low = u
        else:
            high = u
        new = u - value / slope if slope != 0.0 else u
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - u) < 2.0**-52:
            return new
        u = new
    return u
