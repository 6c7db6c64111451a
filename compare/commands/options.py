"""What the commands share: words of options, folders of results, and bars of progress on stderr."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from reference import InputError

Counted = Callable[[int, int, str], None]


def listed(text: str | None, field: str, known: Iterable[str]) -> list[str] | None:
    """The words of a comma-separated option, each of them known."""
    if text is None:
        return None
    words = [word.strip() for word in text.split(",") if word.strip()]
    allowed = list(known)
    for word in words or [""]:
        if word not in allowed:
            raise InputError(field, word, f"of {', '.join(allowed)}", "Separate several with commas.")
    return words


def numbers(text: str, field: str) -> list[float]:
    """The numbers of a comma-separated option, all positive."""
    try:
        found = [float(word) for word in text.split(",")]
    except ValueError:
        found = []
    if not found or not all(0 < value < float("inf") for value in found):
        raise InputError(field, text, "positive numbers", "Separate several with commas.")
    return found


def inside(folder: Path | None, name: str) -> Path | None:
    """A file of a folder of results, where there is one."""
    return None if folder is None else folder / name


@contextmanager
def counting(label: str) -> Iterator[Counted]:
    """A bar on stderr where it is a terminal: told how many are done, how many there are, and what is done now."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda done, total, now: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, total, now: bar.update(task, completed=done, total=total, description=f"{label}: {now}")


def announce(text: str) -> None:
    """Say what takes long."""
    typer.echo(text, err=True)
