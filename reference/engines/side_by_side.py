"""Work at the same time as other work, in a child process if the machine has two cores and it is worth it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ..errors import FoucaultError
from ..system.process import Emit, Worker, usable_cores
from .plan import Plan, Report, Run
from .registry import engines, run

REPORT_S = 0.2  # seconds between two reports of progress from the child
WORTH_A_PROCESS = 1.0  # estimated CPU seconds from which a child pays for its start
COMPILATION_S = 10.0  # or for the wait while the other run compiles on its first use


def run_both(first: Plan, second: Plan, steps: int, report: Report | None = None) -> tuple[Run, Run]:
    """Do two runs, at the same time if the machine has two cores and the work is worth a child process.

    Args:
        first: runs in this process.
        second: runs in a child if that pays.
        steps: about how many steps either takes.
        report: called with the simulated time, the mean of both.
    """
    first_s, second_s = (expected_s(plan, steps) for plan in (first, second))
    worth = min(first_s, second_s) >= WORTH_A_PROCESS or second_s >= COMPILATION_S
    end = float(first.times[-1])
    with beside(worth, send_run, second) as other:
        first_run = run(first, report and (lambda t: report((t + other.reached) / 2)))
        return first_run, other.result(report and (lambda t: report((end + t) / 2)))


def expected_s(plan: Plan, steps: int) -> float:
    """Return about how many CPU seconds a run takes that would be `steps` steps in double."""
    return engines()[plan.engine].expected_s(steps, plan.number.prec)


@contextmanager
def beside(worth: bool, work: Callable[..., None], *arguments: Any) -> Iterator[Beside]:
    """Do work meanwhile in a child process, where that is worth it and the machine has two cores; else afterwards.

    `work(emit, *arguments)` stands at the top level of a module; it sends simulated times, as `reports` does, and then
    its result.
    """
    worker = Worker(work, *arguments) if worth and usable_cores() >= 2 else None
    try:
        yield Beside(worker, work, *arguments)
    finally:
        if worker is not None:
            worker.stop()


class Beside:
    """Work that is done in a child process, or by this one once its result is wanted."""

    def __init__(self, worker: Worker | None, work: Callable[..., None], *arguments: Any) -> None:
        self._work, self._arguments, self._messages, self._reader = work, arguments, list[Any](), None
        if worker is not None:
            self._reader = threading.Thread(target=_collect, args=(worker, self._messages), daemon=True)
            self._reader.start()

    @property
    def at_work(self) -> bool:
        """Whether the child is at work."""
        return self._reader is not None and self._reader.is_alive()

    @property
    def reached(self) -> float:
        """Simulated time in s that the child has reached."""
        return next((item for item in reversed(self._messages) if isinstance(item, float)), 0.0)

    def result(self, report: Report | None = None) -> Any:
        """Wait for the result and return it; `report` is called with the simulated time meanwhile.

        Raises:
            FoucaultError: the work failed, as it would have done here.
        """
        if self._reader is None:
            return self._done_here(report)
        while self._reader.is_alive():
            self._reader.join(REPORT_S)
            if report is not None:
                report(self.reached)
        if isinstance(self._messages[-1], Exception):
            raise self._messages[-1]
        return self._messages[-1]

    def _done_here(self, report: Report | None) -> Any:
        sent: list[Any] = []

        def take(item: Any) -> None:
            if not isinstance(item, float):
                sent.append(item)
            elif report is not None:
                report(item)

        self._work(take, *self._arguments)
        return sent[-1]


def slowest(report: Report, others: list[Beside]) -> Report:
    """Return a report that tells the time which all work has reached: the caller's, and others' that is going on."""
    return lambda t: report(min([t, *(other.reached for other in others if other.at_work)]))


def _collect(worker: Worker, messages: list[Any]) -> None:
    """Append the child's messages as they arrive: times reached, and at last its result or its error."""
    try:
        for item in worker:
            messages.append(item)
    except (FoucaultError, OSError, ValueError) as error:  # the last two: the pipe was closed by an interrupt
        messages.append(error)


def send_run(emit: Emit, plan: Plan) -> None:
    """Do a run and send it; to be done beside other work."""
    emit(run(plan, reports(emit)))


def reports(emit: Emit) -> Report:
    """Return a report that sends the simulated time, not too often."""
    last_report = time.monotonic()

    def report(t: float) -> None:
        nonlocal last_report
        if time.monotonic() - last_report > REPORT_S:
            last_report = time.monotonic()
            emit(float(t))

    return report
