"""Progress of long work on stderr: a bar on a terminal, otherwise an occasional line.

The remaining time follows from the rate of the last seconds, because work often starts slowly: code
is compiled, processes begin, a first part is measured. Runs of different methods take from
milliseconds to minutes each, so that those of the last seconds say little about the next ones:
there the rate of all counts.
"""

from __future__ import annotations

import math
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from operator import attrgetter
from typing import Any, NamedTuple, Protocol

import typer

from ..plain_text import plain, terminal_of
from ..system.channel import ACTIVITY, ANNOUNCEMENTS

_WINDOW_S = 5.0  # the rate is measured over the last seconds
_ALIKE = ("s", "rows", "days")  # units of which each takes about as long as the one before
_LEAST_S = 2.0  # shortest time over which a rate is measured
_NOTICE_S = 20.0  # work that takes no longer than this goes without a notice
_NEXT_NOTICE = 2.0  # each later notice comes after this factor of time


class Move(Protocol):
    """A callback that reports progress."""

    def __call__(self, completed: float, total: float | None = None, item: str = "") -> None:
        """Say how much is done, the total if it was unknown before, and what is being done."""


class Show(Protocol):
    """Begins a piece of work."""

    def __call__(self, label: str, total: float = 0, unit: str = "s", later: float = 0.0) -> Move:
        """Return the function that moves the work on; arguments as those of `Work`."""


class _Sample(NamedTuple):
    """How much was done at a time in s."""

    time_s: float
    completed: float


class Work:
    """A piece of work: how much of it is done, what is being done, and how long it will still take.

    Args:
        label: what the work is.
        total: how much of it there is, in `unit`.
        unit: unit of completed and total.
        later: how many units more take as long as what follows; `completed` may count them, beyond the total.
    """

    def __init__(self, label: str, total: float = 0, unit: str = "s", later: float = 0.0) -> None:
        self.label = label
        self.total = total
        self.unit = unit
        self.later = later
        self.activity = ""
        self.begun_s = time.monotonic()
        self._samples: deque[_Sample] = deque()

    def move(self, completed: float, total: float | None = None, item: str = "") -> None:
        """Note how much is done, the total if it was unknown before, and what is being done."""
        if total is not None:
            self.total = total
        if item:
            self.activity = item
        if completed < self.completed:  # it started again, in a higher precision
            self._samples.clear()
        self._samples.append(_Sample(time.monotonic(), completed))
        if self.unit in _ALIKE:
            self._forget_before(self._last.time_s - _WINDOW_S)

    def _forget_before(self, time_s: float) -> None:
        """Forget all samples before a time but the last of them."""
        while len(self._samples) > 2 and self._samples[1].time_s <= time_s:
            self._samples.popleft()

    def begin(self, activity: str) -> None:
        """Note the next activity; the time before its first progress does not count towards its rate."""
        if activity == self.activity:
            return
        self.activity = activity
        if self._samples and self.completed == self._samples[0].completed:
            completed = self.completed
            self._samples.clear()
            self._samples.append(_Sample(time.monotonic(), completed))

    @property
    def completed(self) -> float:
        """How much is done."""
        return self._last.completed if self._samples else 0.0

    @property
    def is_done(self) -> bool:
        """Whether the total is reached, or not known yet."""
        return self.completed >= self.total

    @property
    def elapsed_s(self) -> float:
        """The time since the work began."""
        return time.monotonic() - self.begun_s

    @property
    def counted(self) -> str:
        """How much is done: a percentage of the simulated time, or a number of a total."""
        if self.unit == "s":
            percent = 100 * min(self.completed / self.total, 1.0) if self.total else 0.0
            return f"{percent:.0f} % of the simulated {_rough(self.total)} s"
        done = min(self.completed, self.total)
        return f"{_rough(done)} of {_rough(self.total)} {self.unit}"

    @property
    def description(self) -> str:
        """The label, and what is being done."""
        return plain(f"{self.label}: {self.activity}" if self.activity else self.label)

    @property
    def _last(self) -> _Sample:
        return self._samples[-1]

    def remaining_s(self) -> float | None:
        """Return the expected remaining time in s; None until a rate can be measured."""
        if len(self._samples) < 2:
            return None
        first = self._samples[0]
        done = self._last.completed - first.completed
        measured_s = self._last.time_s - first.time_s
        waited_s = time.monotonic() - self._last.time_s
        if done <= 0 or measured_s + waited_s < _LEAST_S:
            return None
        units_left = self.total + self.later - self._last.completed
        if waited_s > measured_s:  # it has become slower
            return units_left * (measured_s + waited_s) / done
        return max(0.0, units_left * measured_s / done - waited_s)

    def remaining(self) -> str:
        """Return the expected remaining time in words; empty until a rate can be measured."""
        seconds = self.remaining_s()
        return "" if seconds is None else f"about {duration_in_words(seconds)} left"


