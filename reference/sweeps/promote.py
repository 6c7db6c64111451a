"""A row solved by itself in as many digits as asked for: where double leaves a doubt, or for a level, or for an audit.

An audit solves a sample of the rows again: does the truth lie within the errors that were estimated?
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
from typing import Any

import numpy as np

from ..engines.batch_interface import CLOSE_PAIR, Outcomes, Rows
from ..errors import FoucaultError, UnreachableError
from ..numbers.columns import POSITION, STATE, VELOCITY
from ..numbers.precision import Array
from ..scenes.fields import LEVELS, Level
from ..scenes.scene import Scene
from ..solver.solution import Solution
from ..status import Status
from .estimate import Errors, columns_of, passages_listed
from .highest_points import HIGHEST, note_highest_points
from .request import Request
from .row_constants import engine_rows

LEAST_LEVEL: Level = "self_consistent"  # that settles a doubt
DIGITS = 17  # that show a double
AUDIT_DIGITS = 28  # at about 110 bits
# for highest points, whose height is of second order, also after a swing has died down
MORE_DIGITS = 11


def outcomes_of(solution: Solution, rows: Rows) -> tuple[Outcomes, Errors]:
    """Return what became of a row, and its errors; of its swing where the solution has its highest points."""
    grid, transits, run = solution.grid, solution.transits, Outcomes.empty(1)
    position, velocity = (_norm(grid.largest_bounds(), kind) for kind in (POSITION, VELOCITY))
    transit = frequency = np.full(1, np.nan)
    with np.errstate(all="ignore"):
        swing, precession, angle = note_highest_points(run, rows, solution, position)
        run.steps[0], run.state[0] = solution.run.steps, [grid[name][-1] for name in STATE]
        if transits is not None and solution.directions:
            t = transits["t"]
            run.transits[0], run.t_first[0], run.t_last[0] = len(t), t[0], t[-1]
            run.close_pairs[0] = np.count_nonzero(np.diff(t) < CLOSE_PAIR * 2 * np.pi / rows.rate)
            transit = float(max(transits.bound("t"))) + np.spacing(run.t_last)
            frequency = np.where(len(t) > 1, (len(t) - 1) * transit / (t[-1] - t[0]) ** 2, np.nan)
    none = np.zeros(1, bool)
    return run, Errors(
        position, velocity, transit, frequency, swing, precession, np.degrees(angle), none, none
    )


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
    request: Request,
    row: int,
    *,
    doubtful: bool,
    level: Level | None = None,
    digits: int | None = None,
) -> Promoted:
    """Return a row solved by itself.

    Args:
        request: the sweep.
        row: its number.
        doubtful: whether a doubt has to be settled: then at the level `LEAST_LEVEL` at least.
        level: a level instead of the request's.
        digits: digits instead of the request's.
    """
    level = level or request.level
    if doubtful:
        level = max(level, LEAST_LEVEL, key=LEVELS.index)
    digits = digits or request.digits or DIGITS
    try:
        settings = {"run.level": level, "run.transits": request.run_options.transits}
        solution = _solved(
            request.scene_of(row).with_values(settings), digits, request.run_options.apsides
        )
    except FoucaultError as error:
        return Promoted({}, ([], []), str(error))
    undecided = [word for word in request.sections if solution.sections[word].possible]
    if undecided:
        return Promoted(
            {},
            ([], []),
            f"{', '.join(undecided)}: the proof does not decide how many passages there are.",
        )
    times = [float(t) for t in solution.transits.exact("t")]
    return Promoted(_values(request, row, solution), (times, list(solution.directions)))


def _solved(scene: Scene, digits: int, swing: bool) -> Solution:
    """Return a scene solved, with its highest points where its swing is wanted and has them.

    A cone has none. With drag they take more digits.
    """
    from ..solver.solve import solve

    sections = scene.run.sections or ()
    if swing and HIGHEST not in sections:
        with suppress(UnreachableError):
            more = MORE_DIGITS if scene.exact.drag else 0
            return solve(scene, digits=digits + more, sections=[*sections, HIGHEST])
    return solve(scene, digits=digits)


def _values(request: Request, row: int, solution: Solution) -> dict[str, Any]:
    """Return the columns of a row that was solved."""
    rows = engine_rows(request.scene, request.table, [row])
    columns, _ = columns_of(rows, *outcomes_of(solution, rows))
    for word in request.sections:
        table, directions = (
            solution.sections[word].table,
            np.array(solution.sections[word].directions, int),
        )
        t = table["t"]
        error = np.array(
            [float(max(table.bound("t"), default=np.nan)) + np.spacing(np.max(t, initial=0))]
        )
        columns |= passages_listed(word, error, np.zeros(len(t), int), t, directions)[0]
    return {name: values[0] for name, values in columns.items()} | {
        "level": solution.level,
        "engine": solution.run.engine,
        "digits": solution.scene.run.digits,
    }


@dataclass(frozen=True)
class Audit:
    """Findings of an audit: rows solved again, those that were wrong, the largest error over its estimate, where.

    Rows that the solver refused in so many digits are neither right nor wrong.
    """

    rows: int
    wrong: tuple[int, ...]
    worst_ratio: float
    worst_row: int | None
    refused: tuple[int, ...] = ()


def audited(request: Request, read: Callable[[int], Mapping[str, Any]]) -> Audit:
    """Solve a sample of the rows again: the request says how many, its hash which.

    Args:
        request: the sweep.
        read: returns the columns of a part.
    """
    ratios: dict[int, float | None] = {}
    for part, numbers in groupby(sample(request), request.part_of):
        columns = read(part)
        for number in numbers:
            row = {
                name: values[number - part * request.rows_per_part]
                for name, values in columns.items()
            }
            if row["status"] == Status.OK.value and row["level"] == "computed":
                ratios[number] = worst_ratio(request, number, row)
    refused = tuple(number for number, ratio in ratios.items() if ratio is None)
    solved = {number: ratio for number, ratio in ratios.items() if ratio is not None}
    wrong = tuple(number for number, ratio in solved.items() if not ratio <= 1)
    worst = max(solved, key=lambda number: solved[number], default=None)
    return Audit(len(solved), wrong, solved[worst] if worst is not None else 0.0, worst, refused)


def sample(request: Request) -> list[int]:
    """Return the rows that are solved again, by the hash of the plan."""
    chosen: set[int] = set()
    tries = 0
    while len(chosen) < request.audit:
        text = f"{request.hash}:{tries}".encode()
        chosen.add(int.from_bytes(hashlib.sha256(text).digest()[:8], "big") % request.table.count)
        tries += 1
    return sorted(chosen)


def worst_ratio(request: Request, number: int, row: Mapping[str, Any]) -> float | None:
    """Return the largest error of a row over its estimate, or None where the solver refuses it.

    It is infinite where a count is wrong, or a number not there.
    """
    truth = promoted(request, number, doubtful=False, level="computed", digits=AUDIT_DIGITS)
    if truth.failure:
        return None
    values, ratios = truth.values, [0.0]
    for column in request.columns:
        name, error = column.name, column.error
        if column.kind == "int32" and name != "steps" and row[name] != values[name]:
            return np.inf
        if error and np.isfinite(values[name]):
            ratio = abs(row[name] - values[name]) / (row[error] + values[error])
            ratios.append(np.inf if np.isnan(ratio) else ratio)
    return max(ratios)
