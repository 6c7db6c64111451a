"""`foucault paper`: recompute the source papers' formulas, numbers and figures, with a verdict on each."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from reference.commands.terminal import AsJson, emit

from .options import counting


def command(
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Write a page with figures, CSV and JSON into this folder (extra plot)."
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Judge every formula of the source papers.

    Every formula and number is computed again; with --out the figures are drawn again too.
    """
    from ..papers import build, rows
    from ..papers.page import document

    with counting("judging") as count:

        def report(place: str, completed: int, total: int) -> None:
            count(completed, total, place)

        judged = rows(report) if out is None else build(out, report)
    if as_json:
        emit({"out": None if out is None else str(out), "rows": [document(row) for row in judged]})
        return
    for row in judged:
        detail = row.error or row.correction
        typer.echo(f"{row.verdict:13}  {row.place}: {row.printed}")
        typer.echo(f"{'':13}  {row.recomputed}{f'  ({detail})' if detail else ''}")
    typer.echo("")
    for verdict in dict.fromkeys(row.verdict for row in judged):
        typer.echo(f"{verdict:13}  {sum(row.verdict == verdict for row in judged)}")
    if out is not None:
        typer.echo(f"{out / 'index.html'}")
