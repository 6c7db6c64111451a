"""Signals that end a run (Ctrl-C, SIGTERM, SIGHUP): turned into exceptions, or held back for a moment."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
ENDS = (KeyboardInterrupt, SystemExit)
AGAIN_S = 0.05  # seconds after which a signal is sent again whose exception was lost


@contextmanager
def _replaced(handler: Callable[..., object], chosen: Callable[[Any], bool]) -> Iterator[dict[int, Any]]:
    """Replace those handlers that are chosen meanwhile, in the main thread; yield them by their signals' numbers."""
    main = threading.current_thread() is threading.main_thread()
    before: dict[int, Any] = {number: usual for number in SIGNALS if main and chosen(usual := signal.getsignal(number))}
    try:
        for number in before:
            signal.signal(number, handler)
        yield before
    finally:
        for number, usual in before.items():
            signal.signal(number, usual)


@contextmanager
def held() -> Iterator[None]:
    """Hold the signals back: a process or a thread that is started meanwhile begins with them held back too.

    In the main thread their handlers wait as well, whichever thread a signal reaches: an exception out of one of them
    can leave a lock of Python's `threading` taken, for which another thread then waits without end.
    """
    came: list[int] = []
    with _replaced(lambda number, _: came.append(number), callable) as handlers:
        before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
    for number in came[:1]:
        handlers[number](number, None)


@contextmanager
def terminable() -> Iterator[list[int]]:
    """Turn SIGTERM and SIGHUP into SystemExit meanwhile, so that what was begun is cleared away; note SIGINT as well.

    Signals that already have a handler, or that are ignored (nohup), are left alone, as all are outside of the main
    thread. A signal whose exception is lost, as Python ignores those in a finaliser, is sent again a moment later; one
    that comes while that of another is handled changes nothing.

    Yields:
        The numbers of the signals that have come. The exception that arrives does not always tell: code in C that is
        interrupted while it is imported raises an ImportError instead.
    """
    came: list[int] = []

    def stop(number: int, _: FrameType | None) -> None:
        came.append(number)
        if not isinstance(sys.exc_info()[1], ENDS):  # else what was begun is being cleared away
            raise KeyboardInterrupt if number == signal.SIGINT else SystemExit(128 + number)

    def again(lost: sys.UnraisableHookArgs) -> None:
        if came and isinstance(lost.exc_value, ENDS):
            timer = threading.Timer(AGAIN_S, os.kill, (os.getpid(), came[-1]))
            timer.daemon = True
            timer.start()
        else:
            usual_hook(lost)

    usual_hook, sys.unraisablehook = sys.unraisablehook, again
    with _replaced(stop, (signal.SIG_DFL, signal.default_int_handler).__contains__):
        try:
            yield came
        finally:
            sys.unraisablehook = usual_hook
