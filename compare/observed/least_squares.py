"""Least squares by Gauss-Newton: the numbers of a model moved to where the model leaves least of some rows."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

Numbers = npt.NDArray[Any]  # real or complex
Model = Callable[[Numbers], tuple[Numbers, Callable[[], Numbers]]]


def solved(matrix: Numbers, right: Numbers, rcond: float | None = None) -> Numbers:
    """Return the least squares solution of `matrix` times it = `right`.

    Raises:
        LinAlgError: a number is not finite. LAPACK would print that on stdout, where a JSON document may stand.
    """
    if not (np.isfinite(matrix).all() and np.isfinite(right).all()):
        raise np.linalg.LinAlgError("numbers that are not finite")
    solution: Numbers = np.linalg.lstsq(matrix, right, rcond=rcond)[0]
    return solution


def best_change(slopes: Numbers, left: Numbers, damping: float = 0.0) -> Numbers:
    """Return the change of numbers by which slopes come nearest to what is left.

    Args:
        slopes: what the rows change by with each number, shape (rows, numbers); all are brought to one size first.
        left: the rows, less what the model has in their place, shape (rows,).
        damping: holds back what the rows hardly tell: directions whose slope, of slopes made 1 each, is less than it.
    """
    scale = np.linalg.norm(slopes, axis=0)
    scale[scale == 0] = 1.0
    matrix = slopes / scale
    if damping:
        matrix = np.vstack([matrix, damping * np.eye(len(scale))])
        left = np.concatenate([left, np.zeros(len(scale))])
    change: Numbers = solved(matrix, left, 1e-14) / scale
    return change


def by_differences(rows_of: Callable[[Numbers], Numbers], rows: Numbers, nudges: Numbers) -> Model:
    """Return a model, for `gauss_newton`, whose slopes are taken by differences.

    Args:
        rows_of: returns the rows that numbers make; NaN where they make none.
        rows: those that are to be met.
        nudges: by which each number is moved for its slope.
    """
    moves = list(zip(np.diag(nudges), nudges, strict=True))

    def model(numbers: Numbers) -> tuple[Numbers, Callable[[], Numbers]]:
        base = rows_of(numbers)
        return rows - base, lambda: np.array([(rows_of(numbers + move) - base) / nudge for move, nudge in moves]).T

    return model


def gauss_newton(
    model: Model, start: Numbers, *, steps: int, gain: float, strays: bool = False
) -> tuple[Numbers, float]:
    """Return the numbers that leave least, and the norm of what they leave; infinity where the first leave no numbers.

    Args:
        model: returns what numbers leave, and a function that makes the slopes of `best_change` there; further slopes
            are those of numbers that the model fits itself, because it is linear in them.
        start: first numbers.
        steps: that are taken at most.
        gain: share of what was left that a step has to come below, or it is not taken and the search ends.
        strays: whether another step may follow one that leaves plainly more, as one along a bent valley does.
    """
    best = numbers = start
    left, slopes = model(start)
    least, strayed = float(np.linalg.norm(left)), False
    if not math.isfinite(least):
        return start, math.inf
    for _ in range(steps):
        made = slopes()
        if not np.isfinite(made).all():
            break
        numbers = numbers + best_change(made, left)[: len(numbers)]
        left, slopes = model(numbers)
        size = float(np.linalg.norm(left))
        if size < gain * least:
            best, least, strayed = numbers, size, False
        elif strayed or not (strays and least < gain * size < math.inf):
            break
        else:
            strayed = True
    return best, least
