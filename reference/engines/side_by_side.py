"""Two runs at the same time, in two processes where the machine has two cores and the work is worth it."""

from __future__ import annotations

import os
import threading
import time
from typing import Any

from ..errors import FoucaultError
from ..process import Emit, Worker
from .plan import Plan, Report, Run
from .run import run

REPORT_S = 0.2  # how often the second process says how far it is
WORTH_A_PROCESS = 4.0  # estimated CPU seconds from which a second process pays for its start


def run_both(first: Plan, second: Plan, expected_s: float, report: Report | None = None) -> tuple[Run, Run]:
    """Two runs, at the same time in two processes if the machine has two cores and the work is worth it.

    Args:
        first: runs in this process.
        second: runs in a child if that pays.
        expected_s: estimated CPU seconds of the longer one.
        report: called with the simulated time, the mean of both.
    """
    if (os.cpu_count() or 1) < 2 or expected_s < WORTH_A_PROCESS:
        one = run(first, report and (lambda t: report(t / 2)))
        end = float(first.times[-1])
        return one, run(second, report and (lambda t: report((end + t) / 2)))
    worker = Worker(_second, second)
    came: list[Any] = [0.0]
    try:
        reader = threading.Thread(target=_collect, args=(worker, came), daemon=True)
        reader.start()
        one = run(first, report and (lambda t: report((t + _reached(came)) / 2)))
        while reader.is_alive():
            reader.join(0.2)
            if report is not None:
                report((float(first.times[-1]) + _reached(came)) / 2)
    finally:
        worker.stop()
    if not isinstance(came[-1], Run):
        raise came[-1]
    return one, came[-1]


def _collect(worker: Worker, came: list[Any]) -> None:
    try:
        for item in worker:
            came.append(item)
    except (FoucaultError, OSError, ValueError) as error:  # the last two: the pipe was closed by an interrupt
        came.append(error)


def _reached(came: list[Any]) -> float:
    return next((item for item in reversed(came) if isinstance(item, float)), 0.0)


def _second(emit: Emit, plan: Plan) -> None:
    shown = time.monotonic()

    def report(t: float) -> None:
        nonlocal shown
        if time.monotonic() - shown > REPORT_S:
            shown = time.monotonic()
            emit(t)

    emit(run(plan, report))
