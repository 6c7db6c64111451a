"""A copy of the project with a few scenes and no golden datasets: a test may make and change what ships there."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from places import ROOT


def own_project(folder: Path, scenes: Iterable[str]) -> Path:
    """Copy the project's programs, and some of its scenes, into a new folder."""
    for package in ("reference", "compare"):
        # compiled code
        shutil.copytree(
            ROOT / package, folder / package, ignore=shutil.ignore_patterns("foucault-*")
        )
    shutil.copy2(ROOT / "foucault.py", folder)
    (folder / "data/scenes").mkdir(parents=True)
    (folder / "data/golden").mkdir()
    shutil.copy(ROOT / "data/flags.toml", folder / "data")
    for scene in scenes:
        shutil.copy(ROOT / f"data/scenes/{scene}.toml", folder / "data/scenes")
    return folder


def environment_of(project: Path) -> dict[str, str]:
    return os.environ | {"PYTHONPATH": str(project)}


WITHOUT_NUMBA = "import sys; sys.modules['numba'] = None; from foucault import main; main()"


def foucault_of(project: Path, *words: object, numba: bool = True) -> Any:
    """Run a command of a copy of the project; return the finished process with its output as text.

    Args:
        project: the folder of the copy.
        words: of the command.
        numba: whether it is installed: for a new folder it compiles all again.
    """
    begin = ["-m", "foucault"] if numba else ["-c", WITHOUT_NUMBA]
    command = [sys.executable, *begin, *map(str, words)]
    return subprocess.run(
        command,
        cwd=project,
        env=environment_of(project),
        capture_output=True,
        text=True,
        check=False,
    )
