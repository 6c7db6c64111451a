"""An error that nobody foresaw, here one of a broken library: its own exit status, and what to report."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from places import ROOT

FAULT = "foucault: This is a fault of foucault, not yours. Please report the command, what `foucault --version` prints"


def with_broken(
    library: str, raised: str, folder: Path, *words: str, redirected: str = ""
) -> subprocess.CompletedProcess[str]:
    """Run a command where a library raises an exception as it is imported; `redirected` is for the shell."""
    (folder / f"{library}.py").write_text(f"raise {raised}\n")
    path = os.pathsep.join([str(folder), str(ROOT)])
    command = [
        "bash",
        "-c",
        f'exec "$@" {redirected}',
        "bash",
        sys.executable,
        "-m",
        "foucault",
        *words,
    ]
    return subprocess.run(
        command,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )


# which a command imports, and the command line itself
@pytest.mark.parametrize("library", ["heyoka", "pydantic"])
@pytest.mark.parametrize("raised", ["TypeError('odd')", "EOFError('odd')", "MemoryError('odd')"])
def test_what_nobody_foresaw_is_no_verdict_and_says_how_to_report_it(tmp_path, library, raised):
    done = with_broken(library, raised, tmp_path, "show", "paris", "--json")
    assert (done.returncode, done.stdout) == (70, "")
    first, *others = done.stderr.splitlines()
    assert first.startswith(FAULT)
    assert others[0] == "Traceback (most recent call last):"
    assert f"{library}.py" in done.stderr and raised.replace("('odd')", ": odd") in others


def test_a_traceback_writes_control_characters_out(tmp_path):
    done = with_broken("heyoka", r"TypeError('\x1b[2J')", tmp_path, "show", "paris")
    assert (
        done.returncode == 70 and r"TypeError: \x1b[2J" in done.stderr and "\x1b" not in done.stderr
    )


@pytest.mark.parametrize(
    ("raised", "status", "said"),
    [
        ("KeyboardInterrupt", 130, "foucault: stopped\n"),
        ("SystemExit(5)", 5, ""),
        ("BrokenPipeError(32, 'gone')", 141, ""),
    ],
)
def test_an_end_that_was_asked_for_is_no_fault(tmp_path, raised, status, said):
    done = with_broken("heyoka", raised, tmp_path, "show", "paris", "--json")
    assert (done.returncode, done.stdout, done.stderr) == (status, "", said)


@pytest.mark.parametrize(("scene", "status"), [("paris", 70), ("atlantis", 2)])
@pytest.mark.parametrize("stderr", ["2>&-", "2>/dev/full"], ids=["closed", "full"])
def test_a_status_stays_where_the_message_cannot_be_written(tmp_path, scene, status, stderr):
    done = with_broken("heyoka", "TypeError", tmp_path, "show", scene, "--json", redirected=stderr)
    assert (done.returncode, done.stdout) == (status, "")
