"""Folders in which something is made: one of a killed process goes, one in use stays, whatever its number says."""

from __future__ import annotations

import errno
import os
import pkgutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from reference.system import workspace as module
from reference.system.interruption import terminable
from reference.system.workspace import OLD, workspace

HOLDER = """
import sys, time
from pathlib import Path
from reference.system.workspace import workspace
with workspace(Path(sys.argv[1]), "pp") as work:
    print(work, flush=True)
    time.sleep(600)
"""


def left(parent: Path) -> list[str]:
    return sorted(path.name for path in parent.iterdir())


def test_the_folder_is_there_for_the_work_and_gone_after_it(tmp_path):
    with workspace(tmp_path, "pp") as work:
        assert work.parent == tmp_path
        assert work.name.startswith(".pp.partial-")
        (work / "half").write_text("done")
    assert left(tmp_path) == []
    with pytest.raises(KeyboardInterrupt), workspace(tmp_path, "pp") as work:
        (work / "half").write_text("done")
        raise KeyboardInterrupt
    assert left(tmp_path) == []


@pytest.mark.parametrize(
    "place", ["filelock.FileLock.acquire", "filelock.FileLock.release", "shutil.rmtree"]
)
def test_an_interruption_as_it_begins_or_ends_leaves_nothing(tmp_path, monkeypatch, place):
    usual, calls = pkgutil.resolve_name(place), []

    def interrupted(*arguments: object, **options: object) -> object:
        calls.append(place)
        if len(calls) == 1:
            raise KeyboardInterrupt
        return usual(*arguments, **options)

    monkeypatch.setattr(place, interrupted)
    with pytest.raises(KeyboardInterrupt), workspace(tmp_path, "pp"):
        pass
    assert left(tmp_path) == []


def test_a_signal_as_the_folder_comes_to_be_leaves_nothing(tmp_path, monkeypatch):
    usual = tempfile.mkdtemp

    def made(**options: object) -> str:
        folder = usual(**options)
        os.kill(os.getpid(), signal.SIGTERM)
        return folder

    monkeypatch.setattr("tempfile.mkdtemp", made)
    with pytest.raises(SystemExit), terminable(), workspace(tmp_path, "pp"):
        pass
    assert left(tmp_path) == []


KEPT = """
import contextlib, foucault, os, sys

def command(**_):
    @contextlib.contextmanager
    def making():
        open(sys.argv[1], "w").close()
        try:
            yield
        finally:
            os.remove(sys.argv[1])
    begun = making()
    begun.__enter__()  # as where a signal comes before the body of a `with` begins
    os.kill(os.getpid(), 15)

foucault.commands = lambda: command
foucault.main()
"""


def test_what_a_signal_interrupts_as_it_begins_is_cleared_away_before_the_end(tmp_path):
    ended = subprocess.run(
        [sys.executable, "-c", KEPT, tmp_path / "made"], capture_output=True, check=False
    )
    assert ended.returncode == 128 + signal.SIGTERM
    assert left(tmp_path) == []


def test_a_living_process_keeps_its_folder_and_a_killed_one_does_not(tmp_path):
    with subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)], stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        held = Path(process.stdout.readline().decode().strip())
        with workspace(tmp_path, "pp") as work:
            assert left(tmp_path) == sorted([held.name, work.name])
        process.send_signal(signal.SIGKILL)
    assert held.is_dir()
    with workspace(tmp_path, "pp"):
        assert not held.exists()


@pytest.mark.parametrize("name", ["pp", "a[b]*?", "-x", "ü ü"])
def test_those_of_the_name_go_and_folders_of_other_names_stay(tmp_path, name):
    for other in (f".{name}.partial-1", ".other.partial-1", f".{name}.backup", f"{name}.partial-1"):
        (tmp_path / other).mkdir()
    with workspace(tmp_path, name):
        pass
    assert left(tmp_path) == sorted([".other.partial-1", f".{name}.backup", f"{name}.partial-1"])


@pytest.mark.parametrize("replaced", [False, True])
def test_what_was_moved_away_by_a_killed_process_comes_back_unless_it_was_replaced(
    tmp_path, replaced
):
    stale = tmp_path / ".pp.partial-1"
    (stale / OLD).mkdir(parents=True)
    (stale / OLD / "grid.csv").write_text("years of work")
    if replaced:
        (tmp_path / "pp").mkdir()
    with workspace(tmp_path, "pp"):
        pass
    assert left(tmp_path) == ["pp"]
    assert left(tmp_path / "pp") == ([] if replaced else ["grid.csv"])


def test_on_a_disk_without_locks_none_is_cleared_away(tmp_path, monkeypatch):
    def no_locks(*_: object) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr("fcntl.flock", no_locks)
    stale = tmp_path / ".pp.partial-stale"
    stale.mkdir()
    with workspace(tmp_path, "pp") as work:
        assert left(tmp_path) == sorted([stale.name, work.name])
    assert left(tmp_path) == [stale.name]


def test_a_folder_that_is_cleared_before_it_is_locked_is_made_anew(tmp_path, monkeypatch):
    """Another process may find a folder between its making and its locking."""
    made, make = [], module.tempfile.mkdtemp

    def cleared(*args, **keywords):
        path = make(*args, **keywords)
        made.append(Path(path))
        if len(made) == 1:
            made[0].rmdir()
        return path

    monkeypatch.setattr(module.tempfile, "mkdtemp", cleared)
    with workspace(tmp_path, "pp") as work:
        assert work in made
        assert work.is_dir()
    assert left(tmp_path) == []
