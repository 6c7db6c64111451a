"""One run of heyoka: a scene in one formulation and one number type, optionally with its transits.

For a proof: the Taylor steps of a run in `momentum`, their lengths and coefficients as integers.
"""

from __future__ import annotations

import math
import time
from collections.abc import Generator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ...model.carried import carried
from ...model.force import acceleration
from ...model.formulations import FORMULATIONS
from ...model.start import Start, xdot_vanishes, zero_at_release
from ...numbers.columns import STATE
from ...numbers.precision import GUARD_BITS, to_mpf
from ...numbers.table import Table
from ...numbers.taylor_step import LOCAL, TaylorStep
from ...numbers.zeros import XDOT, Zeros
from ..plan import MOST_TURN, Pace, Plan, Report, Run
from .conversions import Numbers
from .events import march
from .stepper import Stepper, Zero

_SHRINK = 0.995  # of the step size that heyoka would take, before it is cut to few bits
_DECAYS = 5.0  # with a fast drag γ the step size is at most _DECAYS MOST_TURN/γ
# mantissa of a step size: equal steps share their scaled constants, and times stay short
_STEP_BITS = 6
# of the span: the longest step of a run that takes other steps, if one would do
_OTHER_STEPS = Fraction(5, 8)
_UNSEEN_BITS = 8  # vx of less than this many bits above a run's epsilon has no sure sign in it
# results carry this many bits below the run's epsilon, for swings much smaller than the cord
_SMALL_SWING_BITS = 80


def taylor_steps(plan: Plan, coefficient_bits: int) -> Generator[TaylorStep, None, Run]:
    """Yield the Taylor steps of a run from t = 0 to one step beyond the last time; return the run.

    Their rows are n east, north and up, which the formulation has to begin with.
    """
    start = Start.of(plan.inputs, plan.number.prec + GUARD_BITS)
    stepper = Stepper(FORMULATIONS[plan.formulation], start, plan.number, span=plan.times[-1])
    numbers = stepper.numbers
    times = [numbers.of(t) for t in plan.times]
    states = [stepper.state]
    longest = _longest_step(plan, start)
    limit = numbers.of(longest)
    cpu_s = 0.0
    beyond = False
    while not beyond:
        beyond = stepper.time > times[-1]
        begun = time.process_time()
        t, h, series = stepper.expand(limit, coefficient_bits)
        cpu_s += time.process_time() - begun
        yield TaylorStep(
            centre=t,
            h=h,
            low=Fraction(0),
            high=Fraction(1),
            bits=coefficient_bits,
            rows=partial(_integers, series[:3]),
            columns=LOCAL,
        )
        stepper.sample(times, states)
        limit = numbers.of(min(_next_step(h, series, coefficient_bits), longest))
    reached = np.array(states, dtype=numbers.dtype)
    return result(plan, stepper, reached, None, time.process_time() - cpu_s)


def _longest_step(plan: Plan, start: Start) -> Fraction:
    """Return the longest step in s that the series of a proof may have."""
    swing_rate = float(start.ctx.sqrt(start.ctx.norm(start.k.pull)))
    rate = max(swing_rate, float(start.k.drag) / _DECAYS)
    turn = MOST_TURN * float(_OTHER_STEPS) if plan.other_steps else MOST_TURN
    return _few_bits(turn / rate) if rate > 0 else max(plan.times[-1], Fraction(1))


def _integers(series: Any) -> tuple[list[int], ...]:
    """Return the coefficients as integers, which costs a sixth of a step."""
    return tuple(list(map(int, row)) for row in series)


def _next_step(h: Fraction, series: Any, bits: int) -> Fraction:
    """Return about the step size that heyoka's rule would give next, with few bits.

    heyoka's own choice limits a step too.

    The rule: h = ρ exp(-2 - 0.7/(p - 1)), ρ the smaller of |c_k|^(-1/k) of the last two orders.
    """
    order = series.shape[1] - 1
    log2_radii = []
    for k in (order - 1, order):
        largest = max(abs(int(c)).bit_length() for c in series[:, k])
        log2_radii.append(-(largest - bits) / k)
    power = min(log2_radii) - (2 + 0.7 / (order - 1)) * math.log2(math.e)
    return _few_bits(float(h) * 2**power * _SHRINK)


def _few_bits(h: float) -> Fraction:
    """Return a little less than h, with a mantissa of `_STEP_BITS` bits."""
    mantissa, exponent = math.frexp(h)
    return Fraction(int(mantissa * 2**_STEP_BITS)) * Fraction(2) ** (exponent - _STEP_BITS)


class _EarlyZero(NamedTuple):
    """A zero of xdot too near t = 0 for a run to see.

    Attributes:
        time_s: before the release if negative.
        direction: +1 where xdot grows, else -1.
    """

    time_s: Any
    direction: int


