"""The terminal: shared options, JSON documents on stdout, progress bars on stderr."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer

SceneWord = Annotated[str, typer.Argument(metavar="SCENE", help="A scene's id, or the path of a TOML file.")]
Assignments = Annotated[
    list[str] | None, typer.Option("--set", metavar="section.key=value", help="Replace one field of the scene.")
]
AsJson = Annotated[bool, typer.Option("--json", help="One JSON document on stdout, nothing else.")]


def emit(document: dict[str, Any]) -> None:
    """Print one JSON document."""
    typer.echo(json.dumps(document, indent=1, ensure_ascii=False))


@contextmanager
def progress(label: str, total: float) -> Iterator[Callable[[float], None] | None]:
    """A bar with the simulated time on stderr, or None where stderr is no terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:,.0f} of {task.total:,.0f} s simulated"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(label, total=total)
        yield lambda t: bar.update(task, completed=t)
