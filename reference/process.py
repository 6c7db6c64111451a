"""A function of this package in a process of its own, its results streamed back.

Not `multiprocessing`: its children import the caller's main script again, which then has to be written for
that. Here a script that just calls `reference.solve` works as it stands.
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
    """Runs `function(emit, *arguments)`; iterating gives what it emits, in order.

    Args:
        function: at the top level of a module; its first parameter sends an object here.
        arguments: whatever pickles.
    """

    def __init__(self, function: Callable[..., None], *arguments: Any) -> None:
        self._process = subprocess.Popen([sys.executable, "-c", _START], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert self._process.stdin is not None
        with contextlib.suppress(BrokenPipeError):  # a child that died at once is noticed when it is read
            pickle.dump(sys.path, self._process.stdin)
            pickle.dump((function.__module__, function.__qualname__, arguments), self._process.stdin)
            self._process.stdin.flush()

    def __iter__(self) -> Iterator[Any]:
        """What the function emits.

        Raises:
            IntegrationError: the function failed, or the process ended before it was done.
        """
        assert self._process.stdout is not None
        while True:
            try:
                done, item = pickle.load(self._process.stdout)
            except (EOFError, pickle.UnpicklingError):
                raise IntegrationError("a process of the solver ended without an answer.") from None
            if isinstance(item, BaseException):
                raise item
            if done:
                return
            yield item

    def stop(self) -> None:
        """End the process: at once if it is still at work."""
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()
        self._process.wait()

    def kill(self) -> None:
        """End the process as a stranger would."""
        self._process.kill()


def serve() -> None:
    """The child: reads what to do, does it, and ends when its parent does."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what heyoka or anybody prints must not mix with the results
    module, name, arguments = pickle.load(sys.stdin.buffer)
    threading.Thread(target=_leave_with_parent, daemon=True).start()

    def send(done: bool, item: Any) -> None:
        pickle.dump((done, item), results, protocol=pickle.HIGHEST_PROTOCOL)
        results.flush()

    try:
        getattr(import_module(module), name)(lambda item: send(False, item), *arguments)
        send(True, None)
    except FoucaultError as error:
        send(True, IntegrationError(str(error)))
    except (BrokenPipeError, KeyboardInterrupt):
        os._exit(1)


def _leave_with_parent() -> None:
    while os.read(0, 1):  # not through sys.stdin: its lock would stand in the way of a normal end
        pass
    os._exit(0)
