"""A row that the solver solved, described as an engine describes its own.

Highest points are zeros of the height's rate in the Taylor steps of further runs: the finer of two gives them, the
coarser their errors. Between its extremes the rate is monotone, so that signs miss none; they are zeros of its
derivative, and found alike.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import TYPE_CHECKING, Self

import numpy as np

from ..engines.batch_interface import CLOSE_PAIR, Outcomes, PlumbAxes, Rows, plumb_line
from ..engines.registry import fastest
from ..engines.row_zeros import HEIGHT, Motion, Release, Samples, Zeros, describe_highest_points
from ..errors import IntegrationError
from ..model.constants import constants
from ..numbers.columns import POSITION, STATE, VELOCITY
from ..numbers.precision import GUARD_BITS, Array, context
from ..numbers.taylor_step import EARTH, TaylorStep
from ..scenes.inputs import Inputs
from ..solver.proof_steps import COEFFICIENT_BITS
from .estimate import Errors, of_swing

if TYPE_CHECKING:
    from ..solver.solution import Solution

PRECS = (128, 256, 384)  # bits of the runs: two in turn, until they differ by rounding alone
SAFETY = 4  # times what two runs differ by
SAMPLES = 8  # of a step, at which signs of the derivative `TOP` of the height are compared
TOP = 4
MOST_REFINEMENTS = 60  # of a zero: a step of Newton's method that leaves its bracket halves it
NEGLIGIBLE = 2.0**-64  # coefficients beside the largest, in double
ROUNDING = 2.0**-48  # of the sum of a polynomial's terms in double


@dataclass(frozen=True)
class Course:
    """The motion in the axes of the plumb line: when steps begin, their units h in s, and n's series, (steps, 3, …)."""

    starts: Array
    h: Array
    series: Array

    @classmethod
    def of(cls, steps: Iterable[TaylorStep], inputs: Inputs) -> Self:
        """Turn steps to these axes exactly: of a swing however small the rate of the height keeps its digits."""
        rows: list[Array] = []
        places = []
        for step in steps:
            if not rows:
                one, (a, b) = 1 << step.bits, _axes(step, inputs)
            x, m, w = (np.array(step.coefficients[i], object) for i in range(3))
            # doubles at once: the integers of a day's steps fill gigabytes
            rows.append((np.array([x, (b * m - a * w) // one, (a * m + b * w) // one]) / one).astype(float))
            places.append((float(step.centre), float(step.h)))
        series, (starts, h) = np.array(rows), np.array(places).T
        sizes = np.abs(series).max(axis=0)
        needed = np.flatnonzero((sizes > NEGLIGIBLE * sizes[:, 1:].max(axis=1, keepdims=True)).any(axis=0))[-1] + 1
        return cls(starts, h, series[:, :, :needed])

    def derivatives(self, times: Array) -> list[Array]:
        """Return n and its derivatives to `TOP` and one more, each of shape (3, times)."""
        step = np.maximum(np.searchsorted(self.starts, times, "right") - 1, 0)
        h = self.h[step]
        s, sums = (times - self.starts[step]) / h, [np.zeros((3, len(times)))] * (TOP + 2)
        for k in range(self.series.shape[2] - 1, -1, -1):
            sums = [total * s + lower for total, lower in zip(sums, [self.series[step, :, k].T, *sums], strict=False)]
        return [part * factorial(i) / h**i for i, part in enumerate(sums)]

    def rounding(self, times: Array) -> tuple[Array, Array]:
        """Return what sums in double may leave out of the distance from the plumb line over l, and of the rate u'."""
        step = np.maximum(np.searchsorted(self.starts, times, "right") - 1, 0)
        sizes = ROUNDING * np.abs(self.series[step])
        return sizes[:, :2].sum(axis=(1, 2)), sizes[:, 2] @ np.arange(sizes.shape[2]) / self.h[step]

    def at(self, times: Array) -> Motion:
        """Return the motion at some times."""
        return Motion(*map(tuple, self.derivatives(times)[:3]))

    def crossings(self, order: int, times: Array, first: float = 0.0) -> Zeros:
        """Return the zeros of a derivative of the height that signs at times tell; `first` replaces the first sign."""
        values = self.derivatives(times)[order][2]
        values[0] = first or values[0]
        times, values = times[values != 0], values[values != 0]  # a zero may be hit, and has no sign
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


def _axes(step: TaylorStep, inputs: Inputs) -> tuple[int, int]:
    """Return the plumb line's two components in the axes of a step, as integers in units of 2^-bits."""
    ctx = context(step.bits + GUARD_BITS)
    k = constants(inputs, ctx)
    up = plumb_line(*k.pull[1:], ctx.norm(k.pull), 0)
    if step.columns == EARTH and k.rate:
        up = up[0] * k.sin - up[1] * k.cos, up[0] * k.cos + up[1] * k.sin
    return int(up[0] * (1 << step.bits)), int(up[1] * (1 << step.bits))


def outcomes_of(solution: Solution, rows: Rows, apsides: bool) -> tuple[Outcomes, Errors]:
    """Return what became of a row, and its errors; `apsides` says whether its highest points are wanted."""
    grid, transits, run = solution.grid, solution.transits, Outcomes.empty(1)
    late = turned = leaning = transit = frequency = np.full(1, np.nan)
    with np.errstate(all="ignore"):
        if apsides and 0 < rows.rate < np.inf:
            run, (late, turned, leaning) = _highest(rows, solution)
        run.steps[0], run.state[0] = solution.run.steps, [grid[name][-1] for name in STATE]
        if transits is not None and solution.directions:
            t = transits["t"]
            run.transits[0], run.t_first[0], run.t_last[0] = len(t), t[0], t[-1]
            run.close_pairs[0] = np.count_nonzero(np.diff(t) < CLOSE_PAIR * 2 * np.pi / rows.rate)
            transit = float(max(transits.bound("t"))) + np.spacing(run.t_last)
            frequency = np.where(len(t) > 1, (len(t) - 1) * transit / (t[-1] - t[0]) ** 2, np.nan)
        swing = of_swing(run, late, turned)
    none = np.zeros(1, bool)
    position, velocity = (_norm(grid.largest_bounds(), kind) for kind in (POSITION, VELOCITY))
    return run, Errors(position, velocity, transit, frequency, *swing, np.degrees(leaning), none, none)


def _highest(rows: Rows, solution: Solution) -> tuple[Outcomes, Array]:
    """Return the highest points, and how late, turned and leaning they may be, in s and rad, shape (3, 1)."""
    run, errors, before = Outcomes.empty(1), np.full((3, 1), np.nan), np.full((5, 1), np.inf)
    for prec in PRECS:
        try:
            run, rounding = _of_run(rows, solution, prec)
        except IntegrationError:
            continue
        seen = np.array([run.apsides, run.apsis_first, run.apsis_last, run.turn, run.largest_angle])
        (count, first, *others), before = np.abs(seen - before), seen
        gaps = np.array([np.fmax(first, others[0]), *others[1:]])
        errors = SAFETY * gaps + rounding + np.where(count > 0, np.inf, 0.0)
        if not (count > 0) and not (gaps > rounding).any():
            break
    return run, errors


def _of_run(rows: Rows, solution: Solution, prec: int) -> tuple[Outcomes, Array]:
    """Return the highest points of a run, and what rounding may do to their times, their turn and the largest angle."""
    run, inputs = Outcomes.empty(1), solution.scene.exact
    engine = fastest(prec, steps=solution.run.steps)
    course = Course.of(engine.taylor_steps(inputs, solution.times, prec, prec + COEFFICIENT_BITS), inputs)
    release = Release.of(rows, PlumbAxes.of(rows), 0, course.at(np.zeros(1))[0])
    times = np.linspace(0, release.end, SAMPLES * len(course.starts) + 1)
    samples = Samples(times, course.at(times), complete=True)
    for order in range(TOP, 1, -1):
        times = np.sort(np.concatenate([times, course.crossings(order, times).times]))
    zeros = course.crossings(1, times, release.signs[HEIGHT])
    describe_highest_points(run, 0, release, zeros, course.at(zeros.times), samples)
    t = zeros.times[zeros.directions < 0]
    reach, slow = course.rounding(t)
    (x, p, _), (vx, vp, _), (*_, fall) = course.derivatives(t)[:3]
    late = slow / -fall + 2 * np.spacing(t)
    turned = reach / np.hypot(x, p) + np.abs(x * vp - p * vx) / (x * x + p * p) * late
    leaning = course.rounding(course.starts)[0]
    return run, np.array([[2 * np.max(late, initial=0)], [4 * np.max(turned, initial=0)], [2 * leaning.max()]])


def _norm(parts: Mapping[str, Fraction], names: Iterable[str]) -> Array:
    return np.array([np.sqrt(sum(float(parts[name]) ** 2 for name in names))])
