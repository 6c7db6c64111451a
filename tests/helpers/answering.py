"""Replies that tests have measured in child processes, in a file whose import takes little."""

from __future__ import annotations

import os
import signal
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from compare.studies.campaign import Measurement
from reference.status import Status


@dataclass(frozen=True)
class Reply:
    """A word that a child process sent, and what it knows of itself."""

    text: str
    status: Status = Status.OK
    process: int = 0
    threads: str = ""


@dataclass(frozen=True)
class Replies(Measurement[tuple[str, str], Reply]):
    """A word that is sent back for each item; `hangs` hangs, and `dies` ends the process."""

    recipe: Any = "one"
    patience_s: float = 2.0
    commands: Mapping[str, str] = field(default_factory=dict)
    offset: int = 7

    kind = Reply

    def measure(self, item: tuple[str, str]) -> Reply:
        word = item[-1]
        if word == "hangs":
            signal.pause()
        if word == "dies":
            os._exit(3)
        return Reply(
            f"{word} {self.offset}", process=os.getpid(), threads=os.environ["OMP_NUM_THREADS"]
        )

    def failed(self, item: tuple[str, str], status: Status, reason: str) -> Reply:
        return Reply(f"{item[-1]}: {reason}", status)
