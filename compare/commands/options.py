"""Shared parts of the commands: comma-separated options, result folders, progress bars on stderr."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from reference import InputError

Counted = Callable[[int, int, str], None]


def listed(text: str | None, field: str, known: Iterable[str]) -> list[str] | None:
    """Split a comma-separated option into words; refuse a word that is not known."""
    if text is None:
        return None
    words = [word.strip() for word in text.split(",") if word.strip()]
    allowed = list(known)
    for word in words or [""]:
        if word not in allowed:
            raise InputError(field, word, f"of {', '.join(allowed)}", "Separate several with commas.")
    return words


def numbers(text: str, field: str) -> list[float]:
    """Split a comma-separated option into positive numbers."""
    try:
        values = [float(word) for word in text.split(",")]
    except ValueError:
        values = []
    if not values or not all(0 < value < float("inf") for value in values):
        raise InputError(field, text, "positive numbers", "Separate several with commas.")
    return values


def inside(folder: Path | None, name: str) -> Path | None:
    """Return the path of a file in a folder of results; None if there is no folder."""
    return None if folder is None else folder / name


@contextmanager
def counting(label: str) -> Iterator[Counted]:
    """Show a progress bar if stderr is a terminal; yield its update(completed, total, current item)."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda completed, total, item: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda completed, total, item: bar.update(
            task, completed=completed, total=total, description=f"{label}: {item}"
        )


def announce(text: str) -> None:
    """Print a message on stderr before work that takes long."""
    typer.echo(text, err=True)
