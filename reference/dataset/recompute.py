"""Solve the scene of a dataset again and compare every byte."""

from __future__ import annotations

from pathlib import Path

from ..engines.plan import Report
from ..engines.registry import engine_of
from ..solver.solve import solve
from .read import read_manifest, scene_of
from .render import render


def recompute(folder: Path, report: Report | None = None) -> list[str]:
    """Solve the scene of a dataset again and compare every byte.

    Raises:
        UnreachableError: it cannot be solved again.
    """
    manifest = read_manifest(folder)
    made = render(solve(scene_of(manifest), engine=engine_of(manifest.run.number), report=report))
    return [
        f"{name}: recomputing gives other bytes"
        for name, text in made.items()
        if (folder / name).read_bytes() != text.encode()
    ]
