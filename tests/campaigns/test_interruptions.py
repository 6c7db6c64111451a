"""Ctrl-C, SIGTERM and SIGHUP at any moment of a command, to its whole process group, as a terminal sends them."""

from __future__ import annotations

import os
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from interruption import gone_within
from moments import PATIENCE_S, chosen, ended_at, undisturbed
from places import ROOT
from sampled import one_in

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="counts processes in /proc")

PROGRAM = "import time; print(0, 0.3, 0.4, flush=True); time.sleep(2)"
STUDY = ["study", "paris", "--t-end", "60", "--methods", "rk4", "--no-formulations", "--out"]
GOES_ON = "foucault: stopped; the same command with the same --out goes on where it stopped"
SWEEP = ["sweep", "paris", "--over", "site.latitude=-80:80:20", "--t-end", "60", "--audit", "0"]
COMMANDS: dict[str, tuple[list[str], str]] = {
    "scenes": (["scenes"], ""),
    "generate": (["generate", "paris", "--t-end", "120", "--digits", "20", "--out"], "foucault: stopped; nothing "),
    "study": (STUDY, GOES_ON),
    "study --run": ([*STUDY[:4], *("--methods", "rk4", "--run", "PROGRAM", "--out")], GOES_ON),
    "stability": (["stability", "--scenes", "hard", "--methods", "rk4", "--out"], GOES_ON),
    "sweep": ([*SWEEP, "--engine", "heyoka", "--out"], "foucault: stopped; what is done is in "),
    "sweep --digits": ([*SWEEP, "--digits", "16", "--out"], "foucault: stopped; what is done is in "),
}


def running(word: str) -> bool:
    """Return True if a process was started with a word in its command, also in a session of its own."""
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with suppress(OSError):  # it has ended
            if word.encode() in path.read_bytes():
                return True
    return False


@pytest.mark.parametrize(
    "name",
    [name if name == "generate" else pytest.param(name, marks=pytest.mark.long) for name in COMMANDS],
)
def test_a_command_ends_with_one_line_and_nothing_half(
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    size: Callable[[int, int], int],
    tally: Callable[[str], None],
) -> None:
    pytest.importorskip("numba")
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / "cache"))
    words, advice = COMMANDS[name]
    place = tmp_path / "place"
    place.mkdir()
    words = [*words, str(place / "out")] if words[-1] == "--out" else words
    program = shlex.join([sys.executable, "-c", PROGRAM, str(place)])
    words = [program if word == "PROGRAM" else word for word in words]
    for _ in range(size(0, 1)):
        ended_at(-1, signal.SIGINT, words)  # what is compiled once is compiled
        shutil.rmtree(place / "out", ignore_errors=True)
    _, times = undisturbed(tmp_path / "note", words)
    hits = said = 0
    for i, event in enumerate(chosen(times, size(1, 12), 5)):
        numbers = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
        for number in [*numbers[i % 3 :], *numbers][: size(1, 3)]:
            shutil.rmtree(place / "out", ignore_errors=True)
            ended = ended_at(event, number, words)
            assert ended.status in (128 + number, -number, 0), ended.err
            assert "Traceback" not in ended.err and "Error" not in ended.err
            lines = ended.err.splitlines()
            assert len(lines) <= 1
            assert all(line.startswith(advice) for line in lines)
            assert gone_within(ended.group, 10.0) and not running(str(place)), "processes run on"
            hits += ended.status != 0
            said += len(lines)
            assert [path.name for path in place.iterdir()] in ([], ["out"])
    assert hits >= 0.9 * size(1, 36)  # the number of events varies by a few
    tally(f"{name}: {hits} interruptions at work, {said} of them with a line, no traceback, no half file, no orphan")


# what happens inside a command, where INTERRUPT sends it a signal
HIDDEN = """
    try:
        INTERRUPT
    except BaseException as end:
        raise {} from end
"""
LOST = """
    class Last:
        def __del__(self):
            INTERRUPT
            time.sleep(0)

    Last()
    time.sleep(20)
    print("went on")
"""
DROPPED = """
    import ctypes

    class Last:
        @property
        def asked(self):
            INTERRUPT
            time.sleep(0)

    ctypes.pythonapi.PyObject_HasAttrString(ctypes.py_object(Last()), b"asked")
    time.sleep(20)
    print("went on")
"""
ENGINE = 'InputError("--engine", "heyoka", "an installed engine")'
AGAIN = """
    try:
        INTERRUPT
    finally:
        INTERRUPT
        try:
            {}["a key"]
        except KeyError:
            time.sleep(0.6)
        print("cleared away")
"""
AT_WORK = """
    from concurrent.futures import ThreadPoolExecutor

    ThreadPoolExecutor().submit(time.sleep, 600)
    INTERRUPT
"""
EXECUTED = """
    exec("INTERRUPT")
"""
BODIES = [
    HIDDEN.format('ImportError("initialization failed")'),
    HIDDEN.format(ENGINE),
    LOST,
    DROPPED,
    AGAIN,
    EXECUTED,
    AT_WORK,
]


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("number", one_in(3, [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]))
def test_an_interruption_that_other_code_turns_into_an_error_or_loses_is_one(
    number: signal.Signals, body: str, tmp_path: Path
) -> None:
    """Code in C that is interrupted while it is imported raises an error; it drops one that it meets in `hasattr`.

    It ends by SIGINT itself after an exec that Ctrl-C has ended, waits for threads, and would interrupt clearing away.
    """
    body = body.replace("INTERRUPT", f"os.kill(os.getpid(), {int(number)})")
    program = f"import os, time, foucault\nfrom reference.errors import InputError\n\ndef interrupted(prog_name):{body}"
    program += "\nfoucault.commands = lambda: interrupted\nfoucault.main()\n"
    (tmp_path / "program.py").write_text(program)
    command, env = [sys.executable, "-m", "program"], os.environ | {"PYTHONPATH": str(ROOT)}
    ended = subprocess.run(
        command, cwd=tmp_path, env=env, capture_output=True, text=True, check=False, timeout=PATIENCE_S
    )
    output = "cleared away\n" * ("cleared" in body)
    assert (ended.returncode, ended.stdout, ended.stderr) == (128 + number, output, "foucault: stopped\n")
