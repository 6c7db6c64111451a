"""Signals that end a run (Ctrl-C, SIGTERM, SIGHUP): turned into exceptions, or held back for a moment."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
AGAIN_S = 0.05  # seconds after which a signal is sent again whose exception was lost


@contextmanager
def held() -> Iterator[None]:
    """Hold the signals back: a process that is started meanwhile begins with them held back too."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
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
            usual_hook(lost)

    usual_hook, sys.unraisablehook = sys.unraisablehook, again
    usual = (signal.SIG_DFL, signal.default_int_handler)
    before = {number: handler for number in SIGNALS if (handler := signal.getsignal(number)) in usual}
    for number in before:
        signal.signal(number, stop)
    try:
        yield came
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        sys.unraisablehook = usual_hook
