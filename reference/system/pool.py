"""Isolated processes side by side: one that dies costs what it was at, which is tried once more in another."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType
from typing import Any, Protocol, Self

from ..errors import IntegrationError
from .process import Worker

TRIES = 2  # of an item: the first process may have been killed from outside
CHECK_S = 5.0  # between two looks whether anything can still come


class WorkerDied(Exception):
    """The process that was at an item ended without a result; the text says how."""


class Checked(Protocol):
    """Workers elsewhere, which may be lost."""

    def check(self) -> None:
        """Raise if nothing will come any more."""


def next_done(done: queue.SimpleQueue[Any], workers: Checked) -> Any:
    """Return the next future of a queue of those that are done.

    Raises:
        FoucaultError: nothing will come any more, as `workers` tells.
    """
    while True:
        try:
            return done.get(timeout=CHECK_S)
        except queue.Empty:
            workers.check()


class Pool:
    """Isolated processes, each of which runs `function(parent, *arguments)`: it answers every item with a result.

    Args:
        workers: how many.
        function: stands at the top level of a module; its first argument is a `process.Parent`.
        arguments: any objects that can be pickled.
    """

    def __init__(self, workers: int, function: Callable[..., None], *arguments: Any) -> None:
        self.workers = workers
        self._start = function, arguments
        self._own, self._processes = threading.local(), list[Worker]()
        self._threads = ThreadPoolExecutor(workers, thread_name_prefix="pool")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: TracebackType | BaseException | None) -> None:
        """Wait for what is begun; after an exception, end it."""
        for process in self._processes if kind else ():
            process.kill()
        self._threads.shutdown(cancel_futures=kind is not None)
        for process in self._processes:
            process.stop()

    def submit(self, item: Any) -> Future[Any]:
        """Begin an item; the result of its future is what the function sends, or a `WorkerDied`."""
        return self._threads.submit(self._answer, item)

    def check(self) -> None:
        """Do nothing: threads do not get lost."""

    def _answer(self, item: Any) -> Any:
        for _ in range(TRIES):
            worker = self._worker()
            try:
                worker.send(item)
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
            function, arguments = self._start
            self._own.worker = Worker(function, *arguments)
            self._processes.append(self._own.worker)
        worker: Worker = self._own.worker
        return worker
