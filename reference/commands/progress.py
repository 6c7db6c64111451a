"""Progress of long work, on stderr: bars on a terminal; elsewhere one line if it takes long."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any, Protocol

import typer

from ..plain_text import plain, terminal_of
from ..system.machine_code import announced_to

_NOTICE_S = 20.0  # work that takes no longer than this goes without a notice
_MEASURED_S = 5.0  # shortest time from which the rest is estimated
_ENOUGH = 0.02  # part of the work that is done before the rest is estimated
_LATEST_S = 60.0  # time after which it is estimated from less


class _Move(Protocol):
    """Moves a piece of work on."""

    def __call__(self, completed: float, total: float | None = None, item: str = "") -> None:
        """Report the part done, the whole if it was not known before, and what is done now."""


class Show(Protocol):
    """Begins a piece of work."""

    def __call__(self, label: str, total: float = 0, unit: str = "s simulated") -> _Move:
        """Return the function that moves the work on, which is counted in units up to a total."""


@contextmanager
def progress() -> Iterator[Show]:
    """Yield the function that begins a piece of work, shown on stderr from its first move on."""
    if not sys.stderr.isatty():
        with announced_to(partial(typer.echo, err=True)):
            yield notice
        return
    from rich.console import Console  # takes a tenth of a second
    from rich.progress import (
        BarColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(file=terminal_of(sys.stderr))
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.completed:,.0f} of {task.total:,.0f} {task.fields[unit]}"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with (
        Progress(*columns, console=console, transient=True) as bars,
        announced_to(partial(bars.console.print, markup=False, highlight=False)),
    ):
        yield partial(_bar, bars)


def _bar(bars: Any, label: str, total: float = 0, unit: str = "s simulated") -> _Move:
    """Return the function that moves a bar; it appears at its first move and goes when full."""
    task = bars.add_task(label, total=total, unit=unit, visible=False, start=False)

    def move(completed: float, total: float | None = None, item: str = "") -> None:
        bars.start_task(task)
        text = plain(f"{label}: {item}" if item else label)
        whole = bars.tasks[task].total if total is None else total
        bars.update(
            task, completed=completed, total=whole, description=text, visible=completed < whole
        )

    return move


def notice(label: str, total: float = 0, unit: str = "s simulated") -> _Move:
    """Return the function that moves a piece of work on.

    If the work takes long, it prints once how long it will take.

    Args:
        label: what is done.
        total: how much of it there is, in `unit`.
        unit: of completed and total.
    """
    begun_s = time.monotonic()
    known_total = total
    noticed = False
    last_completed = 0.0
    # time and part done at the first move, also of a second try
    first: tuple[float, float] | None = None

    def move(completed: float, total: float | None = None, item: str = "") -> None:
        nonlocal first, last_completed, noticed
        now_s = time.monotonic()
        if total is None:
            total = known_total
        if first is None or completed < last_completed:
            first = now_s, completed
        last_completed = completed
        since_s, done = first
        elapsed_s = now_s - begun_s
        measured_s = now_s - since_s
        if noticed or elapsed_s <= _NOTICE_S or measured_s < _MEASURED_S or completed <= done:
            return
        if completed - done < _ENOUGH * (total - done) and elapsed_s <= _LATEST_S:
            return

        noticed = True
        whole_s = elapsed_s + (total - completed) * measured_s / (completed - done)
        counted = f"{_rough(completed)} of {_rough(total)} {unit} after {elapsed_s:.0f} s"
        typer.echo(f"{label}: about {in_words(whole_s)}: {counted}", err=True)

    return move


def _rough(amount: float) -> str:
    """Return an amount in two digits, or as a whole number."""
    return f"{amount:,.0f}" if amount >= 10 else f"{amount:.2g}"


def in_words(seconds: float) -> str:
    """Return a rough time in the unit that suits it: 40 seconds, 11 minutes, 3.5 hours, 2 days."""
    scales = (
        ("seconds", 1, 90),
        ("minutes", 60, 5400),
        ("hours", 3600, 172800),
        ("days", 86400, math.inf),
    )
    unit, length_s = next((unit, length) for unit, length, until in scales if seconds < until)
    amount = float(f"{seconds / length_s:.2g}")
    return f"{amount:g} {unit}"
