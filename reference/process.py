"""Run a function of this package in a child process and stream its results back.

Not `multiprocessing`: its children import the caller's main script again, which then needs a guard against running
twice. Here a script that just calls `reference.solve` works as it stands.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

from .errors import FoucaultError, IntegrationError

_START = "import pickle, sys; sys.path[:] = pickle.load(sys.stdin.buffer); from reference.process import serve; serve()"

Emit = Callable[[Any], None]


class Worker:
    """A child process that runs `function(emit, *arguments)`; iterating yields the emitted objects in order.

    Args:
        function: stands at the top level of a module; its first argument, `emit`, sends an object to the parent.
        arguments: any objects that can be pickled.
    """

    def __init__(self, function: Callable[..., None], *arguments: Any) -> None:
        self._process = subprocess.Popen([sys.executable, "-c", _START], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):  # the death of a child is noticed when its results are read
            pickle.dump(sys.path, self._process.stdin)
            pickle.dump((function.__module__, function.__qualname__, arguments), self._process.stdin)
            self._process.stdin.flush()

    def __iter__(self) -> Iterator[Any]:
        """Yield the objects that the function emits.

        Raises:
            IntegrationError: the function failed, or the process ended before it returned.
        """
        assert self._process.stdout is not None
        while True:
            try:
                last, item = pickle.load(self._process.stdout)
            except (EOFError, pickle.UnpicklingError):
                raise IntegrationError("a child process of the solver ended without a result.") from None
            if isinstance(item, BaseException):
                raise item
            if last:
                return
            yield item

    def stop(self) -> None:
        """Close the pipes, which ends a process that is still at work, and wait for its end."""
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()
        self._process.wait()

    def kill(self) -> None:
        """Kill the process (SIGKILL)."""
        self._process.kill()


def serve() -> None:
    """Run in the child: read the function and its arguments, call it, and end when the parent ends."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # nothing that heyoka or others print may mix with the results
    module, name, arguments = pickle.load(sys.stdin.buffer)
    threading.Thread(target=_leave_with_parent, daemon=True).start()

    def send(last: bool, item: Any) -> None:
        pickle.dump((last, item), results, protocol=pickle.HIGHEST_PROTOCOL)
        results.flush()

    try:
        getattr(import_module(module), name)(lambda item: send(False, item), *arguments)
        send(True, None)
    except FoucaultError as error:
        send(True, IntegrationError(str(error)))
    except (BrokenPipeError, KeyboardInterrupt):
        os._exit(1)


def _leave_with_parent() -> None:
    while os.read(0, 1):  # not through sys.stdin, whose lock would block a normal exit
        pass
    os._exit(0)
