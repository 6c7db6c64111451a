"""Two runs at the same time, one in a child process if the machine has two cores and the work is worth it."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ..errors import FoucaultError
from ..process import Emit, Worker, usable_cores
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
    with beside(second, worth) as other:
        first_run = run(first, report and (lambda t: report((t + other.reached) / 2)))
        return first_run, other.result(report and (lambda t: report((end + t) / 2)))


def expected_s(plan: Plan, steps: int) -> float:
    """Return about how many CPU seconds a run takes that would be `steps` steps in double."""
    return engines()[plan.engine].expected_s(steps, plan.number.prec)


@contextmanager
def beside(plan: Plan, worth: bool = True) -> Iterator[Beside]:
    """Do a run meanwhile in a child process, where that is worth it and the machine has two cores; else afterwards."""
    worker = Worker(_run_in_child, plan) if worth and usable_cores() >= 2 else None
    try:
        yield Beside(plan, worker)
    finally:
        if worker is not None:
            worker.stop()


class Beside:
    """A run that is done in a child process, or by this one once its result is wanted."""

    def __init__(self, plan: Plan, worker: Worker | None) -> None:
        self._plan, self._messages, self._reader = plan, list[Any](), None
        if worker is not None:
            self._reader = threading.Thread(target=_collect, args=(worker, self._messages), daemon=True)
            self._reader.start()

    @property
    def reached(self) -> float:
        """Simulated time in s that the child has reached."""
        return next((item for item in reversed(self._messages) if isinstance(item, float)), 0.0)

    def result(self, report: Report | None = None) -> Run:
        """Wait for the run and return it; `report` is called with the simulated time meanwhile.

        Raises:
            FoucaultError: the run failed, as it would have done here.
        """
        if self._reader is None:
            return run(self._plan, report)
        while self._reader.is_alive():
            self._reader.join(0.2)
            if report is not None:
                report(self.reached)
        if not isinstance(self._messages[-1], Run):
            raise self._messages[-1]
        found: Run = self._messages[-1]
        return found


def _collect(worker: Worker, messages: list[Any]) -> None:
    """Append the child's messages as they arrive: times reached, and at last its run or its error."""
    try:
        for item in worker:
            messages.append(item)
    except (FoucaultError, OSError, ValueError) as error:  # the last two: the pipe was closed by an interrupt
        messages.append(error)


def _run_in_child(emit: Emit, plan: Plan) -> None:
    last_report = time.monotonic()

    def report(t: float) -> None:
        nonlocal last_report
        if time.monotonic() - last_report > REPORT_S:
            last_report = time.monotonic()
            emit(t)

    emit(run(plan, report))
