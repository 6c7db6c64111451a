"""Work in other processes: a worker that streams results, a pool of workers, a loop over results.

Processes are started by subprocess, not by multiprocessing or loky: a worker of dask is daemonic
and may not start theirs, and multiprocessing runs the caller's script again in each. Only its
connections are used.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from itertools import islice
from multiprocessing.connection import Connection, Pipe
from types import TracebackType
from typing import Any, Self, TypeVar, cast

from ..errors import FoucaultError, IntegrationError
from .interruption import SIGNALS, held

Emit = Callable[[Any], None]
Item = TypeVar("Item")

_START = (
    "import sys; sys.path[:] = sys.argv[2:]; "
    "from reference.system.workers import serve; serve(int(sys.argv[1]))"
)
_STDERR = 2
_LEAVE_S = (
    0.5  # seconds in which a worker whose parent has ended can end what it has started itself
)
_GRACE_S = 10.0  # seconds in which a worker has to end once its parent has left it
_TRIES = 2  # of what a pool does: the first process may have been killed from outside
_CHECK_S = 5.0  # between two looks whether anything can still come


def usable_cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class WorkerDied(Exception):
    """The working process ended before it returned a result; the text says how."""


class Worker:
    """A process that runs `function(parent, *arguments)`; iterating yields the objects it sends.

    Args:
        function: defined at the top level of a module; its first argument is a `Parent`.
        arguments: any objects that can be pickled.
        env: variables that are added to this process's environment, or replace some of it.
    """

    def __init__(
        self, function: Callable[..., None], *arguments: Any, env: dict[str, str] | None = None
    ) -> None:
        self._connection, child_connection = Pipe()
        line = child_connection.fileno()
        with held(), child_connection:
            self._process = subprocess.Popen(
                [sys.executable, "-c", _START, str(line), *sys.path],
                stdin=subprocess.DEVNULL,
                stdout=_STDERR,  # what a library prints must not mix with the results
                pass_fds=[line],
                env={**os.environ, **(env or {})},
            )
        with contextlib.suppress(BrokenPipeError):  # its end is noticed when results are read
            self.send((function, arguments))

    def send(self, item: Any) -> None:
        """Send an object to the function; wait while the connection is full."""
        self._connection.send(item)

    def receive(self, timeout_s: float | None = None) -> Any:
        """Return the next object that the function sends; None when it has returned.

        Args:
            timeout_s: wall-clock seconds after which TimeoutError is raised, if any.

        Raises:
            IntegrationError: the function failed, or the process ended before it returned.
        """
        try:
            in_time = self._connection.poll(timeout_s)
            item = self._connection.recv() if in_time else None
        except (EOFError, OSError, pickle.UnpicklingError):
            raise IntegrationError(
                "a child process of the solver ended before it returned a result."
            ) from None
        if not in_time:
            raise TimeoutError
        if isinstance(item, BaseException):
            raise item
        return item

    def __iter__(self) -> Iterator[Any]:
        """Yield the objects that the function sends; raise as `receive`."""
        while (item := self.receive()) is not None:
            yield item

    def stop(self) -> None:
        """Close the connection, which ends the process if it is still working, and wait for its end.

        After `_GRACE_S` it is killed.
        """
        if self._connection.closed:
            return
        with (
            socket.socket(fileno=os.dup(self._connection.fileno())) as line,
            contextlib.suppress(OSError),
        ):
            # unlike closing, this wakes a thread that waits for a result
            line.shutdown(socket.SHUT_RDWR)
        try:
            self._process.wait(_GRACE_S)
        except subprocess.TimeoutExpired:
            self.kill()
            self._process.wait()
        self._connection.close()

    @property
    def ended(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    def kill(self) -> None:
        """Kill the process (SIGKILL)."""
        self._process.kill()


class Pool:
    """Processes that each do one call at a time; a call whose process dies is tried again once.

    Args:
        workers: how many processes at most; each starts when it is needed.
    """

    def __init__(self, workers: int) -> None:
        self._processes: dict[int, Worker] = {}  # by the thread that each works for
        self._ended = threading.Event()
        self._threads = ThreadPoolExecutor(workers, thread_name_prefix="pool")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, *_: TracebackType | BaseException | None
    ) -> None:
        """Wait for what is begun; after an exception, end it."""
        with held():
            if kind:
                self._ended.set()
                for process in list(self._processes.values()):  # a thread may be taking one out
                    process.kill()
            self._threads.shutdown(cancel_futures=kind is not None)
            for process in self._processes.values():
                process.stop()

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Submit a call of a function that is defined at the top level of a module.

        Its future has the function's result, or raises the function's OSError; `WorkerDied`, also
        after any other error; or `CancelledError` if the pool ended it.
        """
        return self._threads.submit(self._call, function, arguments)

    def _call(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
        thread = threading.get_ident()
        reason = ""
        for _ in range(_TRIES):
            worker = self._processes.get(thread)
            if worker is None or worker.ended:  # one that was killed while idle costs no try
                worker = Worker(_answer)
                self._processes[thread] = worker
            if self._ended.is_set():  # asked after `__exit__` can see the process
                break
            try:
                worker.send((function, arguments))
                result, error = worker.receive()
            except (IntegrationError, OSError) as death:
                worker.stop()
                del self._processes[thread]
                reason = str(death)
                continue
            if error is not None:
                raise error
            return result
        raise CancelledError if self._ended.is_set() else WorkerDied(reason)


def as_done(
    begin: Callable[[Item], Future[Any]],
    items: Iterable[Item],
    at_once: int,
    check: Callable[[], None] | None = None,
) -> Iterator[tuple[Item, Future[Any]]]:
    """Start items, and yield each with its future when it is done.

    Args:
        begin: begins an item.
        items: in the order in which they begin.
        at_once: how many are begun and not yet yielded, at most.
        check: called now and then while nothing is done; raises if nothing will come any more.
    """
    waiting = iter(items)
    done: queue.SimpleQueue[tuple[Item, Future[Any]]] = queue.SimpleQueue()

    def put_when_done(item: Item) -> None:
        begin(item).add_done_callback(lambda future: done.put((item, future)))

    begun = 0
    while True:
        with held():
            for item in islice(waiting, at_once - begun):
                put_when_done(item)
                begun += 1
        if not begun:
            return
        try:
            yield done.get(timeout=_CHECK_S)
            begun -= 1
        except queue.Empty:
            if check is not None:
                check()


class Parent:
    """A worker's view of its parent: a call sends an object, iterating receives objects."""

    def __init__(self, connection: Connection, received: queue.SimpleQueue[Any]) -> None:
        self._connection = connection
        self._received = received

    def __call__(self, item: Any) -> None:
        """Send an object to the parent."""
        self._connection.send(item)

    def __iter__(self) -> Iterator[Any]:
        """Yield the objects that the parent sends; the process ends with the parent."""
        while True:
            yield self._received.get()


def _answer(parent: Parent) -> None:
    for function, arguments in parent:
        try:
            parent((function(*arguments), None))
        except OSError as error:  # such as a full disk: the process goes on
            parent((None, error))


def serve(line: int) -> None:
    """Run in the worker: receive a function and its arguments, call it, and end with the parent."""
    ended = _leave_ending_to_parent()
    connection = Connection(line)
    try:
        function, arguments = connection.recv()
    except (EOFError, OSError):  # the parent has ended before it sent anything
        os._exit(1)
    received: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_receive, args=(connection, received, ended), daemon=True).start()
    parent = Parent(connection, received)
    try:
        function(parent, *arguments)
        parent(None)
    except FoucaultError as error:
        parent(IntegrationError(str(error)))
    except SystemExit:
        os._exit(0)
    except BrokenPipeError:
        os._exit(1)
    except Exception:
        if not ended.is_set():
            raise
        os._exit(0)  # code in C that is interrupted during its import raises an ImportError


def _leave_ending_to_parent() -> threading.Event:
    """Catch signals that a terminal or a service manager sends to the whole group; return an event.

    This process ends with its parent, not by such a signal. They are caught rather than ignored, as
    a program that is started here would inherit that. Once the event is set, they end this process
    by an exception, so that it can end such a program.
    """
    ended = threading.Event()
    usual = sys.unraisablehook

    def unless_ended(lost: sys.UnraisableHookArgs) -> None:
        if not ended.is_set():  # else the exception met a finaliser
            usual(lost)

    sys.unraisablehook = unless_ended

    def take(*_: object) -> None:
        if ended.is_set():
            raise SystemExit

    for number in SIGNALS:
        signal.signal(number, take)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)
    return ended


def _receive(
    connection: Connection, received: queue.SimpleQueue[Any], ended: threading.Event
) -> None:
    """Receive what the parent sends; end this process once the parent has closed the line."""
    with contextlib.suppress(EOFError, OSError):
        while True:
            received.put(connection.recv())
    ended.set()
    signal.pthread_kill(cast("int", threading.main_thread().ident), signal.SIGTERM)
    time.sleep(_LEAVE_S)
    os._exit(0)
