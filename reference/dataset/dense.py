"""The truth between the grid times of a golden dataset: integrated from each golden state to the next.

Between two grid times a run has no time to lose digits, and where it arrives, the next golden state says
how many it has lost: the bound is measured interval by interval, not assumed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from ..model.constants import Constants, constants
from ..model.formulations import FORMULATIONS
from ..precision import GUARD_BITS, LONG_DOUBLE, Array, NumberType, context, real
from ..solver.solution import GRID_COLUMNS
from .read import Golden

TYPES = (LONG_DOUBLE, real(128), real(192), real(256))  # the next is tried where the one before loses too much
WITHIN = 2.0**-58  # of the cord length: enough to judge programs in double
ROOM = 32  # times `within`: the tolerance of a step at first; what that costs is measured on arrival, as all is
SAFETY = 4  # for what the end of an interval, where a run is measured, does not show
MOST_STRETCH = 1000.0  # at a point of rest nothing is late, and the ratio of speeds says nothing
ULPS = 8  # that a golden state and what is made of it may lose by being rounded to the run's type
PAIR = 2.0**-104  # relative: what two doubles cannot hold
BLOCK = 1 << 16  # rows that are held in the run's type at a time


@dataclass(frozen=True)
class Dense:
    """A trajectory at chosen times, finer than binary64.

    Attributes:
        t: times in s, shape (rows,), increasing, without repeats.
        states: nearest doubles of x, y, z (m), vx, vy, vz (m/s), shape (rows, 6).
        low: what the doubles lack, shape (rows, 6): the values are states + low.
        bound_m: how far any position may be from the truth.
        number: the type that was enough.
    """

    t: Array
    states: Array = field(repr=False)
    low: Array = field(repr=False)
    bound_m: float
    number: str


def dense(golden: Golden, times: npt.ArrayLike, within: float = WITHIN) -> Dense:
    """Evaluate the truth of a golden dataset at any times within it.

    Args:
        golden: its grid states are where every interval starts.
        times: in s, in any order; repeated ones are merged.
        within: how near to the truth to come, relative to the cord length; what was reached is in `bound_m`.

    Raises:
        InputError: a time is not finite, or outside of the dataset and more than a grid step beyond its end.
    """
    wanted = np.unique(np.asarray(times, dtype=np.float64).ravel())
    grid = [Fraction(text) for text in golden.decimals("t")]
    _check(wanted, grid)
    length = float(golden.scene.exact.length)
    fine = [number for number in TYPES if ULPS * 2.0**-number.prec <= within] or [TYPES[-1]]
    tries = [(number, tolerance) for number in fine for tolerance in (ROOM * within, None)]
    for number, tolerance in tries:
        march = _March(golden, grid, wanted, number, tolerance)
        states, low = march.run(math.inf if (number, tolerance) == tries[-1] else within * length)
        if march.missed <= within * length:
            break
    lost = SAFETY * march.missed + (ULPS * 2.0**-number.prec + PAIR) * length
    return Dense(wanted, states, low, lost + float(golden.manifest.bounds.position_m), str(number))


def _check(times: Array, grid: list[Fraction]) -> None:
    if not len(times):
        raise InputError("t", "no times", "at least one time in s")
    end = 2 * grid[-1] - grid[-2]  # a program that counts in steps ends a little beyond
    if not np.isfinite(times).all() or times[0] < 0 or Fraction(times[-1]) > end:
        strange = times[~np.isfinite(times)] if not np.isfinite(times).all() else times[[0]] if times[0] < 0 else times
        advice = f"The scene ends at run.t_end = {float(grid[-1]):.17g}: --set run.t_end=… solves a longer one."
        raise InputError("t", f"{strange[-1]:.17g}", f"times from 0 to {float(end):.17g} s", advice)


class _March:
    """One evaluation in one number type.

    `missed` is the largest distance in m from a golden state on arrival, or what that is where the bob is fastest:
    a run that is late by a moment shows little of it where it arrives slowly, near the top or at a turning point.
    """

    def __init__(
        self, golden: Golden, grid: list[Fraction], wanted: Array, number: NumberType, tolerance: float | None
    ) -> None:
        from ..engines.heyoka.numbers import Numbers
        from ..engines.heyoka.propagator import Propagator
        from ..engines.heyoka.system import rates

        self._numbers = Numbers(number)
        self._k = constants(golden.scene.exact, context(number.prec + GUARD_BITS)).converted(self._numbers.of)
        self._model = FORMULATIONS["momentum"]
        self._flow = Propagator(self._model.variables, rates(self._model, self._k), number, tolerance=tolerance)
        self._grid, self._wanted = grid, wanted
        self._near = np.array([float(t) for t in grid])
        self._wide = _wide(self._near, self._numbers)
        self._edges = np.append(np.searchsorted(wanted, self._near), len(wanted))
        for i, (near, t) in enumerate(zip(self._near, grid, strict=True)):
            at = self._edges[i]
            if at < len(wanted) and wanted[at] == near and Fraction(near) < t:
                self._edges[i] += 1  # the double next to a grid time, and before it
        self._anchors = _anchors(golden, self._numbers, self._k)
        self._weights, self._stretch = _speeds(self._anchors.astype(np.float64), golden)
        self._legs = {step: self._numbers.of(step) for step in {b - a for a, b in pairwise(grid)}}
        self.missed = 0.0

    def run(self, most: float) -> tuple[Array, Array]:
        """States as doubles and what these lack, each of shape (times wanted, 6); given up beyond `most` m."""
        near, low = np.empty((len(self._wanted), 6)), np.empty((len(self._wanted), 6))
        held: list[Any] = []
        row = count = 0
        for states in self._intervals():
            if self.missed * float(self._k.length) > most:
                break
            held.append(states)
            count += len(states)
            if count >= BLOCK or row + count == len(near):
                near[row : row + count], low[row : row + count] = self._converted(np.concatenate(held))
                row, count, held = row + count, 0, []
        self.missed *= float(self._k.length)
        return near, low

    def _intervals(self) -> Iterator[Any]:
        """States at the times wanted in each interval that has any; the one that starts at the end comes last."""
        last = len(self._grid) - 1
        beyond = len(self._wanted) > 0 and Fraction(self._wanted[-1]) > self._grid[-1]
        for i in range(last + 1):
            inside = self._wanted[self._edges[i] : self._edges[i + 1]]
            needed = beyond and i == last - 1  # what lies beyond the end is measured by the interval before
            if not len(inside) and not needed:
                continue
            states, arrived = self._interval(i, inside, needed)
            if arrived is not None:
                far = (arrived - self._anchors[i + 1]).astype(float) * self._weights
                self.missed = max(self.missed, float(np.linalg.norm(far) * self._stretch[i + 1]))
            yield states

    def _interval(self, i: int, inside: Array, needed: bool) -> tuple[Any, Any]:
        """States within an interval, and that at its end (None for the last, and where nothing is integrated)."""
        numbers, start = self._numbers, self._anchors[i]
        # a grid time is a double and a little more: the difference of the doubles is exact, and rounded once
        little = self._grid[i] - Fraction(self._near[i])
        offsets = _wide(inside, numbers) - self._wide[i]
        offsets = offsets - numbers.of(little) if little else offsets
        on_anchor = len(inside) > 0 and Fraction(inside[0]) == self._grid[i]
        ahead = list(offsets[1:] if on_anchor else offsets)
        count, measured = len(ahead), i + 1 < len(self._grid) and (len(ahead) > 0 or needed)
        if measured:
            end = self._legs[self._grid[i + 1] - self._grid[i]]
            ahead = [*(ahead[:-1] if count and ahead[-1] >= end else ahead), end]
        reached = self._flow.from_zero(start, [numbers.of(0), *ahead]) if ahead else start[None, :]
        return reached[0 if on_anchor else 1 : 1 + count], reached[-1] if measured else None

    def _converted(self, states: Any) -> tuple[Array, Array]:
        columns = tuple(np.ascontiguousarray(states.T))
        position, velocity = self._model.cartesian(columns, self._k, np)
        rows = np.array([np.asarray(part * self._k.length) for part in (*position, *velocity)]).T
        near = rows.astype(np.float64)
        return near, (rows - near.astype(self._numbers.dtype)).astype(np.float64)


def _speeds(anchors: Array, golden: Golden) -> tuple[Array, Array]:
    """Weights that make n and H one length, shape (6,), and how much faster the bob may be than at each anchor."""
    k = constants(golden.scene.exact, context(GUARD_BITS)).converted(float)
    model = FORMULATIONS["momentum"]
    columns = tuple(anchors.T)
    n, v = (np.array(np.broadcast_arrays(*part)).T for part in model.cartesian(columns, k, np))
    pull = np.array([float(part) for part in k.pull])
    height = np.linalg.norm(pull) - n @ pull + float(k.rate) ** 2  # above the lowest point, in 1/s²
    fastest = math.sqrt(float(((v**2).sum(axis=1) + 2 * height).max()))
    weights = np.array([1.0] * 3 + [1 / (max(math.sqrt(np.linalg.norm(pull)), fastest) or 1.0)] * 3)
    rates = np.array(np.broadcast_arrays(*model.derivatives(columns, k, np))).T
    here = np.linalg.norm(rates * weights, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return weights, np.clip(np.nan_to_num(fastest / here, nan=1.0), 1.0, MOST_STRETCH)


def _anchors(golden: Golden, numbers: Any, k: Constants) -> Any:
    """Golden states in the variables of `momentum`, in the run's type, shape (grid times, 6)."""
    columns = [_column(golden.decimals(name), numbers) / k.length for name in GRID_COLUMNS]
    start = FORMULATIONS["momentum"].start(tuple(columns[:3]), tuple(columns[3:]), k, np)
    return np.ascontiguousarray(np.array(start, dtype=numbers.dtype).T)


def _wide(values: Array, numbers: Any) -> Any:
    """Doubles as numbers of the run's type."""
    if numbers.number == LONG_DOUBLE:
        return values.astype(np.longdouble)
    return np.array([numbers.of(Fraction(value)) for value in values], dtype=numbers.dtype)


def _column(texts: list[str], numbers: Any) -> Any:
    if numbers.number == LONG_DOUBLE:
        return np.array([np.longdouble(text) for text in texts])
    return np.array([numbers.of(Fraction(text)) for text in texts], dtype=numbers.dtype)
