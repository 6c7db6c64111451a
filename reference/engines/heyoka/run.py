"""One run of heyoka: a scene integrated in one formulation and one number type, with its transits if wanted."""

from __future__ import annotations

import time
from fractions import Fraction
from typing import Any

import numpy as np

from ...model.carried import carried
from ...model.formulations import FORMULATIONS
from ...model.start import Start
from ...model.vanishing import xdot_vanishes, zero_at_release
from ...numbers.precision import GUARD_BITS
from ...numbers.table import Table
from ..plan import Pace, Plan, Report, Run
from .events import march, quiet_start
from .numbers import Numbers
from .stepper import Stepper, Zero

OTHER_STEPS = Fraction(5, 8)  # of the span: the longest step of a run that takes other steps, if one would do
SMALL_SWING_BITS = 80  # results carry this many bits below the run's epsilon, for swings much smaller than the cord


def run(plan: Plan, report: Report | None = None, pace: Pace | None = None) -> Run:
    """Integrate a plan; see `Engine.run`.

    Raises:
        IntegrationError: the integrator stopped, or transits contradict each other.
    """
    start = Start.of(plan.inputs, plan.number.prec + GUARD_BITS)
    watching = plan.transits and not xdot_vanishes(start)
    longest = plan.times[-1] * OTHER_STEPS if plan.other_steps else None
    formulation = carried(FORMULATIONS[plan.formulation], start, Numbers(plan.number).of)
    stepper = Stepper(formulation, start, plan.number, events=watching, span=plan.times[-1], longest=longest)
    times = [stepper.numbers.of(t) for t in plan.times]
    zeros: list[Zero] = []
    multiplicity = zero_at_release(start)
    quiet = quiet_start(stepper, multiplicity) if watching and multiplicity else None
    started = time.process_time()
    if watching:
        states, zeros = march(stepper, times, quiet, report)
    else:
        states = stepper.propagate(times, report, pace)
    return result(plan, stepper, states, zeros if watching else None, started)


def result(plan: Plan, stepper: Stepper, states: Any, zeros: list[Zero] | None, started: float) -> Run:
    """Return the states and zeros of a stepper that has reached the end, in SI units.

    Args:
        plan: the plan that was run.
        stepper: after its last step.
        states: at the plan's times, shape (times, variables).
        zeros: of xdot; None if not looked for.
        started: `time.process_time()` when the steps began.
    """
    bits = plan.number.prec + SMALL_SWING_BITS
    return Run(
        plan=plan,
        grid=stepper.model.table(states, bits),
        transits=None if zeros is None else _transits(stepper, zeros, bits),
        directions=[zero.direction for zero in zeros or ()],
        order=stepper.order,
        steps=stepper.steps,
        terms=stepper.terms,
        compile_s=stepper.compile_s,
        cpu_s=time.process_time() - started,
    )


def _transits(stepper: Stepper, zeros: list[Zero], bits: int) -> Table:
    dtype = stepper.numbers.dtype
    states = stepper.model.table(np.array([zero.state for zero in zeros], dtype=dtype), bits)
    times = stepper.numbers.fixed(np.array([zero.t for zero in zeros], dtype=dtype), bits)
    return Table(("t", *states.columns), bits, [(t, *row) for t, row in zip(times, states.values, strict=True)])
