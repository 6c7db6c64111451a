"""Interrupt a command while it works, without guessing how long it takes to get there."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from places import ROOT

PATIENCE_S = 120.0  # for a command to get to work, and to end once it is told to


def interrupted(
    words: list[str],
    at_work: Callable[[int, bytes], bool],
    number: signal.Signals = signal.SIGINT,
    *,
    whole_group: bool = False,
) -> tuple[int, bytes, int]:
    """Run `foucault words`, send it a signal once `at_work(group, stderr)`; return exit status, stderr, and its group.

    With `whole_group` all of its processes receive the signal, as from a terminal.
    Everything that is left of it is killed if it does not get to work or does not end.
    """
    command = [sys.executable, "-m", "foucault", *words]
    with subprocess.Popen(
        command,
        cwd=ROOT,
        stderr=subprocess.PIPE,
        start_new_session=True,
        env=os.environ | {"PYTHONFAULTHANDLER": "1"},
    ) as process:
        assert process.stderr is not None
        os.set_blocking(process.stderr.fileno(), False)
        err, deadline = b"", time.monotonic() + PATIENCE_S
        try:
            while not at_work(process.pid, err):
                assert process.poll() is None, err
                assert time.monotonic() < deadline, "it does not get to work"
                err += process.stderr.read() or b""
                time.sleep(0.02)
            if whole_group:
                os.killpg(process.pid, number)
            else:
                process.send_signal(number)
            os.set_blocking(process.stderr.fileno(), True)
            err += stderr_of(process)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            raise
    return process.returncode, err, process.pid


def stderr_of(process: subprocess.Popen[Any]) -> Any:
    """Return what a process writes to stderr until it ends; one that does not is made to tell where its threads are.

    It does so where PYTHONFAULTHANDLER is set in its environment.
    """
    try:
        return process.communicate(timeout=PATIENCE_S)[1]
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGABRT)
        raise AssertionError(
            f"it does not end: {process.communicate(timeout=PATIENCE_S)[1]}"
        ) from None


def members(group: int) -> int:
    """Return the number of processes of a process group."""
    return sum(
        _group_of(int(entry.name)) == group
        for entry in Path("/proc").iterdir()
        if entry.name.isdecimal()
    )


def children() -> set[int]:
    """Return the processes that this one has started, those included that have ended and were not waited for."""
    found = set()
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has ended
            # the name before may hold anything
            parent = path.read_text().rpartition(")")[2].split()[1]
            if int(parent) == os.getpid():
                found.add(int(path.parent.name))
    return found


def gone_within(group: int, seconds: float) -> bool:
    """Return True once no process of the group is left."""
    deadline = time.monotonic() + seconds
    while members(group):
        if time.monotonic() > deadline:
            return False
        time.sleep(0.05)
    return True


def _group_of(pid: int) -> int | None:
    try:
        return os.getpgid(pid)
    except ProcessLookupError:
        return None
