"""What runs beside a proof, made to end after it: the work is done, and then told of bit by bit."""

from __future__ import annotations

import time
from typing import Any

from reference.engines.registry import REPORT_S, send_run
from reference.solver.enclosed import _send_digits


def digits(emit: Any, problem: Any) -> None:
    _told_slowly(emit, _send_digits, problem, float(problem.scene.exact.t_end))


def confirming_run(emit: Any, plan: Any) -> None:
    _told_slowly(emit, send_run, plan, float(plan.times[-1]))


def _told_slowly(emit: Any, work: Any, argument: Any, end: float) -> None:
    sent: list[Any] = []
    work(sent.append, argument)
    for tenth in range(1, 10):
        emit(end * tenth / 10)
        time.sleep(2 * REPORT_S)
    emit(sent[-1])
