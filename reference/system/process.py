"""A child process that runs a function of this project, takes objects while it works, and streams its results back.

Not `multiprocessing`: its children import the caller's main script again, which then needs a guard against running
twice. Here a script that just calls `reference.solve` works as it stands.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from types import FrameType
from typing import Any, BinaryIO, cast

from ..errors import FoucaultError, IntegrationError

Emit = Callable[[Any], None]

_START = "import sys; sys.path[:] = sys.argv[1:]; from reference.system.process import serve; serve()"
_ENDS_WITH_PARENT = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
_LENGTH = 8  # bytes that hold the length of an object sent to a child
LEAVE_S = 0.5  # seconds in which a child whose parent has ended can end what it has started itself
AGAIN_S = 0.05  # seconds after which a signal is sent again whose exception was lost
GRACE_S = 10.0  # seconds in which a child has to end by itself once its parent has closed the pipes


def usable_cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Parent:
    """A child's view of its parent: call it to send an object, iterate over it to take those that the parent sends."""

    def __init__(self, results: BinaryIO, received: queue.SimpleQueue[Any]) -> None:
        self._results, self._received = results, received

    def __call__(self, item: Any) -> None:
        """Send an object to the parent."""
        self.send(False, item)

    def __iter__(self) -> Iterator[Any]:
        """Yield the objects that the parent sends, for as long as the parent wants them; the process ends with it."""
        while True:
            yield self._received.get()

    def send(self, last: bool, item: Any) -> None:
        """Send an object, the last one or not."""
        pickle.dump((last, item), self._results, protocol=pickle.HIGHEST_PROTOCOL)
        self._results.flush()


class Worker:
    """A child process that runs `function(parent, *arguments)`; iterating yields the objects it sends, in order.

    Args:
        function: stands at the top level of a module; its first argument is a `Parent`.
        arguments: any objects that can be pickled.
    """

    def __init__(self, function: Callable[..., None], *arguments: Any) -> None:
        with _signals_held():
            self._process = subprocess.Popen(
                [sys.executable, "-c", _START, *sys.path], stdin=subprocess.PIPE, stdout=subprocess.PIPE
            )
        with contextlib.suppress(BrokenPipeError):  # the death of a child is noticed when its results are read
            self.send((function.__module__, function.__qualname__, arguments))

    def send(self, item: Any) -> None:
        """Send an object to the function; wait while the pipe is full."""
        pipe = cast("BinaryIO", self._process.stdin)
        data = pickle.dumps(item, protocol=pickle.HIGHEST_PROTOCOL)
        pipe.write(len(data).to_bytes(_LENGTH, "little") + data)
        pipe.flush()

    def receive(self) -> Any:
        """Return the next object that the function sends; None when it has returned.

        Raises:
            IntegrationError: the function failed, or the process ended before it returned.
        """
        try:
            last, item = pickle.load(cast("BinaryIO", self._process.stdout))
        except (EOFError, pickle.UnpicklingError):
            raise IntegrationError("a child process of the solver ended without a result.") from None
        if isinstance(item, BaseException):
            raise item
        return None if last else item

    def __iter__(self) -> Iterator[Any]:
        """Yield the objects that the function sends; raise as `receive`."""
        while (item := self.receive()) is not None:
            yield item

    def stop(self) -> None:
        """Close the pipes, which ends a process that is still at work, and wait for its end; kill it after `GRACE_S`.

        Closing may block as well: a thread that waits for a result holds the pipe until the process ends.
        """
        with alarm(GRACE_S, self.kill):
            for pipe in (self._process.stdin, self._process.stdout):
                if pipe is not None:
                    with contextlib.suppress(OSError):
                        pipe.close()
            self._process.wait()

    def kill(self) -> None:
        """Kill the process (SIGKILL)."""
        self._process.kill()


@contextlib.contextmanager
def alarm(delay_s: float, act: Callable[..., object], *arguments: Any) -> Iterator[None]:
    """Call a function if the body takes longer than `delay_s` seconds."""
    timer = threading.Timer(delay_s, act, arguments)
    timer.daemon = True  # an interruption between the lines here must not have the program wait for it as it ends
    try:
        timer.start()
        yield
    finally:
        timer.cancel()


