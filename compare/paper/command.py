"""`foucault paper`: the seeds' numbers and figures again, with a verdict on each."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from reference.cli import AsJson, emit


def register(app: typer.Typer) -> None:
    """Add the command to an app."""
    app.command("paper")(command)


def command(
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write a page with figures (extra plot), CSV and JSON.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Recompute every formula and number of the papers and judge it; with --out draw the figures again too."""
    from . import build, rows
    from .page import document

    with _progress() as report:
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


@contextmanager
def _progress() -> Iterator[Callable[[str, int, int], None] | None]:
    """A bar on stderr, or None where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("judging", total=None)
        yield lambda place, done, total: bar.update(task, completed=done, total=total, description=place)
