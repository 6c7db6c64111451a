"""Least squares fit of a power law y = factor · x**exponent, with the standard error of the exponent."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reference import InputError

LEAST_POINTS = 3  # a fit with a standard error needs at least three


@dataclass(frozen=True)
class PowerLaw:
    """y = factor · x**exponent, fitted by least squares in logarithms.

    Attributes:
        factor: y at x = 1.
        exponent: slope in logarithms.
        standard_error: of the exponent.
        points: number of points fitted.
        low: smallest x of these points.
        high: largest x of these points.
    """

    factor: float
    exponent: float
    standard_error: float
    points: int
    low: float
    high: float

    def __call__(self, x: float) -> float:
        """Return y at x."""
        return float(self.factor * x**self.exponent)


def power_law(x: Sequence[float], y: Sequence[float]) -> PowerLaw:
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
    residual = math.fsum((v - mean_v - exponent * (u - mean_u)) ** 2 for u, v in points)
    error = math.sqrt(residual / (len(points) - 2) / spread)
    low, high = min(u for u, _ in points), max(u for u, _ in points)
    factor = math.exp(mean_v - exponent * mean_u)
    return PowerLaw(factor, exponent, error, len(points), math.exp(low), math.exp(high))
