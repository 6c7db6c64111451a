"""Announce work that is done once on a machine, such as compiling, and how long it will take."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

_listeners: list[Callable[[str], None]] = []
_announced: set[str] = set()


@contextmanager
def announced_to(listener: Callable[[str], None]) -> Iterator[None]:
    """Have `listener` called with one sentence for each piece of work that is done for the first time meanwhile."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def announce(what: str, seconds: int) -> None:
    """Tell the last listener, once in a process, that `what` is compiled, and that this takes about `seconds`."""
    if what not in _announced and _listeners:
        _announced.add(what)
        _listeners[-1](f"First use on this machine: {what} are compiled, once, for about {seconds} seconds.")