def _early_zero(start: Start, precision_bits: int) -> _EarlyZero | None:
    """Return the zero of xdot near a release whose vx is less than a run's rounding.

    None if vx is zero, or if it is more.

    Released with vx = 1e-30 m/s, the bob turns back after some 1e-30 s: the zero of xdot's tangent,
    whose relative error is below the run's epsilon, as vx is below that of the other speeds.
    """
    vx, *others = start.v
    scale = max(start.rate, start.fastest_rate, *(float(abs(speed)) for speed in others))
    if vx == 0 or abs(vx) > start.ctx.ldexp(scale, _UNSEEN_BITS - precision_bits):
        return None
    ax = acceleration(start.n, start.v, start.k)[0]
    if abs(ax) <= start.ctx.ldexp(scale * scale, _UNSEEN_BITS - precision_bits):
        return None
    return _EarlyZero(-vx / ax, 1 if ax > 0 else -1)


def run(plan: Plan, report: Report | None = None, pace: Pace | None = None) -> Run:
    """Integrate a plan; see `Engine.run`.

    Raises:
        IntegrationError: the integrator stopped, or transits contradict each other.
    """
    start = Start.of(plan.inputs, plan.number.prec + GUARD_BITS)
    watching = plan.transits and not xdot_vanishes(start)
    longest = plan.times[-1] * _OTHER_STEPS if plan.other_steps else None
    formulation = carried(FORMULATIONS[plan.formulation], start, Numbers(plan.number).of)
    stepper = Stepper(
        formulation, start, plan.number, events=watching, span=plan.times[-1], longest=longest
    )
    times = [stepper.numbers.of(t) for t in plan.times]
    zeros: list[Zero] = []
    started = time.process_time()
    if watching:
        early = _early_zero(start, plan.number.prec)
        release = stepper.state
        multiplicity = zero_at_release(start) or int(early is not None)
        states, zeros = march(stepper, times, multiplicity, report)
        if early is not None and early.time_s > 0:
            zeros.insert(0, Zero(stepper.numbers.of(early.time_s), early.direction, release))
    else:
        states = stepper.propagate(times, report, pace)
    return result(plan, stepper, states, zeros if watching else None, started)


def run_between(
    plan: Plan, rows: Table, starts: Sequence[int], report: Report | None = None
) -> Run:
    """Integrate from some rows of a grid, each to the time of the next.

    Return a run with the states reached.

    Args:
        plan: the run that is taken in parts: its times are those of the rows. Transits are not
            looked for.
        rows: the states at these times, in SI units.
        starts: numbers of the rows to start from, counted from 0.
        report: called with the time of each row that is reached, in s.

    Raises:
        IntegrationError: the integrator stopped.
    """
    start = Start.of(plan.inputs, plan.number.prec + GUARD_BITS)
    started = time.process_time()
    formulation = carried(FORMULATIONS[plan.formulation], start, Numbers(plan.number).of)
    spans = [plan.times[i + 1] - plan.times[i] for i in starts]
    stepper = Stepper(formulation, start, plan.number, span=sum(spans, Fraction(0)))
    states = rows.only(STATE).values
    zero = stepper.numbers.of(0)
    reached = []
    for i, span in zip(starts, spans, strict=True):
        si = [to_mpf(Fraction(value, 1 << rows.bits), start.ctx) for value in states[i]]
        stepper.back((zero, stepper.model.release(_released_at(start, si))))
        reached.append(stepper.propagate([zero, stepper.numbers.of(span)])[-1])
        if report is not None:
            report(float(plan.times[i + 1]))
    return result(plan, stepper, np.array(reached, dtype=stepper.numbers.dtype), None, started)


def _released_at(start: Start, si: Sequence[Any]) -> Start:
    """Return a start from another state of the scene, in SI units."""
    x, y, z, vx, vy, vz = si
    return replace(start, position=(x, y, z), velocity=(vx, vy, vz))


def result(
    plan: Plan, stepper: Stepper, states: Any, zeros: list[Zero] | None, started: float
) -> Run:
    """Return the states and zeros of a stepper that has reached the end, in SI units.

    Args:
        plan: the plan that was run.
        stepper: after its last step.
        states: at the plan's times, shape (times, variables).
        zeros: of xdot; None if not looked for.
        started: `time.process_time()` when the steps began.
    """
    bits = plan.number.prec + _SMALL_SWING_BITS
    return Run(
        plan=plan,
        grid=stepper.model.table(states, bits),
        order=stepper.order,
        steps=stepper.steps,
        compile_s=stepper.compile_s,
        cpu_s=time.process_time() - started,
        zeros={} if zeros is None else {XDOT: _transits(stepper, zeros, bits)},
    )


def _transits(stepper: Stepper, zeros: list[Zero], bits: int) -> Zeros[Table]:
    numbers = stepper.numbers
    states = np.array([zero.state for zero in zeros], dtype=numbers.dtype)
    times = np.array([zero.t for zero in zeros], dtype=numbers.dtype)
    columns = stepper.model.table(states, bits)
    rows = zip(numbers.fixed(times, bits), columns.values, strict=True)
    table = Table(("t", *columns.columns), bits, [(t, *row) for t, row in rows])
    return Zeros(table, [zero.direction for zero in zeros])
