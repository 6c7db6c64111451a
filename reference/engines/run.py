"""One run: a scene in one formulation and one number type; and two runs side by side on two cores."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import FoucaultError, IntegrationError
from ..model.constants import Constants, Vector, constants, release, scaled
from ..model.mechanics import FORMULATIONS
from ..model.vanishing import xdot_vanishes, zero_at_release
from ..precision import GUARD_BITS, NumberType, context
from ..process import Emit, Worker
from ..scene import Inputs
from .heyoka.log import watched_log
from .plan import Plan, Report, Run
from .transits import march, quiet_start

if TYPE_CHECKING:
    from .heyoka import taylor

SPARE_BITS = 80  # fixed-point values carry this much below the run's epsilon, for amplitudes far below l
REPORT_S = 0.2  # how often the second process says how far it is
WORTH_A_PROCESS = 4.0  # estimated CPU seconds from which a second process pays for its start


def start_of(inputs: Inputs, number: NumberType) -> tuple[Any, Constants, Vector, Vector]:
    """A context finer than `number`, and in it the constants, n = r/l and v = r'/l at t = 0."""
    ctx = context(number.prec + GUARD_BITS)
    k = constants(inputs, ctx)
    position, velocity = release(inputs, ctx)
    n, v = (scaled(vector, k.length) for vector in (position, velocity))
    return ctx, k, n, v


def run(plan: Plan, report: Report | None = None, look_ahead: Callable[[taylor.Stepper], None] | None = None) -> Run:
    """Integrate a plan.

    Args:
        plan: what to run.
        report: called with the simulated time reached, in s.
        look_ahead: called before the first step; leaves the stepper as it was, or raises.

    Raises:
        IntegrationError: the integrator warned or stopped, or transits contradict each other.
    """
    if plan.number.name == "limbs":
        from . import limbs  # and numba as long

        return limbs.run(plan, report)
    from .heyoka import taylor  # heyoka takes 0.2 s to import and is not needed to check or show a scene

    ctx, k, n, v = start_of(plan.inputs, plan.number)
    model = FORMULATIONS[plan.formulation]
    watching = plan.transits and not xdot_vanishes(n, v, k)
    stepper = taylor.Stepper(model, k, n, v, ctx, plan.number, events=watching)
    times = [stepper.numbers.of(t) for t in plan.times]
    if look_ahead is not None:
        look_ahead(stepper)
    found: list[taylor.Zero] = []
    with watched_log() as watch:
        multiplicity = zero_at_release(n, v)
        quiet = quiet_start(stepper, multiplicity) if watching and multiplicity else None
        begun = time.process_time()
        if watching:
            states, found = march(stepper, times, watch, quiet, report)
        else:
            states = stepper.propagate(times, report)
            if watch.fresh():
                raise IntegrationError("heyoka wrote a warning to its log during a run without events.")
    return result(plan, stepper, states, found if watching else None, begun)


def result(plan: Plan, stepper: taylor.Stepper, states: Any, zeros: list[taylor.Zero] | None, begun: float) -> Run:
    """The states and zeros of a stepper that has reached the end, in SI units.

    Args:
        plan: what was to be run.
        stepper: after its last step.
        states: at the plan's times, shape (times, variables).
        zeros: of xdot; None if not looked for.
        begun: `time.process_time()` when the steps began.
    """
    from .heyoka import taylor

    scale, dtype = plan.number.prec + SPARE_BITS, stepper.numbers.dtype
    met = taylor.cartesian(stepper, np.array([zero.state for zero in zeros or ()], dtype=dtype), scale).rows
    moments = stepper.numbers.fixed(np.array([zero.t for zero in zeros or ()], dtype=dtype), scale)
    return Run(
        plan=plan,
        scale=scale,
        grid=taylor.cartesian(stepper, states, scale).rows,
        zeros=None if zeros is None else [(t, *row) for t, row in zip(moments, met, strict=True)],
        directions=[zero.direction for zero in zeros or ()],
        order=stepper.order,
        steps=stepper.steps,
        terms=stepper.terms,
        tension=taylor.least_tension(stepper, states),
        compile_s=stepper.compile_s,
        cpu_s=time.process_time() - begun,
    )


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
