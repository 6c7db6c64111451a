"""A program with all that it starts, so that it can be ended whole.

Its process group takes in what it starts the usual way. What forks into a session of its own leaves the group, and
its parent may be gone: on Linux it is known by a mark in the environment that it inherited. Elsewhere, and where a
program clears its environment, the group is all that is found.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import signal
import time
from collections.abc import Iterator
from pathlib import Path

MARK = "FOUCAULT_RUN"
_PROCESSES = Path("/proc")
_ROUNDS = 100  # of looking for what was started while the others were ended
_PAUSE_S = 0.01  # until what was killed is gone


class Family:
    """The processes of one program, which is started with `environment` as the leader of a session."""

    def __init__(self) -> None:
        self._word = secrets.token_hex(16)

    @property
    def environment(self) -> dict[str, str]:
        """This process's environment and the mark; the marks of those who run this process stay in it."""
        marks = [os.environ[MARK]] if MARK in os.environ else []
        return {**os.environ, MARK: " ".join([*marks, self._word])}

    def end(self, leader: int) -> None:
        """Kill the leader's group, and whoever else has the mark, until nobody is left."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(leader, signal.SIGKILL)
        for _ in range(_ROUNDS):
            left = list(self._marked())
            for pid in left:
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.kill(pid, signal.SIGKILL)
            if not left:
                return
            time.sleep(_PAUSE_S)

    def _marked(self) -> Iterator[int]:
        word = self._word.encode()
        for folder in _PROCESSES.glob("[0-9]*"):
            with contextlib.suppress(OSError):  # gone, or another user's
                if word in (folder / "environ").read_bytes():
                    yield int(folder.name)
