"""Machine code is compiled once on a machine, kept for the very sources that it is made of, and announced once."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest
from places import ROOT

pytest.importorskip("numba")

CALLEE = """
from numba import extending

def slow(x): ...

@extending.overload(slow)
def _(x):
    import time
    print("compiled", flush=True)
    time.sleep(1)
    return lambda x: x + 1
"""
CALLER = f"""
import sys
sys.path.insert(0, {str(ROOT)!r})
from pathlib import Path
from numba import config
from callee import slow
from reference.system.channel import ANNOUNCEMENTS
from reference.system.machine_code import kept, prepare

@kept(*Path(__file__).parent.glob("*.py"), error_model="numpy")
def successor(x):
    return slow(x)

assert config.CACHE_DIR == sys.argv[1]
with ANNOUNCEMENTS.heard_by(lambda line: print("announced", flush=True)):
    prepare(successor, "functions", 3, 1)
assert len(successor.signatures) == 1
print(successor(41))
assert len(successor.signatures) == 1
"""
COLD = ["announced", "compiled", "42"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of two files, of which one calls the other."""
    (tmp_path / "callee.py").write_text(CALLEE)
    (tmp_path / "caller.py").write_text(CALLER)
    return tmp_path


def begun(folder: Path, numba: str = "numba") -> subprocess.Popen[str]:
    """Begin the program, with a folder for numba's code."""
    place = str(folder / numba)
    environment = os.environ | {"NUMBA_CACHE_DIR": place}
    command = [sys.executable, "caller.py", place]
    return subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True)


def said(process: subprocess.Popen[str]) -> list[str]:
    """Return the words that it says to its end, which has to be a good one."""
    words = process.communicate()[0].split()
    assert process.returncode == 0
    return words


def test_of_the_processes_that_live_one_compiles_and_again_if_a_function_of_another_file_changed_that_it_calls(
    folder,
):
    killed = begun(folder)
    assert killed.stdout is not None
    assert [killed.stdout.readline(), killed.stdout.readline()] == ["announced\n", "compiled\n"]
    others = [begun(folder) for _ in range(2)]
    killed.kill()
    killed.communicate()
    words = [said(process) for process in others]
    assert sorted(one.count("compiled") for one in words) == [0, 1]
    assert [one[-1] for one in words] == ["42"] * 2
    (folder / "callee.py").write_text(CALLEE.replace("x + 1", "x + 2"))
    assert said(begun(folder)) == [*COLD[:-1], "43"]
    assert {path.is_relative_to(folder / "numba") for path in folder.rglob("*.nb?")} == {True}


FOLDER = """
from pathlib import Path
from reference.system.machine_code import folder_of
print(folder_of(Path(name) for name in ("caller.py", "callee.py")))
"""


def test_it_is_kept_beside_the_package_or_else_in_the_cache(folder):
    """Nothing can be written beside a package in an archive."""
    archive = folder / "packed.zip"
    with ZipFile(archive, "w") as packed:
        for path in [*(ROOT / "reference").rglob("*.py"), *(ROOT / "reference").rglob("*.pyi")]:
            packed.write(path, path.relative_to(ROOT))
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment["FOUCAULT_CACHE"] = str(folder / "cache")

    def kept_in(package):
        told = subprocess.check_output(
            [sys.executable, "-c", FOLDER],
            cwd=folder,
            env=environment | {"PYTHONPATH": str(package)},
            text=True,
        )
        return Path(told.strip())

    beside = kept_in(ROOT)
    assert beside.parent == ROOT / "reference" / "system" / "__pycache__"
    assert kept_in(archive) == folder / "cache" / "machine_code" / beside.name


def test_where_nothing_can_be_kept_it_is_compiled_for_this_process(folder):
    """Nor does numba keep it beside the sources, where it would look at one file alone."""
    (folder / "file").touch()
    assert said(begun(folder, numba="file/numba")) == COLD
    assert not [*folder.rglob("*.nb?")]
