"""Answers that tests have measured in child processes, in a file whose import takes little."""

from __future__ import annotations

import os
import signal
from dataclasses import dataclass

from compare.studies.row import Record
from reference.status import Status
from reference.system.process import Emit


@dataclass(frozen=True)
class Answer(Record):
    """A word that a child process sent, and what it knows of itself."""

    text: str
    status: Status = Status.OK
    process: int = 0
    threads: str = ""


def answers(emit: Emit, offset: int, items: list[tuple[str, str]]) -> None:
    """Send a word back for each item; `hangs` hangs, and `dies` ends the process."""
    for _, word in items:
        if word == "hangs":
            signal.pause()
        if word == "dies":
            os._exit(3)
        emit(Answer(f"{word} {offset}", process=os.getpid(), threads=os.environ["OMP_NUM_THREADS"]))
