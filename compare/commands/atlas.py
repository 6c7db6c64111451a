"""`foucault atlas`: one page over all golden datasets, and one for each that judges a file in the browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from reference.commands.progress import progress
from reference.commands.terminal import AsJson, emit, option, stoppable
from reference.scenes.shipped import golden_root

OUT = option("--out", "Write the pages into this folder (extra plot).", "DIR")
DATA = option("--data", "The folder of the datasets (default: those that ship).", "DIR")
STUDIES = option(
    "--studies", "Results of `foucault study` and `stability`, as JSON (default: docs/studies in a checkout).", "DIR"
)
FILES = option("--files", "Link files to URL/DATASET/FILE (default: name them alone).", "URL")


def command(
    out: Annotated[Path, OUT] = Path("atlas"),
    data: Annotated[Path | None, DATA] = None,
    studies: Annotated[Path | None, STUDIES] = None,
    files: Annotated[str, FILES] = "",
    as_json: AsJson = False,
) -> None:
    """Make a page over all golden datasets.

    The page of a scene plays its motion, has pictures, bounds and files, and judges a program's output dropped on it.
    """
    from ..report.atlas.entry import studies_folder
    from ..report.atlas.pages import build, scenes_of
    from ..report.folder import PAGE

    with stoppable("nothing half was written"), progress() as show:
        drawing = show("atlas", unit="scenes")
        sizes = build(data or golden_root(), out, studies or studies_folder(), files, drawing)
    if as_json:
        emit({"out": str(out), "pages": [{"page": name, "bytes": size} for name, size in sizes.items()]})
        return
    scenes = scenes_of(sum(name.endswith(".html") for name in sizes) - 1)
    typer.echo(f"{out / PAGE}: {scenes}, {sum(sizes.values()) / 1e6:.1f} MB in {len(sizes)} files")
