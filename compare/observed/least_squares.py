"""Least squares: Gauss-Newton fits of a model's parameters, and fits of power laws."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from reference import InputError
from reference.errors import Described
from reference.numbers.precision import Array

Numbers = npt.NDArray[Any]  # real or complex
Model = Callable[[Numbers], tuple[Numbers, Callable[[], Numbers]]]
LEAST_POINTS = 3  # a fit with a standard error needs at least three


def solved(matrix: Numbers, right: Numbers, rcond: float | None = None) -> Numbers:
    """Return the least-squares solution x of matrix x = right.

    Raises:
        LinAlgError: a number is not finite. LAPACK would print that on stdout, where a JSON
            document may stand.
    """
    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        raise np.linalg.LinAlgError("the linear equations have numbers that are not finite")
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=rcond)[0])


def best_change(slopes: Numbers, residuals: Numbers, damping: float = 0.0) -> Numbers:
    """Return the change of the parameters that minimises the linearised residual.

    Args:
        slopes: derivatives of the rows by each number, shape (rows, numbers); all are scaled to
            norm 1 first.
        residuals: the rows less those of the model, shape (rows,).
        damping: holds back what the rows hardly determine: directions whose scaled slope is less
            than it.
    """
    scale = np.linalg.norm(slopes, axis=0)
    scale[scale == 0] = 1.0
    matrix = slopes / scale
    if damping:
        matrix = np.vstack([matrix, damping * np.eye(len(scale))])
        residuals = np.concatenate([residuals, np.zeros(len(scale))])
    change: Numbers = solved(matrix, residuals, 1e-14) / scale
    return change


def by_differences(rows_of: Callable[[Numbers], Numbers], rows: Numbers, nudges: Numbers) -> Model:
    """Return a model for `gauss_newton` whose derivatives are finite differences.

    Args:
        rows_of: returns the rows that numbers make; NaN where they make none.
        rows: those that are fitted.
        nudges: by which each number is moved for its slope.
    """
    moves = list(zip(np.diag(nudges), nudges, strict=True))

    def model(numbers: Numbers) -> tuple[Numbers, Callable[[], Numbers]]:
        base = rows_of(numbers)

        def slopes() -> Numbers:
            return np.array([(rows_of(numbers + move) - base) / nudge for move, nudge in moves]).T

        return rows - base, slopes

    return model


def gauss_newton(
    model: Model, start: Numbers, *, steps: int, gain: float, strays: bool = False
) -> tuple[Numbers, float]:
    """Return the parameters that minimise the residual, and the norm of that residual.

    The norm is infinity if the first residual is not finite.

    Args:
        model: returns the residuals of some parameters, and a function that makes the slopes of
            `best_change` there; further slopes are those of numbers that the model fits itself,
            because it is linear in them.
        start: first parameters.
        steps: that are taken at most.
        gain: share of the residual that a step has to come below, or it is not taken and the search
            ends.
        strays: whether another step may follow one with a plainly larger residual, as one along a
            bent valley has.
    """
    best = start
    numbers = start
    residuals, slopes = model(start)
    least = float(np.linalg.norm(residuals))
    strayed = False
    if not math.isfinite(least):
        return start, math.inf
    for _ in range(steps):
        jacobian = slopes()
        if not np.isfinite(jacobian).all():
            break
        change = best_change(jacobian, residuals)
        foreseen = float(np.linalg.norm(residuals - jacobian @ change))
        numbers = numbers + change[: len(numbers)]
        residuals, slopes = model(numbers)
        size = float(np.linalg.norm(residuals))
        if size < gain * least:
            best = numbers
            least = size
            strayed = False
            # the slopes hold: another step would gain nothing
            if abs(size - foreseen) < (1 - gain) * size:
                break
        elif strayed or not (strays and least < gain * size < math.inf):
            break
        else:
            strayed = True
    return best, least


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
        got = Described(f"{len(points)} with x > 0 and y > 0")
        expected = f"at least {LEAST_POINTS}, with different values of x"
        raise InputError("points", got, expected)
    logs_x, logs_y = zip(*points, strict=True)
    exponent, constant = statistics.linear_regression(logs_x, logs_y)
    residuals = [v - constant - exponent * u for u, v in points]
    variance = sum(residual**2 for residual in residuals) / (len(points) - 2)
    spread = len(points) * statistics.pvariance(logs_x)
    return PowerLaw(
        factor=math.exp(constant),
        exponent=exponent,
        standard_error=math.sqrt(variance / spread),
        within=math.exp(max(map(abs, residuals))),
        points=len(points),
        low=math.exp(min(logs_x)),
        high=math.exp(max(logs_x)),
    )


def largest_so_far(t: Array, error: Array, parts: int) -> tuple[Array, Array]:
    """Return times and the largest error up to each, thinned to at most `parts` points, equidistant in log t.

    Args:
        t: times in s, above zero, increasing, shape (rows,), at least one.
        error: errors at these times.
        parts: number of points, so that late times do not weigh more.
    """
    at = np.searchsorted(t, np.geomspace(t[0], t[-1], parts), side="right") - 1
    at = at[np.diff(at, prepend=-1) > 0]  # not by np.unique, which imports numpy.ma
    return t[at], np.maximum.accumulate(error)[at]


def power_of_time(t: Array, error: Array, parts: int) -> float | None:
    """Return the exponent p of error ∝ t^p, fitted to the largest error so far.

    None if there are too few points.

    The arguments are those of `largest_so_far`; errors are above zero.
    """
    times, largest = largest_so_far(t, error, parts)
    if len(times) < LEAST_POINTS:
        return None
    return power_law(times.tolist(), largest.tolist()).exponent
