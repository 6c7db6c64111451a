"""A polynomial in double precision: its character on an interval, a crossing of zero."""

from __future__ import annotations

from ...numbers.precision import Array
from .lanes import compiled

HALVINGS = 60  # more than a double has bits

# of a polynomial on an interval: without a zero; monotone; convex or concave; none of these can be told
FREE, MONOTONE, CONVEX, UNDECIDED = range(4)


@compiled
def classify(
    f: Array, size: int, middle: float, half: float, noise: float
) -> tuple[int, float, float]:
    """Return the polynomial's character within `half` of the middle; its value and half its second derivative there."""
    high = middle + half
    value = slope = bend = 0.0
    # bounds from the coefficients' sizes, to the third derivative
    total = slopes = bends = third = 0.0
    for k in range(size - 1, -1, -1):
        bend, slope, value = bend * middle + slope, slope * middle + value, value * middle + f[k]
        third, bends, slopes = third * high + bends, bends * high + slopes, slopes * high + total
        total = total * high + abs(f[k])
    third *= half
    kind = UNDECIDED
    if abs(value) > half * (abs(slope) + half * (abs(bend) + third)) + noise:
        kind = FREE
    elif abs(slope) > half * (2.0 * abs(bend) + 3.0 * third) + size * noise:
        kind = MONOTONE
    elif abs(bend) > 3.0 * third + size * size * noise:
        kind = CONVEX
    return kind, value, bend


@compiled
def value_and_slope(g: Array, size: int, u: float) -> tuple[float, float]:
    """Return the polynomial's value and its derivative."""
    value = slope = 0.0
    for k in range(size - 1, -1, -1):
        slope, value = slope * u + value, value * u + g[k]
    return value, slope


@compiled
def crossing(g: Array, size: int, low: float, high: float, before: int) -> float:
    """Return where the polynomial changes sign between `low` and `high`: Newton's method, safeguarded by bisection."""
    u = 0.5 * (low + high)
    for _ in range(HALVINGS):
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
