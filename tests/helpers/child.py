"""Functions that tests run in a child process."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

from reference.errors import InputError


def doubled(parent: Any, factor: int) -> None:
    """Send back what arrives, times a factor, for as long as anything arrives."""
    for item in parent:
        parent(item * factor)


def count_to(parent: Any, last: int) -> None:
    """Send the numbers from 1 on and return."""
    for i in range(1, last + 1):
        parent(i)


def refuse(parent: Any) -> None:
    """Raise an error that a user would see."""
    raise InputError("length", "-1", "a length above 0")


def freeze(parent: Any) -> None:
    """Send the number of this process and stop it (SIGSTOP), so that it does not notice the end of its parent."""
    parent(os.getpid())
    os.kill(os.getpid(), signal.SIGSTOP)


class _Slow:
    def __init__(self, parent: Any) -> None:
        self.parent = parent

    def __del__(self) -> None:
        self.parent("finalising")
        time.sleep(30)


def finalise(parent: Any) -> None:
    """Send a word from a finaliser that takes long; Python ignores exceptions there, and says so."""
    _Slow(parent)


def report_and_wait(emit: Any, reached: float, file: str) -> None:
    """Send how far this has come, wait until a file is there, and send a result."""
    emit(reached)
    while not Path(file).exists():
        time.sleep(0.01)
    emit("done")


def hold(parent: Any, folder: str) -> None:
    """Send a word, and wait; leave a file when it ends by an exception."""
    try:
        parent("held")
        while True:
            time.sleep(600)
    finally:
        (Path(folder) / "cleared").touch()


class DeadlyArgument:
    """An argument whose sending kills the process that sends it."""

    def __reduce__(self) -> Any:
        os.kill(os.getpid(), signal.SIGKILL)


def die() -> None:
    """Kill this process."""
    os.kill(os.getpid(), signal.SIGKILL)


def die_once(folder: str) -> str:
    """Kill this process the first time."""
    mark = Path(folder) / "died"
    if not mark.exists():
        mark.touch()
        die()
    return "alive"
