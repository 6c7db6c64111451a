"""Signals that end a run (Ctrl-C, SIGTERM, SIGHUP): turned into exceptions, or deferred."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from types import FrameType
from typing import Any

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
_ENDS = (KeyboardInterrupt, SystemExit)
_AGAIN_S = 0.25  # seconds after which the exception of a signal, which may be lost, is raised again


def _handlers(chosen: Callable[[Any], bool]) -> dict[int, Any]:
    """Return the handlers for which `chosen` is true, by the numbers of their signals.

    Outside the main thread, which alone may change handlers, there are none.
    """
    if threading.current_thread() is not threading.main_thread():
        return {}
    handlers = {number: signal.getsignal(number) for number in (*SIGNALS, signal.SIGALRM)}
    return {number: handler for number, handler in handlers.items() if chosen(handler)}


@contextmanager
def _replaced(handlers: Mapping[int, Any], handler: Callable[..., object]) -> Iterator[None]:
    """Replace handlers, given by the numbers of their signals, until the context is left."""
    try:
        for number in handlers:
            signal.signal(number, handler)
        yield
    finally:
        for number, usual in handlers.items():
            signal.signal(number, usual)


@contextmanager
def held() -> Iterator[None]:
    """Defer signals; processes and threads that start meanwhile begin with them blocked.

    Signals received meanwhile are handled in the end, in their order, also after an exception. In
    the main thread the handlers wait as well, whichever thread a signal reaches: an exception
    raised by one can leave a lock of Python's `threading` taken, and another thread would then wait
    for it forever.
    """
    received: list[int] = []
    handlers = _handlers(callable)
    try:
        with _replaced(handlers, lambda number, _: received.append(number)):
            before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
            try:
                yield
            finally:
                signal.pthread_sigmask(signal.SIG_SETMASK, before)
    finally:
        # a stack calls every handler, also after one that raises an exception
        with ExitStack() as replay:
            for number in reversed(received):
                replay.callback(handlers[number], number, None)


@contextmanager
def terminable() -> Iterator[list[int]]:
    """Turn SIGTERM and SIGHUP into SystemExit, so that unfinished work is cleared away.

    SIGINT is recorded as well.

    Signals that already have a handler, or that are ignored (nohup), are left alone; outside the
    main thread all are. The exception of a signal can be lost: Python ignores it in a finaliser,
    and code in C drops one that it meets while it looks for an attribute. Hence an alarm raises it
    again every `_AGAIN_S` until the context is left; then an alarm that was set before is set
    again. While the exception is handled, neither the alarm nor a further signal has an effect.

    Yields:
        The numbers of the signals received, then those of alarms. The exception that arrives is not
        always the one raised here: code in C that is interrupted during its import raises an
        ImportError instead.
    """
    received: list[int] = []
    replaced_alarms: list[tuple[float, float]] = []

    def stop(number: int, _: FrameType | None) -> None:
        received.append(number)
        if _ends(sys.exc_info()[1]):  # unfinished work is being cleared away
            return
        if signal.getsignal(signal.SIGALRM) is stop:
            alarm = signal.setitimer(signal.ITIMER_REAL, _AGAIN_S, _AGAIN_S)
            replaced_alarms.append(alarm)
        first = received[0]
        if first == signal.SIGINT:
            raise KeyboardInterrupt
        raise SystemExit(128 + first)

    usual_hook = sys.unraisablehook

    def hook(lost: sys.UnraisableHookArgs) -> None:
        if not (received and _ends(lost.exc_value)):
            usual_hook(lost)

    usual_handlers = _handlers((signal.SIG_DFL, signal.default_int_handler).__contains__)
    with _replaced(usual_handlers, stop):
        try:
            sys.unraisablehook = hook
            yield received
        finally:
            if replaced_alarms:
                signal.setitimer(signal.ITIMER_REAL, *replaced_alarms[0])
            sys.unraisablehook = usual_hook


def _ends(error: BaseException | None) -> bool:
    """Return whether an exception ends the run, or was raised while one that does was handled."""
    return error is not None and (isinstance(error, _ENDS) or _ends(error.__context__))
