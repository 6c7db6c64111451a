"""The cores of this machine: threads for rows side by side, isolated processes for rows that the solver solves."""

from __future__ import annotations

import os
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from ..engines.registry import batches
from ..errors import IntegrationError
from ..process import Parent, Worker
from .driver import Piece, WorkerDied, work
from .estimate import MOVED
from .isolated import Isolated
from .request import Request

TRIES = 2  # of a piece in a process of its own, before it is halved: the first may have been killed from outside


def default_workers() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


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
        self._own, self._processes = threading.local(), list[Worker]()
        self._pool = ThreadPoolExecutor(workers, thread_name_prefix="sweep", initializer=self._prepare)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: TracebackType | BaseException | None) -> None:
        """Wait for what is running; where the sweep was interrupted, for the few rows that threads are at alone."""
        if kind:
            self._stop.set()
        for process in self._processes if kind else ():
            process.kill()
        self._pool.shutdown(cancel_futures=kind is not None)
        for process in self._processes:
            process.stop()
        self._promote.stop()

    def _prepare(self) -> None:
        if not self._request.promotes:
            self.compile_s += prepared(self._request)

    def submit(self, piece: Piece) -> Future[Any]:
        """Begin a piece."""
        return self._pool.submit(self._isolated if self._request.promotes else self._in_thread, piece)

    def check(self) -> None:
        """Do nothing: threads do not get lost."""

    def _in_thread(self, piece: Piece) -> Any:
        return work(self._request, piece, self._folder, self._promote, self._stop)

    def _isolated(self, piece: Piece) -> Any:
        for _ in range(TRIES):
            worker = self._worker()
            try:
                worker.send(piece)
                return worker.receive()
            except (IntegrationError, OSError) as error:
                worker.stop()
                self._processes.remove(worker)
                del self._own.worker
                reason = str(error)
        raise WorkerDied(reason)

    def _worker(self) -> Worker:
        """Return this thread's process, a new one where it has none."""
        if not hasattr(self._own, "worker"):
            self._own.worker = Worker(serve, self._request.document(), self._folder)
            self._processes.append(self._own.worker)
        worker: Worker = self._own.worker
        return worker


def prepared(request: Request) -> float:
    """Compile in this thread what the rows need; return the CPU seconds that it took."""
    started = time.thread_time()
    engine = batches()[request.engine]
    for wanted in (request.wanted, MOVED):
        engine.prepare(wanted, drag=False)
    return time.thread_time() - started


def serve(parent: Parent, document: dict[str, Any], folder: Path | None) -> None:
    """Compute the pieces that the parent sends, in a process of its own."""
    request = Request.of(document)
    for piece in parent:
        parent(work(request, piece, folder))
