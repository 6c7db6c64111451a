"""A row solved by itself in as many digits as asked for: where double leaves a doubt, or for a level, or for an audit.

An audit solves a sample of the rows again: does the truth lie within the errors that were estimated?
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import FoucaultError
from ..numbers.columns import POSITION, STATE, VELOCITY
from ..scenes.scene import LEVELS, Level
from ..status import Status
from .parquet import STATE_COLUMNS
from .request import Request

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
    return Promoted(_values(solution), _times(solution))


def _values(solution: Solution) -> dict[str, Any]:
    """Return the columns that a solution gives."""
    grid, transits = solution.grid, solution.transits
    bounds = {name: grid.bound(name)[-1] for name in STATE}
    values: dict[str, Any] = {
        "level": solution.level,
        "engine": solution.run.engine,
        "digits": solution.scene.run.digits,
        "steps": solution.run.steps,
        **{name: grid[column][-1] for name, column in zip(STATE_COLUMNS, STATE, strict=True)},
        "position_error_m": _norm([bounds[name] for name in POSITION]),
        "velocity_error_m_s": _norm([bounds[name] for name in VELOCITY]),
        "transits": len(solution.directions),
    }
    names = ("t_first_s", "t_last_s", "frequency_hz", "frequency_error_hz", "transit_error_s")
    values |= dict.fromkeys(names, np.nan)
    if solution.directions:
        times, bound = transits.exact("t"), max(transits.bound("t"))
        values |= {"t_first_s": float(times[0]), "t_last_s": float(times[-1]), "transit_error_s": float(bound)}
        if len(times) > 1:
            span, gaps = times[-1] - times[0], len(times) - 1
            values["frequency_hz"] = float(Fraction(gaps) / (2 * span))
            values["frequency_error_hz"] = float(gaps * bound / span**2)
    return values


def _norm(bounds: list[Any]) -> float:
    return float(np.sqrt(sum(float(bound) ** 2 for bound in bounds)))


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
    """Return the largest error of a row over its estimate; infinite where its transits are miscounted."""
    truth = promoted(request, number, doubtful=False, level="computed", digits=AUDIT_DIGITS)
    if truth.failure:
        return np.inf
    values, ratios = truth.values, [0.0]
    if "x_m" in row:
        position = [row[name] - values[name] for name in STATE_COLUMNS[:3]]
        velocity = [row[name] - values[name] for name in STATE_COLUMNS[3:]]
        ratios += [
            float(np.linalg.norm(position)) / row["position_error_m"],
            float(np.linalg.norm(velocity)) / row["velocity_error_m_s"],
        ]
    if "transits" in row:
        if row["transits"] != values["transits"]:
            return np.inf
        for name in ("t_first_s", "t_last_s") if row["transits"] else ():
            ratios.append(abs(row[name] - values[name]) / row["transit_error_s"])
        if row["transits"] > 1 and "frequency_hz" in row:
            ratios.append(abs(row["frequency_hz"] - values["frequency_hz"]) / row["frequency_error_hz"])
    return max(ratios)
