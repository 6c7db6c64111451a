"""The position error of two trajectories, without cancellation in any number type; the power law by which it grows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from reference import InputError
from reference.numbers.precision import Array

Column: TypeAlias = Array | Sequence[Fraction]  # doubles, or exact numbers
LEAST_POINTS = 3  # a fit with a standard error needs at least three


def difference(one: Column, other: Column, low: Array | float = 0.0) -> Array:
    """Return one - other as doubles, shape (rows,), of two columns that may agree to nearly all their digits.

    Args:
        one: doubles, or exact numbers; exact numbers are subtracted exactly, and so are doubles from them.
        other: as `one`.
        low: the low parts of `one` minus those of `other`, where doubles have any.
    """
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.asarray(one - other + low)  # the difference of doubles that agree so far is exact
    return np.array([float(Fraction(p) - Fraction(q)) for p, q in zip(one, other, strict=True)])


def distance(components: Iterable[Array]) -> Array:
    """Return the lengths of vectors by their components, shape (rows,)."""
    return np.asarray(np.sqrt(sum(part**2 for part in components)))


@dataclass(frozen=True)
class PowerLaw:
    """y = factor · x**exponent, fitted by least squares in logarithms.

    Attributes:
        factor: y at x = 1.
        exponent: slope in logarithms.
        standard_error: of the exponent, if y scatters about a power law.
        within: factor within which all points lie.
        points: number of points fitted.
        low: smallest x of these points.
        high: largest x of these points.
    """

    factor: float
    exponent: float
    standard_error: float
    within: float
    points: int
    low: float
    high: float

    def __call__(self, x: float) -> float:
        """Return y at x."""
        return float(self.factor * x**self.exponent)


def power_law(x: Iterable[float], y: Iterable[float]) -> PowerLaw:
    """Fit a power law by least squares to the points with x > 0 and y > 0.

    Raises:
        InputError: there are fewer than three such points, or all have the same x.
    """
    points = [(math.log(a), math.log(b)) for a, b in zip(x, y, strict=True) if a > 0 and b > 0]
    if len({u for u, _ in points}) < 2 or len(points) < LEAST_POINTS:
        raise InputError(
            "points", f"{len(points)} with x > 0 and y > 0", f"at least {LEAST_POINTS}, not all at the same x"
        )
    mean_u, mean_v = (math.fsum(column) / len(points) for column in zip(*points, strict=True))
    spread = math.fsum((u - mean_u) ** 2 for u, _ in points)
    exponent = math.fsum((u - mean_u) * (v - mean_v) for u, v in points) / spread
    off = [v - mean_v - exponent * (u - mean_u) for u, v in points]
    error = math.sqrt(math.fsum(one**2 for one in off) / (len(points) - 2) / spread)
    within = math.exp(max(map(abs, off)))
    low, high = min(u for u, _ in points), max(u for u, _ in points)
    factor = math.exp(mean_v - exponent * mean_u)
    return PowerLaw(factor, exponent, error, within, len(points), math.exp(low), math.exp(high))


def largest_so_far(t: Array, error: Array, parts: int) -> tuple[Array, Array]:
    """Return times and the largest error up to each, thinned to at most `parts` points equally far apart in log t.

    Args:
        t: times in s, above zero, increasing, shape (rows,), at least one.
        error: errors at these times.
        parts: number of points, so that late times do not weigh more.
    """
    at = np.searchsorted(t, np.geomspace(t[0], t[-1], parts), side="right") - 1
    at = at[np.diff(at, prepend=-1) > 0]  # not by np.unique, which imports numpy.ma
    return t[at], np.maximum.accumulate(error)[at]


def power_of_time(t: Array, error: Array, parts: int) -> float | None:
    """Return the exponent p of error ∝ t^p, fitted to the largest error so far; None if there are too few points.

    The arguments are those of `largest_so_far`; errors are above zero.
    """
    times, largest = largest_so_far(t, error, parts)
    return power_law(times.tolist(), largest.tolist()).exponent if len(times) >= LEAST_POINTS else None
