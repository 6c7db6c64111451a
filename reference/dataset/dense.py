"""Dense output: the golden solution at any times, from its rows or, between them, from the scene solved again there."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from ..numbers.columns import POSITION, STATE, VELOCITY
from ..numbers.function import States, moments_of
from ..numbers.precision import Array

WITHIN = 2.0**-58  # error allowed, relative to the cord length: enough to judge programs in double
ROUNDED = 2.0**-40  # relative, of the times that a program has added up
PAIR = Fraction(1, 1 << 104)  # relative resolution of a number held as two doubles


@dataclass(frozen=True)
class Dense:
    """A trajectory at chosen times, finer than binary64.

    Attributes:
        t: times in s, shape (rows,), increasing, without repeats.
        states: nearest doubles of x, y, z (m), vx, vy, vz (m/s), shape (rows, 6).
        low: low parts, shape (rows, 6): the values are states + low.
        bound_m: bound on the error of every position, in m.
        bound_m_s: bound on that of every velocity, in m/s.
    """

    t: Array
    states: Array = field(repr=False)
    low: Array = field(repr=False)
    bound_m: float
    bound_m_s: float

    @classmethod
    def of(cls, times: Array, table: Any, rows: Any) -> Dense:
        """Build from some rows of a table that has bounds."""
        exact = [[column[i] for i in rows] for column in map(table.exact, STATE)]
        states = np.array([[float(x) for x in column] for column in exact]).T
        pairs = (zip(column, near, strict=True) for column, near in zip(exact, states.T.tolist(), strict=True))
        low = np.array([[float(x - Fraction(y)) for x, y in pair] for pair in pairs]).T
        bounds = (
            max(max(table.bound(name)) + PAIR * max(map(abs, exact[STATE.index(name)])) for name in kind)
            for kind in (POSITION, VELOCITY)
        )
        return cls(times, states, low, *map(float, bounds))


def dense(golden: Any, times: npt.ArrayLike, within: float = WITHIN) -> Dense:
    """Evaluate the solution of a golden dataset at any times that it spans.

    Args:
        golden: the dataset: its rows are taken where all times are those of its grid.
        times: in s, in any order; repeated ones are merged.
        within: error aimed at, relative to the cord length; the bound that was reached is `bound_m`.

    Raises:
        InputError: a time is not finite, negative, or more than a grid step beyond the end of the dataset.
        UnreachableError: the scene cannot be solved so closely.
    """
    requested = np.unique(np.asarray(times, dtype=np.float64).ravel())
    grid = golden.times
    _check(requested, grid)
    exact = [Fraction(t) for t in requested.tolist()]
    row = {t: i for i, t in enumerate(grid)}
    if row.keys() >= set(exact):
        return Dense.of(requested, golden.grid, [row[t] for t in exact])
    from ..solver.solve import solve_at

    solution = solve_at(golden.scene, exact, math.ceil(-math.log10(within)) + 1)
    row = {t: i for i, t in enumerate(solution.times)}
    return Dense.of(requested, solution.grid, [row[t] for t in exact])


def states_at(golden: Any, times: npt.ArrayLike) -> States:
    """Return the states at times of any shape and in any order, rounded to doubles.

    Raises:
        InputError: a time is not finite, or outside of the dataset's span.
    """
    moments = moments_of(times, golden.times[-1])
    if not moments.size:
        return States.of(moments, np.empty((6, 0)), {})
    found = dense(golden, moments)
    rows = found.states[np.searchsorted(found.t, moments.ravel())]
    largest = np.abs(found.states).max(axis=0)
    bounds = {name: found.bound_m if name in POSITION else found.bound_m_s for name in STATE}
    rounding = {name: float(np.spacing(size)) for name, size in zip(STATE, largest, strict=True)}
    return States.of(moments, rows.T, {name: bound + rounding[name] for name, bound in bounds.items()})


def _check(times: Array, grid: tuple[Fraction, ...]) -> None:
    if not len(times):
        raise InputError("t", "no times", "at least one time in s")
    end = 2 * grid[-1] - grid[-2]  # where a program that counts steps may end, but for the rounding of its times
    if not np.isfinite(times).all() or times[0] < 0 or times[-1] > float(end) * (1 + ROUNDED):
        outside = times[~np.isfinite(times)] if not np.isfinite(times).all() else times[[0]] if times[0] < 0 else times
        advice = f"The scene ends at run.t_end = {float(grid[-1]):.17g}: --set run.t_end=… solves a longer one."
        raise InputError("t", f"{outside[-1]:.17g}", f"times from 0 to {float(end):.17g} s", advice)