@contextlib.contextmanager
def _signals_held() -> Iterator[None]:
    """Hold back the signals that end a run: a process that is started meanwhile begins with them held back too."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _ENDS_WITH_PARENT)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def terminable() -> Iterator[list[int]]:
    """Turn SIGTERM and SIGHUP into SystemExit meanwhile, so that what was begun is cleared away; note SIGINT as well.

    Signals that already have a handler, or that are ignored (nohup), are left alone, as all are outside of the main
    thread. A signal whose exception is lost, as Python ignores those in a finaliser, is sent again a moment later.

    Yields:
        The numbers of the signals that have come. The exception that arrives does not always tell: code in C that is
        interrupted while it is imported raises an ImportError instead.
    """
    came: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield came
        return

    def stop(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if number == signal.SIGINT:
            signal.default_int_handler(number, frame)
        raise SystemExit(128 + number)

    def again(lost: sys.UnraisableHookArgs) -> None:
        if came and isinstance(lost.exc_value, KeyboardInterrupt | SystemExit):
            timer = threading.Timer(AGAIN_S, os.kill, (os.getpid(), came[-1]))
            timer.daemon = True
            timer.start()
        else:
            said(lost)

    said, sys.unraisablehook = sys.unraisablehook, again
    usual = (signal.SIG_DFL, signal.default_int_handler)
    before = {number: handler for number in _ENDS_WITH_PARENT if (handler := signal.getsignal(number)) in usual}
    for number in before:
        signal.signal(number, stop)
    try:
        yield came
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        sys.unraisablehook = said


def _leave_ending_to_parent() -> threading.Event:
    """Take signals that a terminal or a service manager sends to the whole group: this process ends with its parent.

    They are taken and not ignored, so that a program that is started here has its own way with them. Once the event
    that is returned is set, they end this process by an exception, so that it can end such a program.
    """
    ended = threading.Event()
    said = sys.unraisablehook
    sys.unraisablehook = lambda lost: None if ended.is_set() else said(lost)  # the exception met a finaliser

    def take(*_: object) -> None:
        if ended.is_set():
            raise SystemExit

    for number in _ENDS_WITH_PARENT:
        signal.signal(number, take)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _ENDS_WITH_PARENT)
    return ended


def serve() -> None:
    """Run in the child: read the function and its arguments, call it, and end when the parent ends."""
    ended = _leave_ending_to_parent()
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # nothing that heyoka or others print may mix with the results
    try:
        module, name, arguments = _item()
    except EOFError:  # the parent has ended before it sent anything
        os._exit(1)
    received: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_receive, args=(received, ended), daemon=True).start()
    parent = Parent(results, received)
    try:
        getattr(import_module(module), name)(parent, *arguments)
        parent.send(True, None)
    except FoucaultError as error:
        parent.send(True, IntegrationError(str(error)))
    except SystemExit:
        os._exit(0)
    except BrokenPipeError:
        os._exit(1)
    except Exception:
        if not ended.is_set():
            raise
        os._exit(0)  # code in C that is told to end while it is imported raises an ImportError


def _receive(received: queue.SimpleQueue[Any], ended: threading.Event) -> None:
    """Take what the parent sends; leave with the parent, which has ended or closed the pipe when there is no more."""
    with contextlib.suppress(EOFError, OSError):
        while True:
            received.put(_item())
    ended.set()
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(cast("int", threading.main_thread().ident), signal.SIGTERM)
        time.sleep(LEAVE_S)
    os._exit(0)


def _item() -> Any:
    return pickle.loads(_read(int.from_bytes(_read(_LENGTH), "little")))


def _read(count: int) -> bytes:
    """Read `count` bytes from the parent; not through sys.stdin, whose lock would block a normal exit."""
    data = b""
    while len(data) < count:
        part = os.read(0, min(count - len(data), 1 << 20))
        if not part:
            raise EOFError
        data += part
    return data
