"""Ctrl-C, SIGTERM and SIGHUP that other code turns into an error, loses, or meets while it clears away."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from moments import PATIENCE_S
from places import ROOT
from sampled import one_in

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
        command,
        cwd=tmp_path,
        env=env,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    output = "cleared away\n" * ("cleared" in body)
    assert (ended.returncode, ended.stdout, ended.stderr) == (
        128 + number,
        output,
        "foucault: stopped\n",
    )
