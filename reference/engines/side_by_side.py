"""Two runs at the same time, one in a child process if the machine has two cores and the work is worth it."""

from __future__ import annotations

import os
import threading
import time
from typing import Any

from ..errors import FoucaultError
from ..process import Emit, Worker
from .plan import Plan, Report, Run
from .registry import engines, run

REPORT_S = 0.2  # seconds between two reports of progress from the child
WORTH_A_PROCESS = 4.0  # estimated CPU seconds from which a child pays for its start
COMPILATION_S = 10.0  # or for the wait while the other run compiles on its first use


def run_both(first: Plan, second: Plan, steps: int, report: Report | None = None) -> tuple[Run, Run]:
    """Do two runs, at the same time if the machine has two cores and the work is worth a child process.

    Args:
        first: runs in this process.
        second: runs in a child if that pays.
        steps: about how many steps either takes.
        report: called with the simulated time, the mean of both.
    """
    first_s, second_s = (engines()[plan.engine].expected_s(steps, plan.number.prec) for plan in (first, second))
    worth = min(first_s, second_s) >= WORTH_A_PROCESS or second_s >= COMPILATION_S
    if (os.cpu_count() or 1) < 2 or not worth:
        first_run = run(first, report and (lambda t: report(t / 2)))
        end = float(first.times[-1])
        return first_run, run(second, report and (lambda t: report((end + t) / 2)))
    worker = Worker(_run_in_child, second)
    messages: list[Any] = [0.0]
    try:
        reader = threading.Thread(target=_collect, args=(worker, messages), daemon=True)
        reader.start()
        first_run = run(first, report and (lambda t: report((t + _time_reached(messages)) / 2)))
        while reader.is_alive():
            reader.join(0.2)
            if report is not None:
                report((float(first.times[-1]) + _time_reached(messages)) / 2)
    finally:
        worker.stop()
    if not isinstance(messages[-1], Run):
        raise messages[-1]
    return first_run, messages[-1]


def _collect(worker: Worker, messages: list[Any]) -> None:
    """Append the child's messages as they arrive: times reached, and at last its run or its error."""
    try:
        for item in worker:
            messages.append(item)
    except (FoucaultError, OSError, ValueError) as error:  # the last two: the pipe was closed by an interrupt
        messages.append(error)


def _time_reached(messages: list[Any]) -> float:
    return next((item for item in reversed(messages) if isinstance(item, float)), 0.0)


def _run_in_child(emit: Emit, plan: Plan) -> None:
    last_report = time.monotonic()

    def report(t: float) -> None:
        nonlocal last_report
        if time.monotonic() - last_report > REPORT_S:
            last_report = time.monotonic()
            emit(t)

    emit(run(plan, report))
