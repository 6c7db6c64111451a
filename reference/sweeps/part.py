"""A part of a sweep solved: the rows side by side, their errors, and by the solver those that ask for more."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..engines.batch_interface import OK, STOPPED, Batch, Outcomes, Rows
from ..engines.registry import batches
from ..errors import FoucaultError, InputError
from ..status import Status
from .axes import Listed
from .estimate import DEGREES_PER_HOUR, Errors, judged
from .promote import DOUBTFUL_REASON, Promoted, fill, promoted
from .request import Request
from .row import STATE_COLUMNS, TIMES, empty

Promote = Callable[..., Promoted]

STOPPED_REASON = "The engine stopped: the step became too short, or a number not finite."


@dataclass
class Part:
    """Rows with all columns, and what they cost.

    Attributes:
        columns: arrays of shape (rows,) by name; words are objects, None where there is none.
        transits: columns row, t_s and direction of every transit, if wanted.
        cpu_s: CPU seconds of the rows, in this thread and in the process that solves some of them by themselves.
        fold_s: of these, those of constants and releases.
    """

    columns: dict[str, Any]
    transits: dict[str, Any] = field(default_factory=dict)
    cpu_s: float = 0.0
    fold_s: float = 0.0

    def list_transits(self, row: int, times: Any, directions: Any) -> None:
        """List the transits of a row in the place of those that are listed."""
        before = self.transits["row"] < row
        after = self.transits["row"] > row
        new = {"row": np.full(len(times), row), "t_s": times, "direction": directions}
        self.transits = {
            name: np.concatenate([old[before], np.asarray(new[name], old.dtype), old[after]])
            for name, old in self.transits.items()
        }


def unsolved(request: Request, numbers: range) -> Part:
    """Return rows of which nothing is known but their numbers and the words among their values."""
    part = Part({column.name: empty(column, len(numbers)) for column in request.columns})
    part.columns["row"][:] = numbers
    part.columns["level"][:] = "computed"
    for key, words in request.table.words(numbers).items():
        part.columns[key][:] = words
    if request.wanted.times:
        part.transits = {"row": np.zeros(0, np.int64), "t_s": np.zeros(0), "direction": np.zeros(0, np.int8)}
    return part


def solve_part(request: Request, numbers: range, promote: Promote = promoted) -> Part:
    """Return rows solved; a row that fails says so, and the others go on.

    Args:
        request: the sweep.
        numbers: of the rows.
        promote: solves a row by itself, as `promoted` does, which is not made for several threads.
    """
    started = time.thread_time()
    table, part = request.table, unsolved(request, numbers)
    columns = part.columns
    wrong = table.wrong(numbers, request.scene.inputs) if isinstance(table, Listed) else {}
    for row, reason in wrong.items():
        _fail(columns, row - numbers.start, Status.INVALID, reason)
        for key in table.keys:
            _show(columns, key, row - numbers.start, table.texts(row)[key])
    good = np.array([row for row in numbers if row not in wrong], np.int64)
    before = time.thread_time()
    for key, values in table.numbers(good, request.scene.inputs).items():
        columns[key][good - numbers.start] = values.high
    rows = request.constants(good) if len(good) else None
    part.fold_s = time.thread_time() - before
    if rows is not None:
        _solve(request, part, good, rows, promote)
    part.cpu_s += time.thread_time() - started
    return part


def _solve(request: Request, part: Part, numbers: Any, rows: Rows, promote: Promote) -> None:
    """Solve rows whose values are right one by one."""
    columns, sound = part.columns, _finite(rows)
    places = numbers - int(columns["row"][0])
    more: dict[int, str] = {}  # places of rows that the solver has to solve, and why
    for at in np.flatnonzero(~sound):
        try:
            request.scene_of(int(numbers[at]))
            more[int(places[at])] = "A number of the scene is beyond the range of binary64."
        except InputError as error:
            _fail(columns, int(places[at]), Status.INVALID, str(error))
        except FoucaultError as error:
            _fail(columns, int(places[at]), Status.UNREACHABLE, str(error))
    kept, places = rows[np.flatnonzero(sound)], places[sound]
    if request.promotes:
        more |= dict.fromkeys(map(int, places), "")
    if len(places) and (request.wanted.apsides or not request.promotes):
        more |= _side_by_side(request, part, places, kept)
    for place, reason in sorted(more.items()):
        if reason == STOPPED_REASON and not request.promotes:
            _fail(columns, place, Status.GAVE_UP, reason)
            continue
        result = promote(request, int(columns["row"][place]), doubtful=bool(reason))
        part.cpu_s += result.cpu_s
        fill(columns, place, result, reason)
        if TIMES in request.want:
            part.list_transits(int(columns["row"][place]), *result.times)


def _side_by_side(request: Request, part: Part, places: Any, rows: Rows) -> dict[int, str]:
    """Solve rows side by side; return those that are in doubt, or not good enough, and why."""
    columns, wanted = part.columns, request.wanted
    more: dict[int, str] = {}
    damped = rows.drag[:, 0] != 0
    for engine, own in _shared(request.engine, damped):
        chosen = rows[own]
        run = engine.solve(chosen, wanted)
        found, lost = judged(engine, chosen, run)
        at = places[own]
        write(columns, at, chosen, run, found, engine.name)
        if wanted.times:
            _list_transits(part, at, run)
        stopped = (run.fate == STOPPED) | lost
        unsure = (run.fate != OK) | (found.undecided if wanted.transits else False)
        if request.tolerance is not None:
            unsure = unsure | ~(found.position <= request.tolerance)
        more |= dict.fromkeys(map(int, at[unsure]), DOUBTFUL_REASON)
        more |= dict.fromkeys(map(int, at[stopped]), STOPPED_REASON)
    return more


def _shared(name: str, damped: Any) -> list[tuple[Batch, Any]]:
    """Return engines with the rows that each solves: heyoka those with drag where the other has none."""
    engine, other = batches()[name], batches()["heyoka"]
    if engine.drag or not damped.any():
        return [(engine, np.arange(len(damped)))]
    both = [(engine, np.flatnonzero(~damped)), (other, np.flatnonzero(damped))]
    return [(one, own) for one, own in both if len(own)]


def write(columns: dict[str, Any], at: Any, rows: Rows, run: Outcomes, found: Errors, engine: str) -> None:
    """Write results into the columns that there are, at some places."""
    span, swings = run.t_last - run.t_first, run.apsis_last - run.apsis_first
    with np.errstate(divide="ignore", invalid="ignore"):
        precession = np.where(run.apsides > 1, run.turn / swings * DEGREES_PER_HOUR, np.nan)
        vertical = -rows.turn[:, 2, 0] * DEGREES_PER_HOUR
        values = {
            "status": np.full(len(rows), Status.OK.value, object),
            "engine": np.full(len(rows), engine, object),
            "steps": run.steps,
            "transits": run.transits,
            "close_pairs": run.close_pairs,
            "t_first_s": run.t_first,
            "t_last_s": run.t_last,
            "transit_error_s": found.transit,
            "frequency_hz": np.where(run.transits > 1, (run.transits - 1) / (2 * span), np.nan),
            "frequency_error_hz": found.frequency,
            "swing_hz": np.where(run.apsides > 1, (run.apsides - 1) / (2 * swings), np.nan),
            "swing_error_hz": found.swing,
            "precession_deg_per_h": precession,
            "precession_error_deg_per_h": found.precession,
            "precession_ratio": np.where(vertical != 0, precession / vertical, np.nan),
            **dict(zip(STATE_COLUMNS, run.state.T, strict=True)),
            "position_error_m": found.position,
            "velocity_error_m_s": found.velocity,
            "max_angle_deg": np.degrees(run.largest_angle),
            "max_angle_error_deg": found.angle,
        }
    for name, value in values.items():
        if name in columns:
            columns[name][at] = value


def _list_transits(part: Part, at: Any, run: Outcomes) -> None:
    """Add the transits of rows to those that are listed, in the order of the rows."""
    new = {
        "row": part.columns["row"][at][run.transit_row],
        "t_s": run.transit_t,
        "direction": run.transit_direction,
    }
    both = {name: np.concatenate([part.transits[name], new[name]]) for name in new}
    order = np.argsort(both["row"], kind="stable")
    part.transits = {name: values[order] for name, values in both.items()}


def _finite(rows: Rows) -> Any:
    numbers = (getattr(rows, name).reshape(len(rows), -1) for name in ("length", "drag", "turn", "pull", "n", "V"))
    sound = np.isfinite(np.concatenate(list(numbers), axis=1)).all(axis=1)
    return sound & (rows.n[:, :, 0] != 0).any(axis=1)


def _fail(columns: dict[str, Any], place: int, status: Status, reason: str) -> None:
    """Say why a row failed, and take its numbers away."""
    for name, values in columns.items():
        if name in ("row", "status", "reason", "level") or "." in name:
            continue
        values[place] = np.nan if values.dtype.kind == "f" else None if values.dtype == object else 0
    columns["status"][place], columns["reason"][place] = status.value, reason


def _show(columns: dict[str, Any], key: str, place: int, text: str) -> None:
    """Show a wrong value, where it is a number or a word."""
    try:
        columns[key][place] = text if columns[key].dtype == object else float(text)
    except ValueError:
        columns[key][place] = np.nan
