"""The engines by name, the choice of one for a run, and runs, here or in the background."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, wait
from contextlib import contextmanager
from dataclasses import replace
from functools import cache, partial
from importlib import import_module
from time import process_time
from typing import Any

from ..errors import FoucaultError, InputError
from ..numbers.taylor_step import TaylorStep
from ..system.channel import ACTIVITY
from ..system.workers import Emit, Worker, usable_cores
from . import AUTO, batch_names, engine_names
from .batch_interface import Batch
from .plan import Engine, Pace, Plan, Report, Run

_SERIES_BITS = 20  # beyond a run's precision, to which the series of its steps are taken
MANY_STEPS = 10**6  # of a run in which starting an engine costs nothing beside its steps
_SECOND_PASS = 6  # what the pass for sections takes, over the run itself
_REPORT_S = 0.2  # seconds between two reports of progress
WORTH_A_PROCESS = 1.0  # estimated CPU seconds from which a process pays for its start
_COMPILATION_S = 10.0  # or for the wait while the other run compiles on its first use


@cache
def engines() -> dict[str, Engine]:
    """Return every engine by its name, which is that of its folder."""
    return {name: import_module(f".{name}.engine", __package__).ENGINE for name in engine_names()}


@cache
def batches() -> dict[str, Batch]:
    """Return every engine that solves many rows, by its name, which is that of its folder."""
    return {name: import_module(f".{name}.batch", __package__).BATCH for name in batch_names()}


def checked(name: str | None) -> str:
    """Return the name of an installed engine, or "auto", also for None.

    Raises:
        InputError: no such engine, or it is not installed.
    """
    if name is None or name == AUTO:
        return AUTO
    if name not in engine_names():
        raise InputError("engine", name, f"one of {', '.join((AUTO, *engine_names()))}")
    engines()[name].check_installed()
    return name


def fastest(prec: int, name: str = AUTO, steps: int = MANY_STEPS, *, proof: bool = False) -> Engine:
    """Return the engine to compute with at `prec` bits, in a run of `steps` steps in double.

    The engine called `name` is taken if it is installed and can compute at this precision.
    Otherwise, or if `name` is "auto", it is the one with the least expected cost among the
    installed engines that can. With `proof` the cost of a proof of the run is added.

    Raises:
        InputError: none that can compute at this precision is installed.
    """

    def preference(engine: Engine) -> tuple[bool, float]:
        cost_s = engine.start_s + engine.expected_s(steps, prec)
        if proof:
            cost_s += steps * engine.proof_step_s
        return name not in (engine.name, AUTO), cost_s

    serving = [engine for engine in engines().values() if engine.installed and prec in engine.bits]
    if not serving:
        engines()["heyoka"].check_installed()  # it would serve any precision
    return min(serving, key=preference)


def run(plan: Plan, report: Report | None = None, pace: Pace | None = None) -> Run:
    """Integrate a plan with its engine; sections take a second pass.

    For arguments and errors see `Engine.run`.
    """
    engine = engines()[plan.engine]
    if not plan.sections:
        return engine.run(plan, report, pace)
    from .passages import passages

    end = float(plan.times[-1])
    first_report = report and (lambda t: report(t / (1 + _SECOND_PASS)))
    done = engine.run(plan, first_report, pace)
    begun = process_time()
    steps: Iterator[TaylorStep] = engine.expanded(plan, plan.number.prec + _SERIES_BITS)
    if report is not None:
        steps = _reported(steps, lambda t: report((end + _SECOND_PASS * t) / (1 + _SECOND_PASS)))
    zeros = {**done.zeros, **passages(plan, steps)}
    return replace(done, zeros=zeros, cpu_s=done.cpu_s + process_time() - begun)


def _reported(steps: Iterator[TaylorStep], report: Report) -> Iterator[TaylorStep]:
    """Yield steps, and report the simulated time at which each begins."""
    for step in steps:
        report(float(step.centre + step.h * step.low))
        yield step


def run_both(
    first: Plan, second: Plan, steps: int, report: Report | None = None
) -> tuple[Run, Run]:
    """Do two runs, in parallel if the machine has two cores and a second process saves time.

    Args:
        first: runs in this process.
        second: runs in the background if that pays.
        steps: about how many steps either takes.
        report: called with the simulated time, as far as the work of both is done.
    """
    first_s = expected_s(first, steps)
    second_s = expected_s(second, steps)
    pays = min(first_s, second_s) >= WORTH_A_PROCESS or second_s >= _COMPILATION_S
    end = float(first.times[-1])
    ACTIVITY.send("integrating")
    with in_background(pays, send_run, second) as background:
        if report is None:
            return run(first), background.result()

        # the slower of two runs at the same time counts, or both, one after the other
        combined = max if background.at_work else sum
        all_s = combined((first_s, second_s))

        def tell(first_t: float, second_t: float) -> None:
            first_left_s = first_s * (1 - first_t / end)
            second_left_s = second_s * (1 - second_t / end)
            report(end * (1 - combined((first_left_s, second_left_s)) / all_s))

        first_run = run(first, lambda t: tell(t, background.reached))
        return first_run, background.result(lambda t: tell(end, t))


def expected_s(plan: Plan, steps: int) -> float:
    """Return about how many CPU seconds a run takes that would be `steps` steps in double."""
    passes = 1 + _SECOND_PASS if plan.sections else 1
    return passes * engines()[plan.engine].expected_s(steps, plan.number.prec)


def send_run(emit: Emit, plan: Plan) -> None:
    """Do a run and send it; to be done in the background."""
    emit(run(plan, reports(emit)))


def reports(emit: Emit) -> Report:
    """Return a callback that sends the simulated time, at most every so often."""
    last_report = time.monotonic()

    def report(t: float) -> None:
        nonlocal last_report
        if time.monotonic() - last_report > _REPORT_S:
            last_report = time.monotonic()
            emit(float(t))

    return report


@contextmanager
def in_background(pays: bool, work: Callable[..., None], *arguments: Any) -> Iterator[Background]:
    """Do work in the background if that saves time and there are two cores, otherwise when its result is needed.

    `work(emit, *arguments)` is defined at the top level of a module; it sends simulated times, as
    `reports` does, and then its result.
    """
    worker = Worker(work, *arguments) if pays and usable_cores() >= 2 else None
    try:
        yield Background(worker, work, *arguments)
    finally:
        if worker is not None:
            worker.stop()


class Background:
    """Work done in another process, or in this one when its result is needed.

    Attributes:
        reached: simulated time in s that it has reached.
    """

    def __init__(self, worker: Worker | None, work: Callable[..., None], *arguments: Any) -> None:
        self.reached = 0.0
        self._report: Report | None = None
        self._result: Future[Any] = Future()
        self._here = None if worker is not None else partial(work, self._take, *arguments)
        if worker is not None:
            threading.Thread(target=self._take_all, args=(worker,), daemon=True).start()

    @property
    def at_work(self) -> bool:
        """Whether another process is at work."""
        return self._here is None and not self._result.done()

    @property
    def finished(self) -> bool:
        """Whether the result, or an error, is available."""
        return self._result.done()

    def result(self, report: Report | None = None) -> Any:
        """Wait for the result and return it; `report` is called with the simulated time meanwhile.

        Raises:
            FoucaultError: the work failed, as it would have done here.
        """
        if self._here is not None:
            self._report = report
            self._here()
        while not wait([self._result], _REPORT_S).done:
            if report is not None:
                report(self.reached)
        return self._result.result()

    def _take(self, item: Any) -> None:
        if not isinstance(item, float):
            self._result.set_result(item)
            return
        self.reached = item
        if self._report is not None:
            self._report(item)

    def _take_all(self, worker: Worker) -> None:
        try:
            while not self._result.done():
                self._take(worker.receive())
        except FoucaultError as error:
            self._result.set_exception(error)
