"""Several processes that need the same machine code at the same time compile it once."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from places import ROOT

pytest.importorskip("numba")

MODULE = f"""
import sys, time
sys.path.insert(0, {str(ROOT)!r})
from numba import extending, njit
from reference.system.machine_code import kept

def slow(x): ...

@extending.overload(slow)
def _(x):
    print("compiled", flush=True)
    time.sleep(1)
    if FAILS:
        raise KeyboardInterrupt
    return lambda x: x + 1

with kept(sources=sys.argv[1] if sys.argv[1:] else ""):
    @njit(cache=True)
    def successor(x):
        return slow(x)
"""
CALL = "import functions; functions.FAILS = False; print(functions.successor(41))"
FAIL = """
import functions
for functions.FAILS in (True, False):
    try:
        print(functions.successor(41))
    except KeyboardInterrupt:
        pass
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the module, written once: numba compares the time of a source with that of its code."""
    (tmp_path / "functions.py").write_text(MODULE)
    return tmp_path


def begun(program: str, folder: Path, *arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen([sys.executable, "-c", program, *arguments], cwd=folder, stdout=subprocess.PIPE, text=True)


def test_of_three_processes_one_compiles(folder: Path) -> None:
    said = [process.communicate(timeout=60)[0].split() for process in [begun(CALL, folder) for _ in range(3)]]
    assert sorted(said) == [["42"], ["42"], ["compiled", "42"]]
    assert not [*folder.rglob("*.lock")]


def test_a_process_that_is_killed_while_it_compiles_leaves_the_turn_to_the_others(folder: Path) -> None:
    killed = begun(CALL, folder)
    assert killed.stdout is not None
    assert killed.stdout.readline() == "compiled\n"
    other = begun(CALL, folder)
    killed.kill()
    killed.communicate()
    assert other.communicate(timeout=60)[0].split() == ["compiled", "42"]
    assert not [*folder.rglob("*.lock")]


def test_a_function_that_failed_to_compile_can_be_compiled_by_the_same_process(folder: Path) -> None:
    assert begun(FAIL, folder).communicate(timeout=60)[0].split() == ["compiled", "compiled", "42"]


def test_what_is_made_of_other_sources_is_compiled_again(folder: Path) -> None:
    said = [begun(CALL, folder, sources).communicate(timeout=60)[0].split() for sources in ("first", "other", "first")]
    assert said == [["compiled", "42"], ["compiled", "42"], ["42"]]
