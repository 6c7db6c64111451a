"""Recompute a dataset: solve its scene again with the same engine, and compare every byte."""

from __future__ import annotations

from pathlib import Path

from ..engines.plan import Report
from ..solver.solve import solve
from .read import read_manifest, scene_of
from .render import render


def recompute(folder: Path, report: Report | None = None) -> list[str]:
    """Solve the scene of a dataset again; return a sentence for every file whose bytes differ.

    Raises:
        UnreachableError: the scene cannot be solved here.
    """
    manifest = read_manifest(folder)
    files = render(solve(scene_of(manifest), engine=_engine(manifest.command), report=report))
    return [
        f"{name}: recomputing gives other bytes"
        for name, text in files.items()
        if (folder / name).read_bytes() != text.encode()
    ]


def _engine(command: str) -> str:
    """Return the engine that the command of a dataset names."""
    _, _, words = command.partition("--engine ")
    return words.split()[0]
