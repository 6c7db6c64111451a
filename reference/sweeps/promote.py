"""A row solved by itself in as many digits as asked for: where double leaves a doubt, or for a level, or for an audit.

An audit solves a sample of the rows again: does the truth lie within the errors that were estimated?
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import FoucaultError
from ..scenes.fields import LEVELS, Level
from ..status import Status
from .estimate import columns_of, passages_listed
from .request import Request
from .row_constants import engine_rows
from .solved import outcomes_of

if TYPE_CHECKING:
    from ..solver.solution import Solution

LEAST_LEVEL: Level = "self_consistent"  # that settles a doubt
DIGITS = 17  # that show a double
AUDIT_DIGITS = 28  # at about 110 bits


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
