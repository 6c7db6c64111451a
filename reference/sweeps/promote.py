"""Rows that the solver solves one at a time.

It solves rows that double leaves in doubt, all rows for a level or digits, and those of an audit.
An audit solves a sample of the rows again: does the truth lie within the estimated errors?
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
from typing import Any, Self

import numpy as np

from ..engines.batch_interface import CLOSE_PAIR, Outcomes, Rows
from ..errors import FoucaultError, UnreachableError
from ..numbers.columns import POSITION, STATE, VELOCITY
from ..numbers.precision import Array
from ..scenes.fields import LEVELS, Level
from ..scenes.scene import Scene
from ..solver.solution import Solution
from ..status import Status
from ..system.channel import ACTIVITY
from .estimate import Errors, SectionPassages, columns_of, passages_listed
from .highest_points import HIGHEST, SolvedPoints
from .request import Request
from .row_constants import engine_rows

_LEAST_LEVEL: Level = "self_consistent"  # that settles a doubt
_DIGITS = 17  # that show a double
_AUDIT_DIGITS = 28  # at about 110 bits
# for highest points, whose height is of second order, also after a swing has died down
_MORE_DIGITS = 11


def _outcomes_of(solution: Solution, rows: Rows) -> tuple[Outcomes, Errors]:
    """Return the results of a solved row and their errors, as an engine for many rows does.

    Those of the swing are there if the solution has its highest points.
    """
    run = Outcomes.empty(1)
    run.steps[0] = solution.run.steps
    run.state[0] = [solution.grid[name][-1] for name in STATE]
    bounds = solution.grid.largest_bounds()
    position = _norm(bounds, POSITION)
    with np.errstate(all="ignore"):
        points = SolvedPoints.of(solution, rows)
        points.fill(run)
        swing, precession = points.errors_of_swing(run)
        angle = points.error_of_angle(run, position)
        transit, frequency = _fill_transits(run, solution, rows)
    none = np.zeros(1, bool)
    errors = Errors(
        position=position,
        velocity=_norm(bounds, VELOCITY),
        transit=transit,
        frequency=frequency,
        swing=swing,
        precession=precession,
        angle=np.degrees(angle),
        undecided=none,
        unsure_of_highest=none,
    )
    return run, errors


def _fill_transits(run: Outcomes, solution: Solution, rows: Rows) -> tuple[Array, Array]:
    """Fill in the transits; return the errors of their times in s and of their frequency in Hz."""
    if not solution.directions:
        return np.full(1, np.nan), np.full(1, np.nan)
    table = solution.transits
    t = table["t"]
    run.transits[0] = len(t)
    run.t_first[0] = t[0]
    run.t_last[0] = t[-1]
    run.close_pairs[0] = np.count_nonzero(np.diff(t) < CLOSE_PAIR * 2 * np.pi / rows.rate)

    error = float(max(table.bound("t"))) + np.spacing(run.t_last)
    frequency_error = (len(t) - 1) * error / (t[-1] - t[0]) ** 2
    return error, np.where(len(t) > 1, frequency_error, np.nan)


def _norm(parts: Mapping[str, Fraction], names: Iterable[str]) -> Array:
    """Return the length of a vector with these parts, shape (1,)."""
    return np.array([np.sqrt(sum(float(parts[name]) ** 2 for name in names))])


@dataclass(frozen=True)
class Promoted:
    """A row as solved by the solver, or the reason why the solver failed.

    Attributes:
        values: its columns by name.
        times: the times of its transits in s, and their directions.
        failure: why there are none; "" if there are.
        cpu_s: CPU seconds of another process that solved it, with those that it started.
    """

    values: dict[str, Any]
    times: tuple[list[float], list[int]]
    failure: str = ""
    cpu_s: float = 0.0

    @classmethod
    def failed(cls, reason: str) -> Self:
        """Return a row that could not be solved."""
        return cls({}, ([], []), reason)


def promoted(
    request: Request,
    row: int,
    *,
    doubtful: bool,
    level: Level | None = None,
    digits: int | None = None,
) -> Promoted:
    """Return a row solved by the solver.

    Args:
        request: the sweep.
        row: its number.
        doubtful: whether a doubt has to be settled: then at the level `_LEAST_LEVEL` at least.
        level: a level instead of the request's.
        digits: digits instead of the request's.
    """
    level = level or request.level
    if doubtful:
        level = max(level, _LEAST_LEVEL, key=LEVELS.index)
    digits = digits or request.digits or _DIGITS
    options = request.run_options
    try:
        settings = {"run.level": level, "run.transits": options.transits}
        scene = request.scene_of(row).with_values(settings)
        solution = _solved(scene, digits, options.apsides)
    except FoucaultError as error:
        return Promoted.failed(str(error))

    undecided = [word for word in request.sections if solution.sections[word].possible]
    if undecided:
        words = ", ".join(undecided)
        return Promoted.failed(f"{words}: the proof does not decide how many passages there are.")
    times = [float(t) for t in solution.transits.exact("t")]
    return Promoted(_values(request, row, solution), (times, list(solution.directions)))


def _solved(scene: Scene, digits: int, swing: bool) -> Solution:
    """Return a scene solved, with its highest points if its swing is wanted and it has one."""
    from ..solver.solve import solve

    sections = scene.run.sections or ()
    if swing and HIGHEST not in sections:
        with suppress(UnreachableError):
            more = _MORE_DIGITS if scene.exact.drag else 0
            return solve(scene, digits=digits + more, sections=[*sections, HIGHEST])
    return solve(scene, digits=digits)


def _values(request: Request, row: int, solution: Solution) -> dict[str, Any]:
    """Return the columns of a row that was solved."""
    rows = engine_rows(request.scene, request.table, [row])
    run, errors = _outcomes_of(solution, rows)
    columns, _ = columns_of(rows, run, errors)
    for word in request.sections:
        columns |= _columns_of_section(word, solution)
    values = {name: column[0] for name, column in columns.items()}
    return values | {
        "level": solution.level,
        "engine": solution.run.engine,
        "digits": solution.scene.run.digits,
    }


def _columns_of_section(word: str, solution: Solution) -> dict[str, Any]:
    """Return the columns of a section of a row that was solved, shape (1,)."""
    section = solution.sections[word]
    t = section.table["t"]
    bound = float(max(section.table.bound("t"), default=np.nan))
    error = bound + np.spacing(np.max(t, initial=0))
    passages = SectionPassages(
        row=np.zeros(len(t), int), t=t, direction=np.array(section.directions, int)
    )
    columns, _ = passages_listed(word, np.array([error]), passages)
    return columns


@dataclass(frozen=True)
class RowAudit:
    """Findings of an audit.

    A row that the solver refuses in so many digits is neither right nor wrong.

    Attributes:
        rows: how many rows were solved again.
        wrong: the numbers of those that lie outside of their errors.
        worst_ratio: the largest error over its estimate.
        worst_row: the row of that error; None if no row was solved again.
        refused: the numbers of rows that the solver refused.
    """

    rows: int
    wrong: tuple[int, ...]
    worst_ratio: float
    worst_row: int | None
    refused: tuple[int, ...] = ()


def audited(
    request: Request,
    read: Callable[[int], Mapping[str, Any]],
    report: Callable[[int], None] = lambda _: None,
) -> RowAudit:
    """Solve a sample of the rows again; the request sets its size, and the request's hash selects the rows.

    Args:
        request: the sweep.
        read: returns the columns of a part.
        report: called with the number of rows that are done.
    """
    ratios: dict[int, float] = {}
    refused = []
    done = 0
    report(done)
    for part, numbers in groupby(_sample(request), request.part_of):
        columns = read(part)
        first = part * request.rows_per_part
        for number in numbers:
            report(done)
            done += 1
            row = {name: values[number - first] for name, values in columns.items()}
            if row["status"] != Status.OK.value or row["level"] != "computed":
                continue
            # what the solver is doing matters less than that this is the audit
            with ACTIVITY.heard_by(lambda _: None):
                ratio = _worst_ratio(request, number, row)
            if ratio is None:
                refused.append(number)
            else:
                ratios[number] = ratio
    report(done)

    worst_row = max(ratios, key=lambda number: ratios[number], default=None)
    return RowAudit(
        rows=len(ratios),
        wrong=tuple(number for number, ratio in ratios.items() if not ratio <= 1),
        worst_ratio=0.0 if worst_row is None else ratios[worst_row],
        worst_row=worst_row,
        refused=tuple(refused),
    )


def _sample(request: Request) -> list[int]:
    """Return the rows that are solved again, by the hash of the plan."""
    chosen: set[int] = set()
    tries = 0
    while len(chosen) < request.audit:
        digest = hashlib.sha256(f"{request.hash}:{tries}".encode()).digest()
        chosen.add(int.from_bytes(digest[:8], "big") % request.table.count)
        tries += 1
    return sorted(chosen)


def _worst_ratio(request: Request, number: int, row: Mapping[str, Any]) -> float | None:
    """Return the largest error of a row over its estimate, or None where the solver refuses it.

    It is infinite where a count is wrong or a number is missing.
    """
    truth = promoted(request, number, doubtful=False, level="computed", digits=_AUDIT_DIGITS)
    if truth.failure:
        return None
    values = truth.values
    ratios = [0.0]
    for column in request.columns:
        name = column.name
        error_name = column.error
        is_count = column.kind == "int32" and name != "steps"
        if is_count and row[name] != values[name]:
            return np.inf
        if error_name and np.isfinite(values[name]):
            error = abs(row[name] - values[name])
            ratio = error / (row[error_name] + values[error_name])
            if np.isnan(ratio):
                ratio = np.inf
            ratios.append(ratio)
    return max(ratios)
