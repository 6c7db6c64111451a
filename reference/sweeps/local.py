"""The cores of this machine: threads for rows side by side, isolated processes for rows that the solver solves."""

from __future__ import annotations

import os
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from ..engines.registry import batches
from ..errors import IntegrationError
from ..system.pool import Pool
from ..system.process import Parent, Worker
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
        self._request, self._folder = request, folder
        self._stop, self._promote = threading.Event(), Isolated()
        if request.promotes:
            self._processes = Pool(workers, serve, request.document(), folder)
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

    def submit(self, rows: range) -> Future[Any]:
        """Begin a part, or some of its rows."""
        if self._request.promotes:
            return self._processes.submit(rows)
        return self._threads.submit(work, self._request, rows, self._folder, self._promote, self._stop)

    def check(self) -> None:
        """Do nothing: threads do not get lost."""


def prepared(request: Request) -> float:
    """Compile in this thread what the rows need; return the CPU seconds that it took."""
    started = time.thread_time()
    engine = batches()[request.engine]
    for wanted in (request.wanted, MOVED):
        engine.prepare(wanted, drag=False)
    return time.thread_time() - started


def serve(parent: Parent, document: dict[str, Any], folder: Path | None) -> None:
    """Compute the rows that the parent sends, in a process of its own."""
    request = Request.of(document)
    for rows in parent:
        parent(work(request, rows, folder))


class Isolated:
    """Calls `promoted` for threads in one process of its own: the solver is not made for several threads.

    The process starts with the first row, and is replaced if it dies.
    """

    def __init__(self) -> None:
        self._turn = threading.Lock()
        self._worker: Worker | None = None
        self._hash = ""

    def __call__(self, request: Request, row: int, *, doubtful: bool) -> Promoted:
        """Return a row solved by itself; see `promote.promoted`."""
        with self._turn:
            if self._hash != request.hash:
                self._end()
            try:
                if self._worker is None:
                    self._worker, self._hash = Worker(serve_promoted, request.document()), request.hash
                self._worker.send((row, doubtful))
                result: Promoted = self._worker.receive()
            except (IntegrationError, OSError) as error:
                self._end()
                return Promoted({}, ([], []), str(error))
            return result

    def stop(self) -> None:
        """End the process."""
        with self._turn:
            self._end()

    def _end(self) -> None:
        if self._worker is not None:
            self._worker.stop()
            self._worker = None


def serve_promoted(parent: Parent, document: dict[str, Any]) -> None:
    """Promote the rows that the parent sends."""
    request = Request.of(document)
    for row, doubtful in parent:
        before = sum(os.times()[:4])
        result = promoted(request, row, doubtful=doubtful)
        parent(replace(result, cpu_s=sum(os.times()[:4]) - before))
