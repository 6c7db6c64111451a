"""Solve a part of a sweep: its rows side by side, with their errors, and some rows by the solver."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..engines.batch_interface import OK, STOPPED, Batch, Rows
from ..engines.registry import batches
from ..errors import FoucaultError, InputError
from ..status import Status
from .axes import WORD_FIELDS
from .estimate import columns_of, errors_by_moved_runs, passages
from .parquet import TRANSIT_COLUMNS
from .promote import Promoted, promoted
from .request import Request
from .row_constants import engine_rows

Promote = Callable[..., Promoted]

_DOUBTFUL_REASON = "The number of transits or passages, or the error, is not decided in double."
_STOPPED_REASON = "The engine stopped: the step became too short, or a number not finite."
_KNOWN = ("row", "status", "reason", "level")  # columns that a row has which failed


@dataclass
class Tally:
    """Counts of rows by status, and their costs.

    Attributes:
        counts: of rows.
        cpu_s: CPU seconds of the rows, in this thread and in the process that solves some of them
            by themselves.
        fold_s: of these, those of constants and releases.
        store_s: CPU seconds of writing them.
        promoted: rows that the solver was given.
        promoted_s: of `cpu_s`, those of these rows.
    """

    counts: Counter[str] = field(default_factory=Counter)
    cpu_s: float = 0.0
    fold_s: float = 0.0
    store_s: float = 0.0
    promoted: int = 0
    promoted_s: float = 0.0

    def __add__(self, other: Tally) -> Tally:
        return Tally(**{name: value + vars(other)[name] for name, value in vars(self).items()})


@dataclass
class Part:
    """Rows with all columns.

    Attributes:
        columns: arrays of shape (rows,) by name; words are objects, None where there is none.
        transits: columns row, t_s and direction of every transit, if wanted.
        tally: counts and costs.
        nothing: what the columns of a row hold that failed.
    """

    columns: dict[str, Any] = field(default_factory=dict)
    transits: dict[str, Any] = field(default_factory=dict)
    tally: Tally = field(default_factory=Tally)
    nothing: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def unsolved(cls, request: Request, numbers: range) -> Part:
        """Return a part without results, in which the rows with invalid values have failed."""
        table = request.table
        reading = request.scene.inputs
        part = cls({column.name: column.empty(len(numbers)) for column in request.columns})
        kept = (*_KNOWN, *table.values)
        part.nothing = {
            column.name: column.empty(1)[0] for column in request.columns if column.name not in kept
        }
        part.fill(slice(None), {"row": numbers, "level": "computed", **table.words(numbers)})
        for row, reason in table.wrong(numbers, reading).items():
            part._fail_as_typed(row - numbers.start, reason, table.texts(row))

        places = part.unknown
        for key, values in table.numbers(part.columns["row"][places], reading).items():
            part.columns[key][places] = values.high
        if request.run_options.times:
            part.transits = {column.name: column.empty(0) for column in TRANSIT_COLUMNS}
        return part

    def _fail_as_typed(self, place: int, reason: str, texts: Mapping[str, str]) -> None:
        """Fail a row with a wrong value, and keep those of its values that are numbers."""
        self.fail(place, Status.INVALID, reason)
        for key, text in texts.items():
            if key not in WORD_FIELDS:
                with suppress(ValueError):
                    self.columns[key][place] = float(text)

    @classmethod
    def joined(cls, pieces: Sequence[Part]) -> Part:
        """Return the rows of several pieces, in order."""
        return cls(
            _joined([piece.columns for piece in pieces]),
            _joined([piece.transits for piece in pieces]),
            sum((piece.tally for piece in pieces), Tally()),
        )

    @property
    def unknown(self) -> Any:
        """The places of rows that have no status yet."""
        statuses = self.columns["status"]
        return np.array(
            [place for place, status in enumerate(statuses) if status is None], np.int64
        )

    def fill(self, places: Any, values: dict[str, Any]) -> None:
        """Put values into those of the columns that the part has, at one place or several."""
        for name, value in values.items():
            if name in self.columns:
                self.columns[name][places] = value

    def fail(self, place: int, status: Status, reason: str) -> None:
        """Set the status and the reason of a row that failed, and remove its numbers."""
        self.fill(place, {**self.nothing, "status": status.value, "reason": reason})

    def add_transits(self, rows: Any, times: Any, directions: Any) -> None:
        """Add transits, in the order of their rows."""
        added = dict(zip(self.transits, (rows, times, directions), strict=True))
        columns = {
            name: np.concatenate([present, np.asarray(added[name], present.dtype)])
            for name, present in self.transits.items()
        }
        order = np.argsort(columns["row"], kind="stable")
        self.transits = {name: values[order] for name, values in columns.items()}

    def replace_transits(self, row: int, times: Any, directions: Any) -> None:
        """Replace the transits of a row."""
        stays = self.transits["row"] != row
        self.transits = {name: values[stays] for name, values in self.transits.items()}
        self.add_transits(np.full(len(times), row), times, directions)


def _joined(tables: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return tables of the same columns, one below the other."""
    joined = {}
    for name in tables[0]:
        joined[name] = np.concatenate([table[name] for table in tables])
    return joined


