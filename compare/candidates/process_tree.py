"""A child process and all its descendants, so that they can be killed together.

Descendants normally stay in the child's process group. One that forks into a session of its own leaves the group, and
its parent may have exited: on Linux it is recognised by a mark in the environment that it inherited. On other systems,
and if a program clears its environment, only the group is killed.
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
_ROUNDS = 100  # searches at most: a process may be started while the others are killed
_PAUSE_S = 0.01  # s, for killed processes to disappear


class ProcessTree:
    """The processes of one program, which is to be started with `environment` and as the leader of a session."""

    def __init__(self) -> None:
        self._word = secrets.token_hex(16)

    @property
    def environment(self) -> dict[str, str]:
        """This process's environment with the mark added; marks that this process has inherited stay in it."""
        marks = [os.environ[MARK]] if MARK in os.environ else []
        return {**os.environ, MARK: " ".join([*marks, self._word])}

    def end(self, leader: int) -> None:
        """Kill the leader's process group and every process with the mark, until none is left."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(leader, signal.SIGKILL)
        for _ in range(_ROUNDS):
            pids = list(self._marked())
            for pid in pids:
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.kill(pid, signal.SIGKILL)
            if not pids:
                return
            time.sleep(_PAUSE_S)

    def _marked(self) -> Iterator[int]:
        """Yield the ids of the processes with the mark."""
        word = self._word.encode()
        for folder in _PROCESSES.glob("[0-9]*"):
            with contextlib.suppress(OSError):  # it has ended, or is another user's
                if word in (folder / "environ").read_bytes():
                    yield int(folder.name)
