"""One run: a scene integrated in one formulation and one number type, with its transits if wanted."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import IntegrationError
from ..model.formulations import FORMULATIONS
from ..model.start import Start
from ..model.vanishing import xdot_vanishes, zero_at_release
from ..precision import GUARD_BITS
from .heyoka.log import watched_log
from .plan import Plan, Report, Run
from .transits import march, quiet_start

if TYPE_CHECKING:
    from .heyoka import stepper as heyoka

SMALL_SWING_BITS = 80  # results carry this many bits below the run's epsilon, for swings much smaller than the cord


def run(plan: Plan, report: Report | None = None, look_ahead: Callable[[heyoka.Stepper], None] | None = None) -> Run:
    """Integrate a plan.

    Args:
        plan: the run to do.
        report: called with the simulated time reached, in s.
        look_ahead: called before the first step, to refuse a run that would take too long; it leaves the stepper as it
            was, or raises. It is not called for limbs.

    Raises:
        IntegrationError: the integrator warned or stopped, or transits contradict each other.
    """
    if plan.number.name == "limbs":
        from . import limbs  # imports numba

        return limbs.run(plan, report)
    from .heyoka import stepper as heyoka  # takes 0.2 s to import, and is not needed to check or show a scene

    start = Start.of(plan.inputs, plan.number.prec + GUARD_BITS)
    watching = plan.transits and not xdot_vanishes(start)
    stepper = heyoka.Stepper(FORMULATIONS[plan.formulation], start, plan.number, events=watching)
    times = [stepper.numbers.of(t) for t in plan.times]
    if look_ahead is not None:
        look_ahead(stepper)
    zeros: list[heyoka.Zero] = []
    with watched_log() as watch:
        multiplicity = zero_at_release(start)
        quiet = quiet_start(stepper, multiplicity) if watching and multiplicity else None
        started = time.process_time()
        if watching:
            states, zeros = march(stepper, times, watch, quiet, report)
        else:
            states = stepper.propagate(times, report)
            if watch.fresh():
                raise IntegrationError("heyoka wrote a warning to its log during a run without events.")
    return result(plan, stepper, states, zeros if watching else None, started)


def result(plan: Plan, stepper: heyoka.Stepper, states: Any, zeros: list[heyoka.Zero] | None, started: float) -> Run:
    """Return the states and zeros of a stepper that has reached the end, in SI units.

    Args:
        plan: the plan that was run.
        stepper: after its last step.
        states: at the plan's times, shape (times, variables).
        zeros: of xdot; None if not looked for.
        started: `time.process_time()` when the steps began.
    """
    from .heyoka import stepper as heyoka

    bits, dtype = plan.number.prec + SMALL_SWING_BITS, stepper.numbers.dtype
    rows = heyoka.cartesian(stepper, np.array([zero.state for zero in zeros or ()], dtype=dtype), bits).rows
    times = stepper.numbers.fixed(np.array([zero.t for zero in zeros or ()], dtype=dtype), bits)
    return Run(
        plan=plan,
        bits=bits,
        grid=heyoka.cartesian(stepper, states, bits).rows,
        zeros=None if zeros is None else [(t, *row) for t, row in zip(times, rows, strict=True)],
        directions=[zero.direction for zero in zeros or ()],
        order=stepper.order,
        steps=stepper.steps,
        terms=stepper.terms,
        tension=heyoka.least_tension(stepper, states),
        compile_s=stepper.compile_s,
        cpu_s=time.process_time() - started,
    )
