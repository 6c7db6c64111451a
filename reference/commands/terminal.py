"""Parts shared by all commands: arguments and options, JSON documents on stdout, progress bars on stderr."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Annotated, Any

import typer

from ..errors import Stopped

SceneWord = Annotated[str, typer.Argument(metavar="SCENE", help="A scene's id, or the path of a TOML file.")]
Assignments = Annotated[
    list[str] | None, typer.Option("--set", metavar="section.key=value", help="Replace one field of the scene.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout and nothing else.")]


def emit(document: dict[str, Any]) -> None:
    """Print one JSON document."""
    typer.echo(json.dumps(document, indent=1, ensure_ascii=False))


@contextmanager
def stoppable(outcome: str) -> Iterator[None]:
    """Have Ctrl-C end the command meanwhile with one line that says what became of its work, or how to go on.

    Raises:
        Stopped: it was interrupted.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise Stopped(outcome) from None


@contextmanager
def progress(label: str, total: float = 0, unit: str = "s simulated") -> Iterator[Callable[..., None] | None]:
    """Show a bar on stderr; yield the function of completed, total, item that moves it, or None without a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn(f"{{task.completed:,.0f}} of {{task.total:,.0f}} {unit}"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(label, total=total)

        def move(completed: float, total: float = total, item: str = "") -> None:
            bar.update(task, completed=completed, total=total, description=f"{label}: {item}" if item else label)

        yield move
