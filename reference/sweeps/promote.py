"""A row solved by itself in as many digits as asked for: where double leaves a doubt, or for a level, or for an audit.

An audit solves a sample of the rows again: does the truth lie within the errors that were estimated? Highest points
are zeros of the height's rate in the Taylor steps of further runs: the finer of two gives them, the coarser their
errors. Between its extremes the rate is monotone, so that signs miss none; they are zeros of its derivative, found
alike.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
from math import factorial
from typing import Any, Self

import numpy as np

from ..engines.batch_interface import CLOSE_PAIR, Outcomes, PlumbAxes, Rows, plumb_line
from ..engines.registry import fastest
from ..engines.row_zeros import HEIGHT, RowMotion, RowRelease, RowZeros, Samples, describe_highest_points
from ..errors import FoucaultError, IntegrationError
from ..model.constants import constants
from ..numbers.columns import POSITION, STATE, VELOCITY
from ..numbers.precision import GUARD_BITS, Array, context
from ..numbers.taylor_step import EARTH, TaylorStep
from ..scenes.fields import LEVELS, Level
from ..scenes.inputs import Inputs
from ..solver.proof_steps import COEFFICIENT_BITS
from ..solver.solution import Solution
from ..status import Status
from .estimate import Errors, columns_of, of_swing, passages_listed
from .request import Request
from .row_constants import engine_rows

LEAST_LEVEL: Level = "self_consistent"  # that settles a doubt
DIGITS = 17  # that show a double
AUDIT_DIGITS = 28  # at about 110 bits
PRECS = (128, 256, 384)  # bits of the runs: two in turn, until they differ by rounding alone
SAFETY = 4  # times what two runs differ by
SAMPLES = 8  # of a step, at which signs of the derivative `TOP` of the height are compared
TOP = 4
MOST_REFINEMENTS = 60  # of a zero: a step of Newton's method that leaves its bracket halves it
NEGLIGIBLE = 2.0**-64  # coefficients beside the largest, in double
ROUNDING = 2.0**-48  # of the sum of a polynomial's terms in double


@dataclass(frozen=True)
class PlumbCourse:
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
            x, m, w, *_ = (np.array(row, object) for row in step.coefficients)
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

    def at(self, times: Array) -> RowMotion:
        """Return the motion at some times."""
        return RowMotion(*map(tuple, self.derivatives(times)[:3]))

    def crossings(self, order: int, times: Array, first: float = 0.0) -> RowZeros:
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
        return RowZeros(t, -sign)


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
    course = PlumbCourse.of(engine.taylor_steps(inputs, solution.times, prec, prec + COEFFICIENT_BITS), inputs)
    release = RowRelease.of(rows, PlumbAxes.of(rows), 0, course.at(np.zeros(1))[0])
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


@dataclass(frozen=True)
class Promoted:
    """A row as the solver gives it: its columns by name and its transits, or the reason why it could not.

    `cpu_s` are the CPU seconds of another process that solved it, with those that it started.
    """

    values: dict[str, Any]
    times: tuple[list[float], list[int]]
    failure: str = ""
    cpu_s: float = 0.0


def promoted(
    request: Request, row: int, *, doubtful: bool, level: Level | None = None, digits: int | None = None
) -> Promoted:
    """Return a row solved by itself.

    Args:
        request: the sweep.
        row: its number.
        doubtful: whether a doubt has to be settled: then at the level `LEAST_LEVEL` at least.
        level: a level instead of the request's.
        digits: digits instead of the request's.
    """
    from ..solver.solve import solve

    wished = level or request.level
    if doubtful:
        wished = max(wished, LEAST_LEVEL, key=LEVELS.index)
    digits = digits or request.digits or DIGITS
    try:
        scene = request.scene_of(row)
        solution = solve(scene, level=wished, digits=digits, transits=request.wanted.transits)
    except FoucaultError as error:
        return Promoted({}, ([], []), str(error))
    undecided = [word for word, found in solution.sections.items() if found.possible]
    if undecided:
        return Promoted({}, ([], []), f"{', '.join(undecided)}: the proof does not decide how many passages there are.")
    return Promoted(_values(request, row, solution), _times(solution))


def _values(request: Request, row: int, solution: Solution) -> dict[str, Any]:
    """Return the columns of a row that was solved."""
    rows = engine_rows(request.scene, request.table, [row])
    columns, _ = columns_of(rows, *outcomes_of(solution, rows, request.wanted.apsides))
    for word, found in solution.sections.items():
        t, directions = found.table["t"], np.array(found.directions, int)
        error = np.array([float(max(found.table.bound("t"), default=np.nan)) + np.spacing(np.max(t, initial=0))])
        columns |= passages_listed(word, error, np.zeros(len(t), int), t, directions)[0]
    return {name: values[0] for name, values in columns.items()} | {
        "level": solution.level,
        "engine": solution.run.engine,
        "digits": solution.scene.run.digits,
    }


def _times(solution: Solution) -> tuple[list[float], list[int]]:
    return [float(t) for t in solution.transits.exact("t")], list(solution.directions)


@dataclass(frozen=True)
class Audit:
    """Findings of an audit: rows solved again, those that were wrong, the largest error over its estimate, where."""

    rows: int
    wrong: tuple[int, ...]
    worst_ratio: float
    worst_row: int | None


def audited(request: Request, read: Callable[[int], Mapping[str, Any]]) -> Audit:
    """Solve a sample of the rows again: the request says how many, its hash which.

    Args:
        request: the sweep.
        read: returns the columns of a part.
    """
    ratios = {}
    for part, numbers in groupby(sample(request), request.part_of):
        columns = read(part)
        for number in numbers:
            row = {name: values[number - part * request.rows_per_part] for name, values in columns.items()}
            if row["status"] == Status.OK.value and row["level"] == "computed":
                ratios[number] = worst_ratio(request, number, row)
    wrong = tuple(number for number, ratio in ratios.items() if not ratio <= 1)
    worst = max(ratios, key=lambda number: ratios[number], default=None)
    return Audit(len(ratios), wrong, ratios[worst] if worst is not None else 0.0, worst)


def sample(request: Request) -> list[int]:
    """Return the rows that are solved again, by the hash of the plan."""
    chosen: set[int] = set()
    tries = 0
    while len(chosen) < request.audit:
        text = f"{request.hash}:{tries}".encode()
        chosen.add(int.from_bytes(hashlib.sha256(text).digest()[:8], "big") % request.table.count)
        tries += 1
    return sorted(chosen)


def worst_ratio(request: Request, number: int, row: Mapping[str, Any]) -> float:
    """Return the largest error of a row over its estimate; infinite where a count is wrong, or a number not there."""
    truth = promoted(request, number, doubtful=False, level="computed", digits=AUDIT_DIGITS)
    if truth.failure:
        return np.inf
    values, ratios = truth.values, [0.0]
    for column in request.columns:
        name, error = column.name, column.error
        if column.kind == "int32" and name != "steps" and row[name] != values[name]:
            return np.inf
        if error and np.isfinite(values[name]):
            ratio = abs(row[name] - values[name]) / (row[error] + values[error])
            ratios.append(np.inf if np.isnan(ratio) else ratio)
    return max(ratios)
