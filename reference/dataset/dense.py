"""Dense output: the golden solution at any times, integrated anew from each golden state to the next.

Over one interval of the grid few digits are lost, and on arrival the next golden state shows how many: the error bound
is measured interval by interval, not assumed.
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
from ..numbers.columns import POSITION, STATE
from ..numbers.function import States, moments_of
from ..numbers.precision import GUARD_BITS, LONG_DOUBLE, Array, NumberType, context, real

TYPES = (LONG_DOUBLE, real(128), real(192), real(256))  # if one loses too many digits, the next is tried
WITHIN = 2.0**-58  # error allowed, relative to the cord length: enough to judge programs in double
FIRST_TOLERANCE = 32  # times `within`: the tolerance of a step tried first; its effect is measured on arrival
SAFETY = 4  # the error inside an interval may exceed the one measured at its end
MAX_SPEED_RATIO = 1000.0  # cap on (greatest speed)/(speed there): where the bob stands still the ratio means nothing
ULPS = 8  # units in the last place that rounding to the run's type may cost a golden state and the states after it
PAIR = 2.0**-104  # relative resolution of a number held as two doubles
BLOCK = 1 << 16  # rows held in the run's number type at a time


@dataclass(frozen=True)
class Dense:
    """A trajectory at chosen times, finer than binary64.

    Attributes:
        t: times in s, shape (rows,), increasing, without repeats.
        states: nearest doubles of x, y, z (m), vx, vy, vz (m/s), shape (rows, 6).
        low: low parts, shape (rows, 6): the values are states + low.
        bound_m: bound on the error of every position, in m.
        bound_m_s: bound on that of every velocity, in m/s.
        number: number type of the run.
    """

    t: Array
    states: Array = field(repr=False)
    low: Array = field(repr=False)
    bound_m: float
    bound_m_s: float
    number: str


def dense(golden: Any, times: npt.ArrayLike, within: float = WITHIN) -> Dense:
    """Evaluate the solution of a golden dataset at any times that it spans.

    Args:
        golden: dataset whose grid states start every interval.
        times: in s, in any order; repeated ones are merged.
        within: error aimed at, relative to the cord length; the bound that was reached is `bound_m`.

    Raises:
        InputError: a time is not finite, negative, or more than a grid step beyond the end of the dataset.
    """
    requested = np.unique(np.asarray(times, dtype=np.float64).ravel())
    grid = [Fraction(text) for text in golden.decimals("t")]
    _check(requested, grid)
    length = float(golden.scene.exact.length)
    types = [number for number in TYPES if ULPS * 2.0**-number.prec <= within] or [TYPES[-1]]
    attempts = [(number, tolerance) for number in types for tolerance in (FIRST_TOLERANCE * within, None)]
    for number, tolerance in attempts:
        evaluation = _Evaluation(golden, grid, requested, number, tolerance)
        states, low = evaluation.run(math.inf if (number, tolerance) == attempts[-1] else within * length)
        if evaluation.error_on_arrival <= within * length:
            break
    error, bounds = SAFETY * evaluation.error_on_arrival, golden.manifest.bounds
    error += (ULPS * 2.0**-number.prec + PAIR) * length
    in_velocity = error * evaluation.rate + float(bounds.velocity_m_s)
    return Dense(requested, states, low, error + float(bounds.position_m), in_velocity, str(number))


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


def _check(times: Array, grid: list[Fraction]) -> None:
    if not len(times):
        raise InputError("t", "no times", "at least one time in s")
    end = 2 * grid[-1] - grid[-2]  # a program that counts in steps ends a little beyond
    if not np.isfinite(times).all() or times[0] < 0 or Fraction(times[-1]) > end:
        outside = times[~np.isfinite(times)] if not np.isfinite(times).all() else times[[0]] if times[0] < 0 else times
        advice = f"The scene ends at run.t_end = {float(grid[-1]):.17g}: --set run.t_end=… solves a longer one."
        raise InputError("t", f"{outside[-1]:.17g}", f"times from 0 to {float(end):.17g} s", advice)


class _Evaluation:
    """One evaluation between the golden rows, in one number type.

    `error_on_arrival` is, after `run`, the largest distance in m from a golden state at the end of an interval. A phase
    error is nearly invisible where the bob is slow, near the top or at a turning point, so the distance is scaled by
    (greatest possible speed)/(speed there).
    """

    def __init__(
        self, golden: Any, grid: list[Fraction], requested: Array, number: NumberType, tolerance: float | None
    ) -> None:
        from ..engines.heyoka.model import RoundedModel

        k = constants(golden.scene.exact, context(number.prec + GUARD_BITS))
        self._model = RoundedModel(FORMULATIONS["momentum"], k, number)
        self._numbers, self._k = self._model.numbers, self._model.k
        self._propagator = self._model.propagator(tolerance)
        self._grid, self._requested = grid, requested
        self._nearest = np.array([float(t) for t in grid])
        self._widened = _converted(self._nearest, self._numbers)
        self._edges = np.append(np.searchsorted(requested, self._nearest), len(requested))
        for i, (nearest, t) in enumerate(zip(self._nearest, grid, strict=True)):
            at = self._edges[i]
            if at < len(requested) and requested[at] == nearest and Fraction(nearest) < t:
                self._edges[i] += 1  # the double nearest to a grid time lies before it
        self._anchors = _anchors(golden, self._numbers, self._k)
        self._weights, self._speed_ratio = _speeds(self._anchors.astype(np.float64), golden)
        self._spans = {step: self._numbers.of(step) for step in {b - a for a, b in pairwise(grid)}}
        self.rate = 2 / float(self._weights[3])  # an error e of n and H makes at most e times it in the velocity
        self.error_on_arrival = 0.0

    def run(self, most: float) -> tuple[Array, Array]:
        """Return states as doubles and their low parts, each (times, 6); give up at an error above `most` m."""
        nearest, low = np.empty((len(self._requested), 6)), np.empty((len(self._requested), 6))
        pending: list[Any] = []
        row = count = 0
        for states in self._intervals():
            if self.error_on_arrival * float(self._k.length) > most:
                break
            pending.append(states)
            count += len(states)
            if count >= BLOCK or row + count == len(nearest):
                nearest[row : row + count], low[row : row + count] = self._in_doubles(np.concatenate(pending))
                row, count, pending = row + count, 0, []
        self.error_on_arrival *= float(self._k.length)
        return nearest, low

    def _intervals(self) -> Iterator[Any]:
        """Yield the states at the requested times of each interval that has any; the one after the end comes last."""
        last = len(self._grid) - 1
        beyond = len(self._requested) > 0 and Fraction(self._requested[-1]) > self._grid[-1]
        for i in range(last + 1):
            inside = self._requested[self._edges[i] : self._edges[i + 1]]
            to_end = beyond and i == last - 1  # after the end, the error is the one measured on the last interval
            if not len(inside) and not to_end:
                continue
            states, arrival = self._interval(i, inside, to_end)
            if arrival is not None:
                gap = (arrival - self._anchors[i + 1]).astype(float) * self._weights
                self.error_on_arrival = max(
                    self.error_on_arrival, float(np.linalg.norm(gap) * self._speed_ratio[i + 1])
                )
            yield states

    def _interval(self, i: int, inside: Array, to_end: bool) -> tuple[Any, Any]:
        """Return the states within an interval, and the one at its end.

        The latter is None after the end of the grid, and where nothing has to be integrated.
        """
        numbers, start = self._numbers, self._anchors[i]
        # a grid time is a double and a remainder: the difference of the doubles is exact, and rounded once
        remainder = self._grid[i] - Fraction(self._nearest[i])
        offsets = _converted(inside, numbers) - self._widened[i]
        offsets = offsets - numbers.of(remainder) if remainder else offsets
        on_anchor = len(inside) > 0 and Fraction(inside[0]) == self._grid[i]
        stops = list(offsets[1:] if on_anchor else offsets)
        count, measured = len(stops), i + 1 < len(self._grid) and (len(stops) > 0 or to_end)
        if measured:
            end = self._spans[self._grid[i + 1] - self._grid[i]]
            stops = [*(stops[:-1] if count and stops[-1] >= end else stops), end]
        states = self._propagator.from_zero(start, [numbers.of(0), *stops]) if stops else start[None, :]
        return states[0 if on_anchor else 1 : 1 + count], states[-1] if measured else None

    def _in_doubles(self, states: Any) -> tuple[Array, Array]:
        """Return x, y, z (m), vx, vy, vz (m/s) as nearest doubles and their low parts, each of shape (rows, 6)."""
        rows = np.array(self._model.columns(states)).T
        nearest = rows.astype(np.float64)
        return nearest, (rows - nearest.astype(self._numbers.dtype)).astype(np.float64)


def _speeds(anchors: Array, golden: Any) -> tuple[Array, Array]:
    """Return weights that bring n and H to one scale, (6,), and (greatest possible speed)/(speed) at each anchor."""
    k = constants(golden.scene.exact, context(GUARD_BITS)).converted(float)
    model = FORMULATIONS["momentum"]
    columns = tuple(anchors.T)
    n, v = (np.array(np.broadcast_arrays(*part)).T for part in model.cartesian(columns, k, np))
    pull = np.array([float(part) for part in k.pull])
    height = np.linalg.norm(pull) - n @ pull + float(k.rate) ** 2  # above the lowest point, in 1/s²
    fastest = math.sqrt(float(((v**2).sum(axis=1) + 2 * height).max()))
    weights = np.array([1.0] * 3 + [1 / (max(math.sqrt(np.linalg.norm(pull)), fastest) or 1.0)] * 3)
    rates = np.array(np.broadcast_arrays(*model.derivatives(columns, k, np))).T
    speeds = np.linalg.norm(rates * weights, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return weights, np.clip(np.nan_to_num(fastest / speeds, nan=1.0), 1.0, MAX_SPEED_RATIO)


def _anchors(golden: Any, numbers: Any, k: Constants) -> Any:
    """Return the golden states in the variables of `momentum`, in the run's number type, shape (grid times, 6)."""
    columns = [_converted(golden.decimals(name), numbers) / k.length for name in STATE]
    start = FORMULATIONS["momentum"].start(tuple(columns[:3]), tuple(columns[3:]), k, np)
    return np.ascontiguousarray(np.array(start, dtype=numbers.dtype).T)


def _converted(values: Array | list[str], numbers: Any) -> Any:
    """Return doubles or printed decimals as numbers of the run's type, each rounded once."""
    if numbers.number == LONG_DOUBLE:
        return np.array(values, dtype=np.longdouble)
    return np.array([numbers.of(Fraction(value)) for value in values], dtype=numbers.dtype)
