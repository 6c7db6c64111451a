"""A row that the solver solved, described as an engine describes its own.

Highest points are zeros of the height's rate in the Taylor steps of one more run. Between its extremes the rate is
monotone, so that signs miss none; they are zeros of its derivative, and found alike.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import factorial
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from ..engines.batch_interface import CLOSE_PAIR, Outcomes, PlumbAxes, Rows, plumb_line
from ..engines.plan import Run
from ..engines.registry import fastest
from ..engines.row_zeros import HEIGHT, Motion, Release, Samples, Zeros, describe_highest_points
from ..errors import IntegrationError
from ..model.constants import constants
from ..numbers.columns import GRID, POSITION, STATE, VELOCITY
from ..numbers.precision import GUARD_BITS, Array, context
from ..numbers.taylor_step import EARTH, TaylorStep
from ..scenes.inputs import Inputs
from ..solver.proof_steps import COEFFICIENT_BITS
from .estimate import Errors, errors, shrunk

if TYPE_CHECKING:
    from ..solver.solution import Solution

PRECS = (128, 384)  # bits of that run: the second where errors grow too large in the first, or the swing dies down
DIES = 2.0**-8  # of the amplitude: what is left of it
AGREED = 2.0**-60  # of the cord length: the largest distance from the solver's state at the end
SAFETY = 4  # errors inside the span may exceed the one at its end
SAMPLES = 8  # of a step, at which signs of the derivative `TOP` of the height are compared
TOP = 4
MOST_REFINEMENTS = 60  # of a zero: a step of Newton's method that leaves its bracket halves it
NEGLIGIBLE = 2.0**-64  # coefficients beside the largest, in double
ROUNDING = 2.0**-49  # of the motion, where a polynomial is summed in double


@dataclass(frozen=True)
class Course:
    """The motion in the axes of the plumb line: when steps begin, their units h in s, and n's series, (steps, 3, …)."""

    starts: Array
    h: Array
    series: Array

    @classmethod
    def of(cls, steps: list[TaylorStep], inputs: Inputs) -> Self:
        """Turn steps to these axes exactly: of a swing however small the rate of the height keeps its digits."""
        bits = steps[0].bits
        ctx = context(bits + GUARD_BITS)
        k = constants(inputs, ctx)
        up = plumb_line(*k.pull[1:], ctx.norm(k.pull), 0)
        if steps[0].columns == EARTH and k.rate:
            up = up[0] * k.sin - up[1] * k.cos, up[0] * k.cos + up[1] * k.sin
        one = 1 << bits
        a, b = (int(part * one) for part in up)
        rows = np.array([[step.coefficients[i] for i in range(3)] for step in steps], object)
        x, m, w = np.moveaxis(rows, 1, 0)
        series = np.stack([x, (b * m - a * w) // one, (a * m + b * w) // one], axis=1).astype(float) / one
        sizes = np.abs(series).max(axis=0)
        needed = np.flatnonzero((sizes > NEGLIGIBLE * sizes[:, 1:].max(axis=1, keepdims=True)).any(axis=0))[-1] + 1
        starts, h = (np.array([float(getattr(step, name)) for step in steps]) for name in ("centre", "h"))
        return cls(starts, h, series[:, :, :needed])

    def derivatives(self, times: Array) -> list[Array]:
        """Return n and its derivatives to `TOP` and one more, each of shape (3, times)."""
        step = np.maximum(np.searchsorted(self.starts, times, "right") - 1, 0)
        h = self.h[step]
        s, sums = (times - self.starts[step]) / h, [np.zeros((3, len(times)))] * (TOP + 2)
        for k in range(self.series.shape[2] - 1, -1, -1):
            sums = [total * s + lower for total, lower in zip(sums, [self.series[step, :, k].T, *sums], strict=False)]
        return [part * factorial(i) / h**i for i, part in enumerate(sums)]

    def at(self, times: Array) -> Motion:
        """Return the motion at some times."""
        return Motion(*map(tuple, self.derivatives(times)[:3]))

    def crossings(self, order: int, times: Array, first: float = 0.0) -> Zeros:
        """Return the zeros of a derivative of the height that signs at times tell; `first` replaces the first sign."""
        values = self.derivatives(times)[order][2]
        values[0] = first or values[0]
        before = np.flatnonzero(values[:-1] * values[1:] < 0)
        low, high, sign = times[before], times[before + 1], np.sign(values[before])
        t = (low + high) / 2
        for _ in range(MOST_REFINEMENTS):
            value, slope = (part[2] for part in self.derivatives(t)[order : order + 2])
            same = value * sign > 0
            low, high, last = np.where(same, t, low), np.where(same, high, t), t
            t = t - value / slope
            t = np.where((low < t) & (t < high), t, (low + high) / 2)
            if (np.abs(t - last) <= np.spacing(t)).all():
                break
        return Zeros(t, -sign)


def outcomes_of(solution: Solution, rows: Rows, apsides: bool) -> tuple[Outcomes, Errors]:
    """Return what became of a row, and its errors; `apsides` says whether its highest points are wanted."""
    grid, transits, run = solution.grid, solution.transits, Outcomes.empty(1)
    run.steps[0], run.state[0] = solution.run.steps, [grid[name][-1] for name in STATE]
    bounds = grid.largest_bounds()
    position, velocity = (_norm(bounds, kind) for kind in (POSITION, VELOCITY))
    late, frequency = np.full(1, np.nan), np.full(1, np.nan)
    with np.errstate(all="ignore"):
        if transits is not None and solution.directions:
            t = transits["t"]
            run.transits[0], run.t_first[0], run.t_last[0] = len(t), t[0], t[-1]
            run.close_pairs[0] = np.count_nonzero(np.diff(t) < CLOSE_PAIR * 2 * np.pi / rows.rate)
            late = float(max(transits.bound("t"))) + np.spacing(run.t_last)
            frequency = np.where(len(t) > 1, (len(t) - 1) * late / (t[-1] - t[0]) ** 2, np.nan)
        gaps = _find_highest(run, rows, solution) if apsides and 0 < rows.rate < np.inf else (0.0, 0.0)
        reach = ROUNDING * shrunk(rows) * np.sin(np.fmin(run.largest_angle, np.pi / 2)) * rows.length[:, 0]
        lean = run.largest_angle + np.arctan2(np.abs(rows.pull[:, 1, 0]), -rows.pull[:, 2, 0])
        on_sphere = np.where(lean < np.pi / 3, 2 * _norm(bounds, POSITION[:2]), position)  # z follows from x and y
        inside = (on_sphere + SAFETY * gaps[0] + reach, velocity + SAFETY * gaps[1] + reach * rows.rate)
        found = errors(rows, run, *inside)
    return run, replace(found, position=position, velocity=velocity, transit=late, frequency=frequency)


def _find_highest(run: Outcomes, rows: Rows, solution: Solution) -> tuple[Any, Any]:
    """Fill in the highest points, if that can be; return how far their run ends from the solver's, in m and m/s."""
    inputs = solution.scene.exact
    for prec in PRECS[int(shrunk(rows)[0] < DIES) :]:
        try:
            steps, own = _steps(inputs, solution, prec)
        except IntegrationError:
            continue
        gap = own.grid.only(GRID).distance(solution.grid).largest()
        if max(gap[name] for name in POSITION) <= AGREED * inputs.length:
            break
    else:
        return 0.0, 0.0
    course = Course.of(steps, inputs)
    release = Release.of(rows, PlumbAxes.of(rows), 0, course.at(np.zeros(1))[0])
    times = np.linspace(0, release.end, SAMPLES * len(steps) + 1)
    samples = Samples(times, course.at(times), course.at)
    for order in range(TOP, 1, -1):
        times = np.sort(np.concatenate([times, course.crossings(order, times).times]))
    zeros = course.crossings(1, times, release.signs[HEIGHT])
    describe_highest_points(run, 0, release, zeros, course.at(zeros.times), samples)
    return _norm(gap, POSITION), _norm(gap, VELOCITY)


def _steps(inputs: Inputs, solution: Solution, prec: int) -> tuple[list[TaylorStep], Run]:
    """Return the Taylor steps of a run, and the run."""
    runs = []

    def collect() -> Generator[TaylorStep]:
        engine = fastest(prec, steps=solution.run.steps)
        runs.append((yield from engine.taylor_steps(inputs, solution.times, prec, prec + COEFFICIENT_BITS)))

    return list(collect()), runs[0]


def _norm(parts: Mapping[str, Fraction], names: Iterable[str]) -> Array:
    return np.array([np.sqrt(sum(float(parts[name]) ** 2 for name in names))])
