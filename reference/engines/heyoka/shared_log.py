"""heyoka's log while several threads compute: one stream for all, so a batch that may have written runs again alone."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import TypeVar

from ...system.capture import Capture
from .log import watched_log

Result = TypeVar("Result")


class SharedLog:
    """heyoka's log, captured for as long as any thread watches it."""

    def __init__(self) -> None:
        self._turn = threading.Condition()
        self._watchers = self._running = 0
        self._alone = False
        self._stack = ExitStack()
        self._capture: Capture

    @contextmanager
    def watched(self) -> Iterator[None]:
        """Capture the log meanwhile."""
        with self._turn:
            if not self._watchers:
                self._capture = self._stack.enter_context(watched_log())
            self._watchers += 1
        try:
            yield
        finally:
            with self._turn:
                self._watchers -= 1
                if not self._watchers:
                    self._stack.close()

    def seen(self, run: Callable[[], Result]) -> tuple[Result, bool]:
        """Return what `run` returns, and whether heyoka wrote to its log meanwhile; only while it is watched.

        Where something was written, `run` is called once more with no other thread inside `seen`.
        """
        with self._entered():
            before = self._capture.size
            result = run()
            if self._capture.size == before:
                return result, False
        with self.alone():
            before = self._capture.size
            return run(), self._capture.size > before

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Keep the other threads out of `seen` meanwhile: what is logged is not theirs."""
        with self.watched(), self._entered(alone=True):
            yield

    @contextmanager
    def _entered(self, *, alone: bool = False) -> Iterator[None]:
        with self._turn:
            self._turn.wait_for(lambda: not self._alone and not (alone and self._running))
            self._running += 1
            self._alone = alone
        try:
            yield
        finally:
            with self._turn:
                self._running -= 1
                self._alone = False
                self._turn.notify_all()


SHARED_LOG = SharedLog()
