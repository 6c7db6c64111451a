"""`foucault verify`: check golden datasets, or solve them again and compare every byte."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError
from ..shipped import data_root
from .progress import progress
from .terminal import AsJson, completion, emit


def command(
    paths: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="PATH",
            help="Ids or folders of datasets (default: all that come with the project).",
            autocompletion=completion(lambda: [folder.name for folder in _shipped()]),
        ),
    ] = None,
    recompute: Annotated[
        bool, typer.Option("--recompute", help="Also solve each scene again and compare every byte.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Check golden datasets: schema, hashes and physics."""
    from ..dataset.read import golden_folder, read_manifest, scene_of
    from ..dataset.recompute import recompute as recomputed
    from ..dataset.verify import problems_of

    folders = [golden_folder(path) for path in paths or ()] or _shipped()
    if not folders:
        raise InputError("PATH", "nothing", "a golden dataset", "Make one with `foucault generate`.")
    rows = []
    for folder in folders:
        problems = problems_of(folder)
        if recompute and not problems:
            with progress() as show:
                problems = recomputed(folder, show(folder.name, float(scene_of(read_manifest(folder)).exact.t_end)))
        rows.append({"path": str(folder), "ok": not problems, "problems": problems})
        if not as_json:
            typer.echo(f"{folder}: {'ok' if not problems else 'WRONG'}")
            for problem in problems:
                typer.echo(f"  {problem}")
    if as_json:
        emit({"rows": rows})
    if not all(row["ok"] for row in rows):
        raise typer.Exit(1)


def _shipped() -> list[Path]:
    """Return the folders of the datasets that come with the project."""
    return sorted((data_root() / "golden").glob("[a-z]*"))
