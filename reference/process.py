"""A child process that runs a function of this project, takes objects while it works, and streams its results back.

Not `multiprocessing`: its children import the caller's main script again, which then needs a guard against running
twice. Here a script that just calls `reference.solve` works as it stands.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any, BinaryIO, cast

from .errors import FoucaultError, IntegrationError

Emit = Callable[[Any], None]

_START = "import sys; sys.path[:] = sys.argv[1:]; from reference.process import serve; serve()"
_LENGTH = 8  # bytes that hold the length of an object sent to a child
GRACE_S = 10.0  # seconds in which a child has to end by itself once its parent has closed the pipes


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
        alarm = threading.Timer(GRACE_S, self.kill)
        alarm.start()
        try:
            for pipe in (self._process.stdin, self._process.stdout):
                if pipe is not None:
                    with contextlib.suppress(OSError):
                        pipe.close()
            self._process.wait()
        finally:
            alarm.cancel()

    def kill(self) -> None:
        """Kill the process (SIGKILL)."""
        self._process.kill()


def serve() -> None:
    """Run in the child: read the function and its arguments, call it, and end when the parent ends."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # nothing that heyoka or others print may mix with the results
    try:
        module, name, arguments = _item()
    except (EOFError, KeyboardInterrupt):  # the parent has ended before it sent anything
        os._exit(1)
    received: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_receive, args=(received,), daemon=True).start()
    parent = Parent(results, received)
    try:
        getattr(import_module(module), name)(parent, *arguments)
        parent.send(True, None)
    except FoucaultError as error:
        parent.send(True, IntegrationError(str(error)))
    except (BrokenPipeError, KeyboardInterrupt):
        os._exit(1)


def _receive(received: queue.SimpleQueue[Any]) -> None:
    """Take what the parent sends; leave with the parent, which has ended or closed the pipe when there is no more."""
    with contextlib.suppress(EOFError, OSError):
        while True:
            received.put(_item())
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
