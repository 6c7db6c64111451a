"""The cores of this machine: threads for rows side by side, processes for rows that the solver solves."""

from __future__ import annotations

import json
import os
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from ..engines.registry import batches
from ..system.workers import Pool, WorkerDied
from .driver import work
from .estimate import MOVED
from .promote import Promoted, promoted
from .request import Request


class LocalExecutor:
    """Workers on this machine.

    Args:
        request: the sweep.
        folder: where parts are saved, if anywhere.
        workers: how many.
    """

    def __init__(self, request: Request, folder: Path | None, workers: int) -> None:
        self.workers, self.compile_s = workers, 0.0
        self._request, self._folder, self._document = request, folder, text_of(request)
        self._stop, self._promote = threading.Event(), Isolated()
        if request.promotes:
            self._processes = Pool(workers)
        else:
            self._threads = ThreadPoolExecutor(workers, thread_name_prefix="sweep", initializer=self._prepare)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *rest: TracebackType | BaseException | None) -> None:
        """Wait for what is running; where the sweep was interrupted, for the few rows that threads are at alone."""
        if self._request.promotes:
            self._processes.__exit__(kind, *rest)
            return
        if kind:
            self._stop.set()
        self._threads.shutdown(cancel_futures=kind is not None)
        self._promote.stop()

    def _prepare(self) -> None:
        self.compile_s += prepared(self._request)

    def begin(self, rows: range) -> Future[Any]:
        """Begin a part, or some of its rows."""
        if self._request.promotes:
            return self._processes.submit(compute, self._document, rows, self._folder)
        return self._threads.submit(work, self._request, rows, self._folder, self._promote, self._stop)

    def check(self) -> None:
        """Do nothing: threads do not get lost."""


class Isolated:
    """Calls `promoted` for threads in one process of its own: the solver is not made for several threads."""

    def __init__(self) -> None:
        self._pool = Pool(1)

    def __call__(self, request: Request, row: int, *, doubtful: bool) -> Promoted:
        """Return a row solved by itself; see `promote.promoted`."""
        try:
            result: Promoted = self._pool.submit(compute_alone, text_of(request), row, doubtful).result()
        except WorkerDied as death:
            return Promoted({}, ([], []), str(death))
        return result

    def stop(self) -> None:
        """End the process."""
        self._pool.__exit__(None)


def text_of(request: Request) -> str:
    """Return a sweep as a text that can be sent, and that `request_of` reads."""
    return json.dumps(request.document())


@lru_cache(maxsize=1)
def request_of(document: str) -> Request:
    """Return the sweep whose text was sent."""
    return Request.of(json.loads(document))


def prepared(request: Request) -> float:
    """Compile in this thread what the rows need; return the CPU seconds that it took."""
    started = time.thread_time()
    engine = batches()[request.engine]
    for wanted in (request.wanted, MOVED):
        engine.prepare(wanted, drag=False)
    return time.thread_time() - started


def compute(document: str, rows: range, folder: Path | None) -> Any:
    """Compute rows in a process of their own."""
    return work(request_of(document), rows, folder)


def compute_alone(document: str, row: int, doubtful: bool) -> Promoted:
    """Have the solver solve a row in a process of its own; note what it cost, with the processes that it started."""
    before = sum(os.times()[:4])
    result = promoted(request_of(document), row, doubtful=doubtful)
    return replace(result, cpu_s=sum(os.times()[:4]) - before)
