"""The shape of the house: imports go one way, and heavy or dangerous libraries have one door each."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SOURCES = sorted([ROOT / "foucault.py", *(ROOT / "reference").rglob("*.py"), *(ROOT / "compare").rglob("*.py")])


def imported(path: Path) -> set[str]:
    """Top-level packages that a file imports anywhere; relative imports count as their own package."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module.split(".")[0])
    return found


def test_imports_go_one_way():
    for path in SOURCES:
        inside = path.relative_to(ROOT).parts[0]
        if inside == "reference":
            assert not imported(path) & {"compare", "foucault"}, path
        elif inside == "compare":
            assert "foucault" not in imported(path), path


@pytest.mark.parametrize(
    ("library", "door"), [("heyoka", "reference/engines/heyoka/"), ("flint", "reference/enclosure/")]
)
def test_a_library_has_one_door(library, door):
    users = [path.relative_to(ROOT).as_posix() for path in SOURCES if library in imported(path)]
    assert users
    assert all(user.startswith(door) for user in users), users


HEAVY = ("heyoka", "flint", "scipy", "matplotlib", "numba")


@pytest.mark.parametrize(
    "script", ["import compare, reference", "import foucault; foucault.app(['--help'], standalone_mode=False)"]
)
def test_starting_loads_nothing_heavy(script):
    code = f"import sys\n{script}\nprint('loaded', [name for name in {HEAVY} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.splitlines()[-1] == "loaded []"


def test_every_scene_has_its_own_file_named_by_its_id():
    names = sorted(path.stem for path in (ROOT / "data/scenes").glob("*.toml"))
    assert names
    assert len(names) == len(set(names))
