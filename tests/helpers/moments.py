"""Have a command send itself a signal at the n-th event that Python reports (PEP 578): any moment, at any load.

Events are imports, opened files, renames, started processes, compiled code and the like: all that a command does
to the world, and enough between for a moment to be chosen by the time that it has in an undisturbed run.
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from places import ROOT

if TYPE_CHECKING:
    pass

PATIENCE_S = 300.0


@dataclass(frozen=True)
class Ended:
    """A command that has ended: exit status (minus the signal that killed it), stdout, stderr, its process group."""

    status: int
    out: str
    err: str
    group: int


def ended_at(event: int, number: signal.Signals, words: Sequence[object], named: str = "") -> Ended:
    """Run `foucault words`; at an event, a signal goes to its group, or to it alone if that is SIGKILL.

    Where a name is given, events of this name alone are counted.
    """
    return _run([str(event), str(int(number)), "-", named], words)


def undisturbed(note: Path, words: Sequence[object], named: str = "") -> tuple[Ended, list[float]]:
    """Run `foucault words` to its end; return it, and the time of each of its events in s, or of those of a name."""
    ended = _run(["-1", "0", str(note), named], words)
    assert ended.status in (0, 1), ended.err
    return ended, json.loads(note.read_text())


def chosen(times: list[float], count: int, seed: int) -> list[int]:
    """Choose events at random, every second of the run alike."""
    source = random.Random(seed)
    moments = [source.uniform(times[0], times[-1]) for _ in range(count)]
    return [next(i for i, time_s in enumerate(times) if time_s >= moment) for moment in moments]


def _run(how: list[str], words: Sequence[object]) -> Ended:
    command = [sys.executable, __file__, *how, *map(str, words)]
    with subprocess.Popen(
        command,
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # else the first run has events that no later one has
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
    ) as process:
        try:
            out, err = process.communicate(timeout=PATIENCE_S)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            raise
    return Ended(process.returncode, out, err, process.pid)


def _foucault(event: int, number: int, note: str, named: str, words: list[str]) -> None:
    sys.path.insert(0, str(ROOT))
    import foucault

    times: list[float] = []
    done = False

    def hook(name: str, _: object) -> None:
        nonlocal done
        if done or (named and name != named):
            return
        times.append(time.monotonic())
        if len(times) - 1 == event:
            done = True
            if number == signal.SIGKILL:
                os.kill(os.getpid(), number)
            else:
                os.killpg(0, number)

    sys.argv = ["foucault", *words]
    sys.addaudithook(hook)
    try:
        foucault.main()
    finally:
        done = True
        if note != "-":
            Path(note).write_text(json.dumps(times))


if __name__ == "__main__":
    _foucault(int(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:5], sys.argv[5:])
