"""Signals that end a run (Ctrl-C, SIGTERM, SIGHUP): turned into exceptions, or held back for a moment."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
ENDS = (KeyboardInterrupt, SystemExit)
AGAIN_S = 0.25  # seconds between two looks whether the exception of a signal was lost


@contextmanager
def _replaced(
    handler: Callable[..., object], chosen: Callable[[Any], bool]
) -> Iterator[dict[int, Any]]:
    """Replace those handlers that are chosen meanwhile, in the main thread; yield them by their signals' numbers."""
    main = threading.current_thread() is threading.main_thread()
    numbers = [*SIGNALS, signal.SIGALRM] if main else []
    before: dict[int, Any] = {
        number: usual for number in numbers if chosen(usual := signal.getsignal(number))
    }
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
    received: list[int] = []
    with _replaced(lambda number, _: received.append(number), callable) as handlers:
        before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
    for number in received[:1]:
        handlers[number](number, None)


@contextmanager
def terminable() -> Iterator[list[int]]:
    """Turn SIGTERM and SIGHUP into SystemExit meanwhile, so that what was begun is cleared away; note SIGINT as well.

    Signals that already have a handler, or that are ignored (nohup), are left alone, as all are outside of the main
    thread. The exception of a signal can be lost: Python ignores those in a finaliser, and code in C drops one that it
    meets as it looks for an attribute. Hence it is raised again every `AGAIN_S`, by an alarm, until this is left; while
    it is handled, neither the alarm nor a further signal changes anything.

    Yields:
        The numbers of the signals that have come, then those of alarms. The exception that arrives does not always
        tell: code in C that is interrupted while it is imported raises an ImportError instead.
    """
    received: list[int] = []

    def stop(number: int, _: FrameType | None) -> None:
        received.append(number)
        if not _ends(sys.exc_info()[1]):  # else what was begun is being cleared away
            if signal.getsignal(signal.SIGALRM) is stop:
                signal.setitimer(signal.ITIMER_REAL, AGAIN_S, AGAIN_S)
            raise (
                KeyboardInterrupt if received[0] == signal.SIGINT else SystemExit(128 + received[0])
            )

    usual_hook = sys.unraisablehook
    sys.unraisablehook = lambda lost: (
        None if received and _ends(lost.exc_value) else usual_hook(lost)
    )
    with _replaced(stop, (signal.SIG_DFL, signal.default_int_handler).__contains__):
        try:
            yield received
        finally:
            if received:
                signal.setitimer(signal.ITIMER_REAL, 0)
            sys.unraisablehook = usual_hook


def _ends(error: BaseException | None) -> bool:
    """Return whether an exception ends the run, or came while such a one was handled."""
    return error is not None and (isinstance(error, ENDS) or _ends(error.__context__))
