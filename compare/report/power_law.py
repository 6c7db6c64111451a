"""A power law through points: what a cost or an error grows as."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reference import InputError

LEAST_POINTS = 3  # of a fit that states a standard error


@dataclass(frozen=True)
class PowerLaw:
    """y = factor · x**exponent, fitted by least squares in logarithms.

    Attributes:
        factor: y at x = 1.
        exponent: slope in logarithms.
        standard_error: of the exponent.
        points: fitted.
        low: smallest x of them.
        high: largest x of them.
    """

    factor: float
    exponent: float
    standard_error: float
    points: int
    low: float
    high: float

    def __call__(self, x: float) -> float:
        """The law's y."""
        return float(self.factor * x**self.exponent)


def power_law(x: Sequence[float], y: Sequence[float]) -> PowerLaw:
    """Least squares fit of a power law to positive numbers.

    Raises:
        InputError: fewer than three points, or all at one x, which leave no standard error.
    """
    points = [(math.log(a), math.log(b)) for a, b in zip(x, y, strict=True) if a > 0 and b > 0]
    if len({u for u, _ in points}) < 2 or len(points) < LEAST_POINTS:
        raise InputError("points", f"{len(points)} that are positive", f"at least {LEAST_POINTS} at different places")
    mean_u, mean_v = (math.fsum(column) / len(points) for column in zip(*points, strict=True))
    spread = math.fsum((u - mean_u) ** 2 for u, _ in points)
    exponent = math.fsum((u - mean_u) * (v - mean_v) for u, v in points) / spread
    rest = math.fsum((v - mean_v - exponent * (u - mean_u)) ** 2 for u, v in points)
    error = math.sqrt(rest / (len(points) - 2) / spread)
    low, high = min(u for u, _ in points), max(u for u, _ in points)
    factor = math.exp(mean_v - exponent * mean_u)
    return PowerLaw(factor, exponent, error, len(points), math.exp(low), math.exp(high))
