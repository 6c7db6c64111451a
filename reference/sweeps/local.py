"""The cores of this machine: threads for rows side by side, isolated processes for rows that the solver solves."""

from __future__ import annotations

import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from ..engines.registry import batches
from ..system.pool import Pool
from ..system.process import Parent
from .driver import work
from .estimate import MOVED
from .isolated import Isolated
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
