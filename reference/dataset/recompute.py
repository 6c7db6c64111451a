"""Recompute a dataset: solve its scene again with the same engine, and compare every byte."""

from __future__ import annotations

from pathlib import Path

from ..solver.solve import solve
from .checks.motion import Progress
from .files import read_files
from .manifest import MANIFEST
from .record import AUDIT, NO_CONFIRM
from .render import render


def recompute(folder: Path, report: Progress | None = None) -> list[str]:
    """Solve the scene of a dataset again; return a sentence for every file whose bytes differ.

    Raises:
        InputError, DatasetError: as `read_files`.
        UnreachableError: the scene cannot be solved here.
    """
    files = read_files(folder)
    manifest = files.manifest
    engine = manifest.command.partition("--engine ")[2].partition(" ")[0]
    end = float(files.scene.exact.t_end)
    words = manifest.command.split()
    confirm = manifest.level == "enclosed" and NO_CONFIRM not in words
    solution = solve(
        files.scene, engine=engine, audit=AUDIT in words, confirm=confirm, report=report and (lambda t: report(t, end))
    )
    texts = render(solution, manifest.id)
    found = {MANIFEST: manifest.text(), **files.texts}
    return [
        f"{name}: recomputing gives {'other bytes' if name in found else 'this file too'}"
        for name, text in texts.items()
        if found.get(name) != text
    ]
