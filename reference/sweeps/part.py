"""A part of a sweep solved: the rows side by side, their errors, and by the solver those that ask for more."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..engines.batch_interface import OK, STOPPED, Batch, Rows
from ..engines.registry import batches
from ..errors import FoucaultError, InputError
from ..status import Status
from .axes import TEXTS
from .estimate import columns_of, judged, passages
from .parquet import TRANSIT_COLUMNS
from .promote import Promoted, promoted
from .request import Request
from .row_constants import engine_rows

Promote = Callable[..., Promoted]

DOUBTFUL_REASON = "The number of transits or passages, or the error, is not decided in double."
STOPPED_REASON = "The engine stopped: the step became too short, or a number not finite."
_KNOWN = ("row", "status", "reason", "level")  # columns that a row has which failed


@dataclass
class Tally:
    """Counts of rows by status, and their costs.

    Attributes:
        counts: of rows.
        cpu_s: CPU seconds of the rows, in this thread and in the process that solves some of them by themselves.
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
        """Return rows of which nothing is known but their values; those with a wrong value have failed."""
        table, inputs = request.table, request.scene.inputs
        part = cls({column.name: column.empty(len(numbers)) for column in request.columns})
        failing = (
            column for column in request.columns if column.name not in (*_KNOWN, *table.values)
        )
        part.nothing = {column.name: column.empty(1)[0] for column in failing}
        part.fill(slice(None), {"row": numbers, "level": "computed", **table.words(numbers)})
        for row, reason in table.wrong(numbers, inputs).items():
            part.fail(row - numbers.start, Status.INVALID, reason)
            for key, text in table.texts(row).items():
                if key not in TEXTS:
                    with suppress(ValueError):
                        part.columns[key][row - numbers.start] = float(text)
        places = part.unknown
        for key, values in table.numbers(part.columns["row"][places], inputs).items():
            part.columns[key][places] = values.high
        if request.run_options.times:
            part.transits = {column.name: column.empty(0) for column in TRANSIT_COLUMNS}
        return part

    @classmethod
    def joined(cls, pieces: Sequence[Part]) -> Part:
        """Return the rows of several pieces, in order."""
        return cls(
            {
                name: np.concatenate([piece.columns[name] for piece in pieces])
                for name in pieces[0].columns
            },
            {
                name: np.concatenate([piece.transits[name] for piece in pieces])
                for name in pieces[0].transits
            },
            sum((piece.tally for piece in pieces), Tally()),
        )

    @property
    def unknown(self) -> Any:
        """The places of rows that have no status yet."""
        return np.array(
            [place for place, status in enumerate(self.columns["status"]) if status is None],
            np.int64,
        )

    def fill(self, places: Any, values: dict[str, Any]) -> None:
        """Put values into those columns that there are, at one place or several."""
        for name, value in values.items():
            if name in self.columns:
                self.columns[name][places] = value

    def fail(self, place: int, status: Status, reason: str) -> None:
        """Say why a row failed, and take its numbers away."""
        self.fill(place, {**self.nothing, "status": status.value, "reason": reason})

    def list_transits(
        self, replaced: Iterable[int], rows: Any, times: Any, directions: Any
    ) -> None:
        """List transits in the order of their rows, in place of those that are listed for some rows."""
        stays = ~np.isin(self.transits["row"], list(replaced))
        added = dict(zip(self.transits, (rows, times, directions), strict=True))
        columns = {
            name: np.concatenate([listed[stays], np.asarray(added[name], listed.dtype)])
            for name, listed in self.transits.items()
        }
        order = np.argsort(columns["row"], kind="stable")
        self.transits = {name: values[order] for name, values in columns.items()}