def solve_part(request: Request, numbers: range, promote: Promote | None = promoted) -> Part:
    """Solve the rows of a part; a row that fails gets a status, and the others continue.

    Args:
        request: the sweep.
        numbers: of the rows.
        promote: has the solver solve a row, as `promoted` does, which is not made for several
            threads. None: a row that double precision does not decide fails.
    """
    started = time.thread_time()
    part = Part.unsolved(request, numbers)
    places = part.unknown
    if len(places):
        before = time.thread_time()
        rows = engine_rows(request.scene, request.table, part.columns["row"][places])
        part.tally.fold_s = time.thread_time() - before
        with np.errstate(divide="ignore", invalid="ignore"):  # a NaN goes to the solver
            _solve(request, part, places, rows, promote)
    part.tally.counts.update(part.columns["status"].tolist())
    part.tally.cpu_s += time.thread_time() - started
    return part


def _solve(request: Request, part: Part, places: Any, rows: Rows, promote: Promote | None) -> None:
    """Solve rows whose values are right one by one."""
    finite = _finite(rows)
    # places of rows that go to the solver or fail, and why; "" where the request wants it
    reasons = _beyond_double(request, part, places[~finite].tolist())
    rows = rows[finite]
    places = places[finite]
    if request.promotes:
        reasons |= dict.fromkeys(places.tolist(), "")
    elif len(places):
        reasons |= _side_by_side(request, part, places, rows)

    for place, reason in sorted(reasons.items()):
        if reason == _STOPPED_REASON:
            part.fail(place, Status.GAVE_UP, reason)
        elif promote is None:
            part.fail(place, Status.DOUBTFUL, f"{reason} The row needs more digits.".strip())
        else:
            _promote(request, part, place, reason, promote)


def _beyond_double(request: Request, part: Part, places: list[int]) -> dict[int, str]:
    """Return which rows beyond the range of double the solver may solve, and why; others fail."""
    reasons = {}
    for place in places:
        try:
            request.scene_of(int(part.columns["row"][place]))
            reasons[place] = "A number of the scene is beyond the range of binary64."
        except InputError as error:
            part.fail(place, Status.INVALID, str(error))
        except FoucaultError as error:
            part.fail(place, Status.UNREACHABLE, str(error))
    return reasons


def _promote(request: Request, part: Part, place: int, reason: str, promote: Promote) -> None:
    """Have the solver solve a row: all its columns are the solver's.

    The reason, empty if the request wants it, remains the row's reason if the solver fails.
    """
    row = int(part.columns["row"][place])
    before = time.thread_time()
    result = promote(request, row, doubtful=bool(reason))
    part.tally.cpu_s += result.cpu_s
    part.tally.promoted += 1
    part.tally.promoted_s += result.cpu_s + time.thread_time() - before
    if result.failure:
        status = Status.DOUBTFUL if reason == _DOUBTFUL_REASON else Status.UNREACHABLE
        part.fail(place, status, f"{reason} {result.failure}".strip())
    else:
        part.fill(place, {**result.values, "status": Status.OK.value, "reason": None})
    if request.run_options.times:
        part.replace_transits(row, *result.times)


def _side_by_side(request: Request, part: Part, places: Any, rows: Rows) -> dict[int, str]:
    """Solve rows side by side; return the places of rows that need more, and why."""
    reasons: dict[int, str] = {}
    for engine, chosen in _shared(request.engine, rows):
        reasons |= _by_engine(request, part, places[chosen], rows[chosen], engine)
    return reasons


def _by_engine(
    request: Request, part: Part, places: Any, rows: Rows, engine: Batch
) -> dict[int, str]:
    """Solve rows by one engine; return as `_side_by_side` does."""
    options = request.run_options
    run = engine.solve(rows, options)
    errors, stopped = errors_by_moved_runs(engine, rows, run)
    columns, unknown = columns_of(rows, run, errors)
    part.fill(places, {**columns, "status": Status.OK.value})
    part.columns["engine"][places] = engine.name
    numbers = part.columns["row"][places]
    if options.times:
        part.add_transits(numbers[run.transit_row], run.transit_t, run.transit_direction)

    unsure = (run.fate != OK) | unknown | errors.unsure_of_highest
    if options.transits:
        unsure |= errors.undecided
    if request.tolerance is not None:
        unsure |= ~(errors.position <= request.tolerance)
    for word in request.sections:
        of_section = engine_rows(request.scene, request.table, numbers, word)
        columns, undecided = passages(engine, word, of_section, run, errors)
        part.fill(places, columns)
        unsure |= undecided

    stopped = stopped | (run.fate == STOPPED)
    reasons = dict.fromkeys(places[unsure].tolist(), _DOUBTFUL_REASON)
    return reasons | dict.fromkeys(places[stopped].tolist(), _STOPPED_REASON)


def _shared(name: str, rows: Rows) -> list[tuple[Batch, Any]]:
    """Return engines with the rows of each: heyoka has those with drag if the engine has none."""
    engine = batches()[name]
    own = np.full(len(rows), engine.drag) | (rows.drag[:, 0] == 0)
    shares = ((engine, own), (batches()["heyoka"], ~own))
    return [(solver, chosen) for solver, chosen in shares if chosen.any()]


def highest_on_one_side(request: Request) -> bool:
    """Return whether successive highest points of the first row lie on the same side."""
    rows = engine_rows(request.scene, request.table, range(1))
    for engine, chosen in _shared(request.engine, rows):
        run = engine.solve(rows[chosen], request.run_options)
        if run.same_side.any():
            return True
    return False


def _finite(rows: Rows) -> Any:
    """Return which rows have finite numbers, and a release that is not at the suspension."""
    numbers = [
        getattr(rows, name).reshape(len(rows), -1)
        for name in ("length", "drag", "turn", "pull", "n", "V")
    ]
    is_finite = np.isfinite(np.concatenate(numbers, axis=1)).all(axis=1)
    return is_finite & (rows.n[:, :, 0] != 0).any(axis=1)
