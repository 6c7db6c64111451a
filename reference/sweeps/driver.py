"""Run the parts of a sweep on workers that may die.

A part that kills its worker is run again row by row.

Workers on this machine are threads for rows side by side, and processes for rows that the solver
solves.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from ..engines.registry import batches
from ..status import Status
from ..system.channel import ACTIVITY
from ..system.workers import Pool, WorkerDied, as_done
from .estimate import MOVED, SECTION_RUN
from .part import Part, Promote, Tally, solve_part
from .promote import Promoted, promoted
from .request import Request, request_of
from .store import Store

_BLOCKS = 16  # of a whole part, solved one after the other; a thread can end after each
_LEAST_BLOCK = 256  # rows
_PER_WORKER = 3  # parts that wait or are computed for each worker
_DIED_REASON = "Its process died each time, alone as well"


@dataclass
class Executor:
    """Workers.

    Attributes:
        workers: how many.
        begin: begins a part, or some of its rows; the result is that of `solve_and_save`, or
            `WorkerDied` is raised.
        check: raises if the workers are lost; None if they cannot be.
        compile_s: CPU seconds of compiling.
    """

    workers: int
    begin: Callable[[range], Future[Any]]
    check: Callable[[], None] | None = None
    compile_s: float = 0.0


class Interrupted(Exception):
    """A part was abandoned because the sweep is ending."""


def drive(
    request: Request,
    parts: Iterable[int],
    executor: Executor,
    keep: Callable[[int, Part], None],
    report: Callable[[int], None],
) -> Tally:
    """Run all parts and return the sum of their tallies.

    The rows of a part whose worker died are run alone, one after the other. Those whose worker dies
    again are crashed.

    Args:
        request: the sweep.
        parts: which of its parts.
        executor: what computes them.
        keep: called with every part that `solve_and_save` did not save.
        report: called with the number of rows that were done since the last call.
    """
    total = Tally()
    died: list[range] = []
    at_once = _PER_WORKER * executor.workers
    whole = map(request.rows_of, parts)
    for rows, future in as_done(executor.begin, whole, at_once, executor.check):
        try:
            solved = future.result()
        except WorkerDied:
            died.append(rows)
            continue
        total += solved.tally
        if solved.columns:
            keep(request.part_of(rows.start), solved)
        report(len(rows))

    for rows in died:
        solved = _row_by_row(request, rows, executor, report)
        total += solved.tally
        if solved.columns:  # else the row is a whole part, which `solve_and_save` has saved
            keep(request.part_of(rows.start), solved)
    return total


def _row_by_row(
    request: Request, rows: range, executor: Executor, report: Callable[[int], None]
) -> Part:
    """Return rows run alone, one after the other; those whose worker dies are crashed."""
    solved = []
    single = (range(number, number + 1) for number in rows)
    for row, future in as_done(executor.begin, single, 1, executor.check):
        try:
            solved.append(future.result())
        except WorkerDied as death:
            solved.append(_crashed(request, row, f"{_DIED_REASON}: {death}."))
        report(1)
    return Part.joined(solved)


def _crashed(request: Request, rows: range, reason: str) -> Part:
    """Return rows that no process survived."""
    part = Part.unsolved(request, rows)
    part.fill(part.unknown, {"status": Status.CRASHED.value, "reason": reason})
    part.tally.counts.update(part.columns["status"].tolist())
    return part


def solve_and_save(
    request: Request,
    rows: range,
    folder: Path | None,
    promote: Promote = promoted,
    stop: threading.Event | None = None,
) -> Part:
    """Solve rows and return them; with a folder, save the part and return only its tally.

    Raises:
        Interrupted: the event `stop` was set meanwhile.
        InputError: it cannot be saved.
    """
    size = max(request.rows_per_part // _BLOCKS, _LEAST_BLOCK)
    blocks = []
    for first in range(rows.start, rows.stop, size):
        if stop is not None and stop.is_set():
            raise Interrupted
        block = range(first, min(first + size, rows.stop))
        blocks.append(solve_part(request, block, promote))
    solved = Part.joined(blocks)
    part = request.part_of(rows.start)
    if folder is None or rows != request.rows_of(part):
        return solved
    started = time.thread_time()
    Store(folder, request).save(part, solved)
    solved.tally.store_s = time.thread_time() - started
    return Part(tally=solved.tally)


@contextmanager
def on_this_machine(request: Request, folder: Path | None, workers: int) -> Iterator[Executor]:
    """Yield workers on this machine.

    If the sweep is interrupted, processes are ended. Threads end after their block of rows, which
    may take minutes, and are not waited for.

    Args:
        request: the sweep.
        folder: where parts are saved, if anywhere.
        workers: how many.
    """
    if request.promotes:
        with Pool(workers) as pool:
            yield Executor(workers, lambda rows: pool.submit(compute, request.text, rows, folder))
        return

    def prepare() -> None:
        compile_s = prepared(request)  # first, as other threads add to the sum meanwhile
        executor.compile_s += compile_s

    def begin(rows: range) -> Future[Any]:
        return threads.submit(solve_and_save, request, rows, folder, promote, stop)

    executor = Executor(workers, begin)
    stop = threading.Event()
    threads = ThreadPoolExecutor(workers, thread_name_prefix="sweep", initializer=prepare)
    try:
        with Pool(1) as pool:
            promote = partial(isolated, pool)
            yield executor
    finally:
        stop.set()
        threads.shutdown(wait=False, cancel_futures=True)


def prepared(request: Request) -> float:
    """Compile in this thread what the rows need; return the CPU seconds that it took."""
    started = time.thread_time()
    engine = batches()[request.engine]
    for options in (request.run_options, MOVED):
        engine.prepare(options)
    if request.sections:
        engine.prepare(SECTION_RUN)
    ACTIVITY.send("solving rows")
    return time.thread_time() - started


def compute(text: str, rows: range, folder: Path | None) -> Part:
    """Compute rows in a process of their own."""
    return solve_and_save(request_of(text), rows, folder)


def isolated(pool: Pool, request: Request, row: int, *, doubtful: bool) -> Promoted:
    """Call `promoted` in another process, because the solver is not thread-safe."""
    try:
        result: Promoted = pool.submit(compute_alone, request.text, row, doubtful).result()
    except WorkerDied as death:
        return Promoted.failed(str(death))
    return result


def compute_alone(text: str, row: int, doubtful: bool) -> Promoted:
    """Solve a row in this process; note its cost, with the processes that the solver started."""
    before_s = _process_s()
    result = promoted(request_of(text), row, doubtful=doubtful)
    return replace(result, cpu_s=_process_s() - before_s)


def _process_s() -> float:
    """Return the CPU seconds of this process and of those that it started and that have ended."""
    return sum(os.times()[:4])