def solve_part(request: Request, numbers: range, promote: Promote | None = promoted) -> Part:
    """Return rows solved; a row that fails says so, and the others go on.

    Args:
        request: the sweep.
        numbers: of the rows.
        promote: solves a row by itself, as `promoted` does, which is not made for several threads; None: a row that
            double precision does not decide fails.
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
    sound = _finite(rows)
    reasons: dict[int, str] = {}  # places of rows that the solver has to solve, and why
    for place in places[~sound].tolist():
        try:
            request.scene_of(int(part.columns["row"][place]))
            reasons[place] = "A number of the scene is beyond the range of binary64."
        except InputError as error:
            part.fail(place, Status.INVALID, str(error))
        except FoucaultError as error:
            part.fail(place, Status.UNREACHABLE, str(error))
    rows, places = rows[sound], places[sound]
    if request.promotes:
        reasons |= dict.fromkeys(places.tolist(), "")
    elif len(places):
        reasons |= _side_by_side(request, part, places, rows)
    for place, reason in sorted(reasons.items()):
        if reason == STOPPED_REASON:
            part.fail(place, Status.GAVE_UP, reason)
        elif promote is None:
            part.fail(place, Status.DOUBTFUL, f"{reason} It takes more digits.".strip())
        else:
            _promote(request, part, place, reason, promote)


def _promote(request: Request, part: Part, place: int, reason: str, promote: Promote) -> None:
    """Have the solver solve a row: all its columns are the solver's.

    The reason for it, empty if by request, stays the row's reason where the solver failed.
    """
    row, before = int(part.columns["row"][place]), time.thread_time()
    result = promote(request, row, doubtful=bool(reason))
    part.tally.cpu_s += result.cpu_s
    part.tally.promoted += 1
    part.tally.promoted_s += result.cpu_s + time.thread_time() - before
    if result.failure:
        status = Status.DOUBTFUL if reason == DOUBTFUL_REASON else Status.UNREACHABLE
        part.fail(place, status, f"{reason} {result.failure}".strip())
    else:
        part.fill(place, {**result.values, "status": Status.OK.value, "reason": None})
    if request.run_options.times:
        times, directions = result.times
        part.list_transits([row], np.full(len(times), row), times, directions)


def _side_by_side(request: Request, part: Part, places: Any, rows: Rows) -> dict[int, str]:
    """Solve rows side by side; return those that are in doubt, or not good enough, and why."""
    options = request.run_options
    reasons: dict[int, str] = {}
    for engine, chosen in _shared(request.engine, rows):
        of_engine, at = rows[chosen], places[chosen]
        run = engine.solve(of_engine, options)
        errors, lost = judged(engine, of_engine, run)
        columns, unknown = columns_of(of_engine, run, errors)
        part.fill(at, {**columns, "status": Status.OK.value})
        part.columns["engine"][at] = engine.name
        if options.times:
            listed = part.columns["row"][at][run.transit_row]
            part.list_transits([], listed, run.transit_t, run.transit_direction)
        stopped = (run.fate == STOPPED) | lost
        unsure = (run.fate != OK) | unknown | errors.unsure_of_highest
        for word in request.sections:
            sought = engine_rows(request.scene, request.table, part.columns["row"][at], word)
            columns, undecided = passages(engine, word, sought, run, errors)
            part.fill(at, columns)
            unsure |= undecided
        unsure |= errors.undecided if options.transits else False
        if request.tolerance is not None:
            unsure = unsure | ~(errors.position <= request.tolerance)
        reasons |= dict.fromkeys(at[unsure].tolist(), DOUBTFUL_REASON)
        reasons |= dict.fromkeys(at[stopped].tolist(), STOPPED_REASON)
    return reasons


def _shared(name: str, rows: Rows) -> list[tuple[Batch, Any]]:
    """Return engines with the rows that each solves: heyoka those with drag where the other has none."""
    engine = batches()[name]
    chosen = np.full(len(rows), engine.drag) | (rows.drag[:, 0] == 0)
    shares = ((engine, chosen), (batches()["heyoka"], ~chosen))
    return [(solver, share) for solver, share in shares if share.any()]


def highest_on_one_side(request: Request) -> bool:
    """Return whether two highest points of the first row that follow one another lie on one side, as over the top."""
    rows = engine_rows(request.scene, request.table, range(1))
    runs = [
        engine.solve(rows[chosen], request.run_options)
        for engine, chosen in _shared(request.engine, rows)
    ]
    return any(run.same_side.any() for run in runs)


def _finite(rows: Rows) -> Any:
    numbers = (
        getattr(rows, name).reshape(len(rows), -1)
        for name in ("length", "drag", "turn", "pull", "n", "V")
    )
    sound = np.isfinite(np.concatenate(list(numbers), axis=1)).all(axis=1)
    return sound & (rows.n[:, :, 0] != 0).any(axis=1)
