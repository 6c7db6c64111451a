"""Run the parts of a sweep on workers that may die: a part that kills its worker is run again row by row."""

from __future__ import annotations

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ..status import Status
from ..system.workers import WorkerDied, as_done
from .part import Part, Promote, solve_part, unsolved
from .promote import promoted
from .request import Request

BLOCKS = 16  # of a whole part, solved one after the other: Ctrl-C waits for one
LEAST_BLOCK = 256  # rows
PER_WORKER = 3  # parts that wait or are computed for each worker
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


class Executor(Protocol):
    """Computes rows."""

    workers: int
    compile_s: float  # CPU seconds

    def begin(self, rows: range) -> Future[Any]:
        """Begin a part, or some of its rows: the result is that of `work`, or `WorkerDied` is raised."""

    def check(self) -> None:
        """Raise if nothing will come any more."""


class Interrupted(Exception):
    """A part was given up because the sweep ends."""


def work(
    request: Request,
    rows: range,
    folder: Path | None,
    promote: Promote = promoted,
    stop: threading.Event | None = None,
) -> tuple[Tally, Part | None]:
    """Solve rows, and save them where they are a whole part and there is a folder; else return them as well.

    Raises:
        Interrupted: the event `stop` was set meanwhile.
        OSError: it cannot be saved.
    """
    blocks, size = [], max(request.rows_per_part // BLOCKS, LEAST_BLOCK)
    for first in range(rows.start, rows.stop, size):
        if stop is not None and stop.is_set():
            raise Interrupted
        blocks.append(solve_part(request, range(first, min(first + size, rows.stop)), promote))
    solved = joined(blocks)
    tally, part = Tally.of(solved), request.part_of(rows)
    if folder is None or rows != request.rows_of(part):
        return tally, solved
    from .store import Store

    started = time.thread_time()
    Store(folder, request).save(part, solved)
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

    The rows of a part whose worker died are run alone, one after the other: those whose worker dies again are crashed.

    Args:
        request: the sweep.
        parts: which of its parts.
        executor: what computes them.
        keep: called with every part that `work` did not save.
        report: called with the number of rows that were done since the last call.
    """
    total, died = Tally(), list[range]()
    at_once = PER_WORKER * executor.workers
    for rows, future in as_done(executor.begin, map(request.rows_of, parts), at_once, executor.check):
        try:
            tally, solved = future.result()
        except WorkerDied:
            died.append(rows)
            continue
        total.add(tally)
        if solved is not None:
            keep(request.part_of(rows), solved)
        report(len(rows))
    for rows in died:
        alone = []
        for row, future in as_done(executor.begin, (range(number, number + 1) for number in rows), 1, executor.check):
            try:
                tally, solved = future.result()
            except WorkerDied as death:
                solved = crashed(request, row, f"{DIED_REASON}: {death}.")
                tally = Tally.of(solved)
            total.add(tally)
            if solved is not None:  # the row is no whole part, which `work` has saved
                alone.append(solved)
            report(1)
        if alone:
            keep(request.part_of(rows), joined(alone))
    return total


def crashed(request: Request, rows: range, reason: str) -> Part:
    """Return rows that no process survived."""
    part = unsolved(request, rows)
    part.columns["status"][:] = Status.CRASHED.value
    part.columns["reason"][:] = reason
    for key, numbers in request.table.numbers(np.array(rows), request.scene.inputs).items():
        part.columns[key][:] = numbers.high
    return part


def joined(pieces: list[Part]) -> Part:
    """Return the rows of several pieces, in order."""
    first = pieces[0]
    return Part(
        {name: np.concatenate([piece.columns[name] for piece in pieces]) for name in first.columns},
        {name: np.concatenate([piece.transits[name] for piece in pieces]) for name in first.transits},
        sum(piece.cpu_s for piece in pieces),
        sum(piece.fold_s for piece in pieces),
    )
