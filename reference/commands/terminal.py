"""Parts shared by all commands: arguments and options, JSON documents on stdout, progress bars on stderr."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Annotated, Any

import typer

SceneWord = Annotated[str, typer.Argument(metavar="SCENE", help="A scene's id, or the path of a TOML file.")]
Assignments = Annotated[
    list[str] | None, typer.Option("--set", metavar="section.key=value", help="Replace one field of the scene.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout and nothing else.")]


def emit(document: dict[str, Any]) -> None:
    """Print one JSON document."""
    typer.echo(json.dumps(document, indent=1, ensure_ascii=False))


@contextmanager
def bar(label: str, total: float | None, count: str = "") -> Iterator[Callable[..., None] | None]:
    """Show a bar on stderr; yield `rich.progress`'s function that updates it, or None without a terminal.

    Args:
        label: stands before the bar.
        total: what `completed` comes to at the end; None if it is not known yet.
        count: how `task.completed` and `task.total` are printed behind the bar; as "3/12" if empty.
    """
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    if not console.is_terminal:
        yield None
        return
    counted = TextColumn(count) if count else MofNCompleteColumn()
    columns = (TextColumn("{task.description}"), BarColumn(), counted, TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as shown:
        yield partial(shown.update, shown.add_task(label, total=total))


@contextmanager
def progress(label: str, total: float) -> Iterator[Callable[[float], None] | None]:
    """Show a bar with the simulated time on stderr; yield the function that moves it, or None without a terminal."""
    with bar(label, total, "{task.completed:,.0f} of {task.total:,.0f} s simulated") as update:
        yield None if update is None else lambda t: update(completed=t)
