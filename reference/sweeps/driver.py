"""Run the parts of a sweep on workers that may die: what kills its worker is halved until one row is left."""

from __future__ import annotations

import queue
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ..status import Status
from ..system.pool import WorkerDied, next_done
from .part import Part, Promote, solve_part
from .promote import promoted
from .request import Request
from .row import empty

BLOCKS = 16  # of a whole part, solved one after the other: Ctrl-C waits for one
LEAST_BLOCK = 256  # rows
PER_WORKER = 3  # pieces that wait or are computed for each worker
DIED_REASON = "Its process died each time, alone as well"


@dataclass
class Tally:
    """Counts of rows by status, and costs."""

    counts: Counter[str] = field(default_factory=Counter)
    cpu_s: float = 0.0
    fold_s: float = 0.0
    store_s: float = 0.0

    @classmethod
    def of(cls, part: Part) -> Tally:
        """Count the rows of a part."""
        return cls(Counter(part.columns["status"].tolist()), part.cpu_s, part.fold_s)

    def add(self, other: Tally) -> None:
        """Add another's."""
        self.counts += other.counts
        self.cpu_s += other.cpu_s
        self.fold_s += other.fold_s
        self.store_s += other.store_s


@dataclass(frozen=True)
class Piece:
    """Rows of a part that are computed together; `whole` if they are all of it."""

    part: int
    rows: range
    whole: bool = True


class Executor(Protocol):
    """Computes pieces: `submit` returns a future whose result is `work`'s, or which raises `WorkerDied`."""

    workers: int

    def submit(self, piece: Piece) -> Any:
        """Begin a piece."""

    def check(self) -> None:
        """Raise if nothing will come any more."""


class Interrupted(Exception):
    """A piece was given up because the sweep ends."""


def work(
    request: Request,
    piece: Piece,
    folder: Path | None,
    promote: Promote = promoted,
    stop: threading.Event | None = None,
) -> tuple[Tally, Part | None]:
    """Solve a piece, and save it where it is a whole part and there is a folder; else return its rows as well.

    Raises:
        Interrupted: the event `stop` was set meanwhile.
        OSError: it cannot be saved.
    """
    blocks, size = [], max(request.rows_per_part // BLOCKS, LEAST_BLOCK)
    for first in range(piece.rows.start, piece.rows.stop, size):
        if stop is not None and stop.is_set():
            raise Interrupted
        blocks.append(solve_part(request, range(first, min(first + size, piece.rows.stop)), promote))
    solved = joined(blocks)
    tally = Tally.of(solved)
    if folder is None or not piece.whole:
        return tally, solved
    from .store import Store

    started = time.thread_time()
    Store(folder, request).save(piece.part, solved)
    tally.store_s = time.thread_time() - started
    return tally, None


def drive(
    request: Request,
    parts: Iterable[int],
    executor: Executor,
    keep: Callable[[int, Part], None],
    report: Callable[[int], None],
) -> Tally:
    """Run parts to their end; return the tally of all.

    Args:
        request: the sweep.
        parts: which of its parts.
        executor: what computes them.
        keep: called with every part that `work` did not save.
        report: called with the number of rows that were done since the last call.
    """
    total, waiting = Tally(), _pieces(request, parts)
    done: queue.SimpleQueue[Any] = queue.SimpleQueue()
    open_pieces: dict[Any, Piece] = {}
    halves: dict[int, list[Part]] = {}
    suspects: list[Piece] = []  # rows whose process died, perhaps by another piece in it
    alone: set[int] = set()

    def begin(piece: Piece) -> None:
        future = executor.submit(piece)
        open_pieces[future] = piece
        future.add_done_callback(done.put)

    for piece in islice(waiting, PER_WORKER * executor.workers):
        begin(piece)
    while open_pieces or suspects:
        if not open_pieces:
            alone.add(suspects[-1].rows.start)
            begin(suspects.pop())
        piece = open_pieces.pop(future := next_done(done, executor))
        try:
            tally, solved = future.result()
        except WorkerDied as death:
            if len(piece.rows) > 1:
                middle = piece.rows.start + len(piece.rows) // 2
                begin(Piece(piece.part, range(piece.rows.start, middle), whole=False))
                begin(Piece(piece.part, range(middle, piece.rows.stop), whole=False))
                continue
            if piece.rows.start not in alone:
                suspects.append(piece)
                continue
            solved = crashed(request, piece.rows, f"{DIED_REASON}: {death}.")
            tally = Tally.of(solved)
        total.add(tally)
        if solved is not None and not piece.whole:
            halves.setdefault(piece.part, []).append(solved)
            solved = _whole(request, piece.part, halves)
        if solved is not None:
            keep(piece.part, solved)
        report(len(piece.rows))
        for following in islice(waiting, 1):
            begin(following)
    return total


def crashed(request: Request, rows: range, reason: str) -> Part:
    """Return rows that no process survived."""
    part = Part({column.name: empty(column, len(rows)) for column in request.columns})
    part.columns["row"][:] = rows
    part.columns["level"][:] = "computed"
    part.columns["status"][:] = Status.CRASHED.value
    part.columns["reason"][:] = reason
    for key, numbers in request.table.numbers(np.array(rows), request.scene.inputs).items():
        part.columns[key][:] = numbers.high
    for key, words in request.table.words(rows).items():
        part.columns[key][:] = words
    if request.wanted.times:
        part.transits = {"row": np.zeros(0, np.int64), "t_s": np.zeros(0), "direction": np.zeros(0, np.int8)}
    return part


def _pieces(request: Request, parts: Iterable[int]) -> Iterator[Piece]:
    return (Piece(part, request.rows_of(part)) for part in parts)


def _whole(request: Request, number: int, halves: dict[int, list[Part]]) -> Part | None:
    """Return a part from its pieces when all are there."""
    pieces = sorted(halves[number], key=lambda piece: int(piece.columns["row"][0]))
    if sum(len(piece.columns["row"]) for piece in pieces) < len(request.rows_of(number)):
        return None
    del halves[number]
    return joined(pieces)


def joined(pieces: list[Part]) -> Part:
    """Return the rows of several pieces, in order."""
    first = pieces[0]
    return Part(
        {name: np.concatenate([piece.columns[name] for piece in pieces]) for name in first.columns},
        {name: np.concatenate([piece.transits[name] for piece in pieces]) for name in first.transits},
        sum(piece.cpu_s for piece in pieces),
        sum(piece.fold_s for piece in pieces),
    )
