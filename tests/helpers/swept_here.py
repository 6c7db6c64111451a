"""A sweep whose doubtful rows are solved in this process, by the solver or by what a test puts in its place."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from reference.scenes.scene import Scene
from reference.sweeps.part import Promote, solve_part
from reference.sweeps.promote import Promoted, promoted
from reference.sweeps.request import Settings, request
from reference.sweeps.swept import Swept

LEFT = "left to the solver"


def left(*_: Any, **__: Any) -> Promoted:
    """Leave a row to the solver: it has no numbers, and says so."""
    return Promoted({}, ([], []), LEFT)


def is_left(row: dict[str, Any]) -> bool:
    """Return whether `left` was asked for a row."""
    return LEFT in (row["reason"] or "")


def swept_here(
    scene: Scene,
    over: list[str],
    promote: Promote = promoted,
    rows: Path | None = None,
    **settings: Any,
) -> Swept:
    """Return a sweep in memory, all of its rows in one part; settings as those of a sweep."""
    asked = request(scene, over, rows, Settings(**settings))
    return Swept(asked, solved=solve_part(asked, range(asked.table.count), promote))