@contextmanager
def progress() -> Iterator[Show]:
    """Yield the function that begins a piece of work, which is shown on stderr."""
    if not sys.stderr.isatty():
        with _as_lines() as show:
            yield show
        return
    with _as_bars() as show:
        yield show


@contextmanager
def _as_lines() -> Iterator[Show]:
    """Show long work by lines: the first after twenty seconds, the next after forty, and so on."""
    current: list[Work] = []

    def show(label: str, total: float = 0, unit: str = "s", later: float = 0.0) -> Move:
        work = Work(label, total, unit, later)
        current[:] = [work]
        return partial(_noticed, work, _Notices())

    def hear(text: str) -> None:
        for work in current:
            work.begin(text)

    with ANNOUNCEMENTS.heard_by(partial(typer.echo, err=True)), ACTIVITY.heard_by(hear):
        yield show


class _Notices:
    """When the next line is due, in s since the work began."""

    def __init__(self) -> None:
        self.next_s = _NOTICE_S

    def is_due(self, elapsed_s: float) -> bool:
        """Return whether a line is due; if so, the next one comes later."""
        if elapsed_s <= self.next_s:
            return False
        self.next_s = _NEXT_NOTICE * elapsed_s
        return True


def _noticed(
    work: Work,
    notices: _Notices,
    completed: float,
    total: float | None = None,
    item: str = "",
) -> None:
    """Move a piece of work on, and print a line if one is due."""
    work.move(completed, total, item)
    remaining = work.remaining()
    if not remaining or work.is_done or not notices.is_due(work.elapsed_s):
        return
    line = f"{work.description}: {remaining}, {work.counted} after {work.elapsed_s:.0f} s"
    typer.echo(line, err=True)


@contextmanager
def _as_bars() -> Iterator[Show]:
    """Show work by bars, which are drawn ten times a second and go when the work is done."""
    from rich.console import Console  # takes a tenth of a second
    from rich.progress import (
        BarColumn,
        Progress,
        ProgressColumn,
        SpinnerColumn,
        TimeElapsedColumn,
    )
    from rich.text import Text

    class WorkColumn(ProgressColumn):
        """A text that a piece of work gives about itself."""

        def __init__(self, text_of: Callable[[Work], str]) -> None:
            super().__init__()
            self._text_of = text_of

        def render(self, task: Any) -> Text:
            return Text(self._text_of(task.fields["work"]))

    console = Console(file=terminal_of(sys.stderr))
    bars = Progress(
        SpinnerColumn(),
        WorkColumn(attrgetter("description")),
        BarColumn(),
        WorkColumn(attrgetter("counted")),
        TimeElapsedColumn(),
        WorkColumn(Work.remaining),
        console=console,
        transient=True,
    )

    def show(label: str, total: float = 0, unit: str = "s", later: float = 0.0) -> Move:
        work = Work(label, total, unit, later)
        task = bars.add_task("", total=total, work=work)
        choose_bars()

        def move(completed: float, total: float | None = None, item: str = "") -> None:
            work.move(completed, total, item)
            bars.update(task, completed=completed, total=work.total)
            choose_bars()

        return move

    def choose_bars() -> None:
        """Show the work that is not done; if all of it is, the last bar stays, as a sign of life."""
        undone = [task for task in bars.tasks if not task.fields["work"].is_done]
        shown = undone or bars.tasks[-1:]
        for task in bars.tasks:
            bars.update(task.id, visible=task in shown)

    def hear(text: str) -> None:
        for task in bars.tasks:
            if task.visible:
                task.fields["work"].begin(text)

    announce = partial(console.print, markup=False, highlight=False)
    with bars, ANNOUNCEMENTS.heard_by(announce), ACTIVITY.heard_by(hear):
        yield show


def _rough(amount: float) -> str:
    return f"{amount:,.0f}" if amount >= 10 else f"{amount:.2g}"


def duration_in_words(seconds: float) -> str:
    """Return a rough duration in a suitable unit: 40 seconds, 11 minutes, 3.5 hours, 2 days."""
    scales = (
        ("seconds", 1, 90),
        ("minutes", 60, 5400),
        ("hours", 3600, 172800),
        ("days", 86400, math.inf),
    )
    unit, length = next((unit, length) for unit, length, until in scales if seconds < until)
    two_digits = float(f"{seconds / length:.2g}")
    return f"{two_digits:g} {unit}"
