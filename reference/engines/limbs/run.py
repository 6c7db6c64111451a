"""Run a plan in limbs: states and transits in SI units as a `Run`; for a proof the polynomials of each Taylor step."""

from __future__ import annotations

import time
from bisect import bisect_right
from collections.abc import Generator
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from ...numbers.columns import RUN
from ...numbers.packing import Digits
from ...numbers.table import Table
from ...numbers.taylor_step import TaylorStep
from ..plan import Pace, Plan, Report, Run
from .integration import Integration, integration_of
from .lanes import LANES
from .limb import Array
from .march import STEPS
from .series import TENSION, M, W, X
from .size import fraction_bits

ROWS = np.array((X, M, W, TENSION))
ORDER_PER_BIT = 0.5  # of the series: more than a run alone would take, since every step must be proved
POLYNOMIALS_PER_CALL = 64
FOR_EVER = 1 << 62  # in grains


def taylor_steps(plan: Plan, coefficient_bits: int) -> Generator[TaylorStep, None, Run]:
    """Yield the Taylor steps of a run in order from t = 0, up to one beyond the last time; return its `Run`.

    Args:
        plan: as for `run`.
        coefficient_bits: the coefficients are wanted to about 2**-coefficient_bits, which the order follows.
    """
    integration = integration_of(plan, POLYNOMIALS_PER_CALL, round(ORDER_PER_BIT * coefficient_bits))
    integration.until = FOR_EVER
    spent, ahead = 0.0, False
    grain, limb_count, last = integration.problem.grain, integration.problem.model.limb_count, plan.times[-1]
    start, end, bits = Fraction(0), Fraction(1), fraction_bits(limb_count)
    while not ahead:
        cpu_start = time.process_time()
        integration.advance(POLYNOMIALS_PER_CALL)
        spent += time.process_time() - cpu_start
        series = integration.out.series.reshape(POLYNOMIALS_PER_CALL, -1).copy()
        for (grains, length), of_step in zip(integration.out.steps.reshape(-1, 2).tolist(), series, strict=True):
            t = grains * grain
            yield TaylorStep(t, length * grain, start, end, bits, partial(_digits, of_step, limb_count))
            if t > last:
                ahead = True
                break
    return result(integration, plan, time.process_time() - spent)


def _digits(series: Array, limb_count: int) -> Digits:
    """Return the rows x, m, w and h² λ of a step, lowest order first."""
    limbs = series.reshape(-1, limb_count, LANES)[:, :, ROWS]
    return Digits(np.ascontiguousarray(limbs.transpose(2, 1, 0), dtype=np.int32))


SPARE_BITS = 32  # SI values carry this much below the last limb: l need not be a short binary fraction
PRODUCTS, PRODUCTS_WITH_DRAG = 9, 25  # per coefficient: three or four convolutions, the others by constants


def run(plan: Plan, report: Report | None = None, pace: Pace | None = None) -> Run:
    """Integrate a plan in limbs, in `inertial` whatever its formulation; `plan.number` tells the precision.

    Args:
        plan: what to run; times increasing from 0 on.
        report: called with the simulated time in s.
        pace: as in `Engine.run`.

    Raises:
        InputError: more bits than limbs can hold.
        IntegrationError: zeros of xdot stay in doubt, or no step is short enough. No numbers then.
    """
    integration = integration_of(plan)
    cpu_start = time.process_time()
    integration.finish(report, pace)
    return result(integration, plan, cpu_start)


def result(integration: Integration, plan: Plan, cpu_start: float) -> Run:
    """Return what an integration computed, in SI units; `cpu_start` is `time.process_time()` when its steps began."""
    problem, bits = integration.problem, fraction_bits(integration.problem.model.limb_count)
    si_bits = bits + SPARE_BITS
    table = integration.table(integration.out.states, len(plan.times))
    grid = Table(RUN, si_bits, list(zip(*_si(table, plan.inputs.length, problem.unit, bits, si_bits), strict=True)))
    transits, signs = _transits(integration, plan, bits, si_bits) if integration.seek else (None, [])
    return Run(
        plan=plan,
        grid=grid,
        transits=transits,
        directions=signs,
        order=problem.model.order,
        steps=int(integration.state.counts[STEPS]),
        terms=PRODUCTS_WITH_DRAG if problem.model.drag else PRODUCTS,
        compile_s=integration.compile_s,
        cpu_s=time.process_time() - cpu_start,
    )


def _si(table: Any, length: Fraction, unit: Fraction, bits: int, si_bits: int) -> list[Any]:
    """Return columns of integers over 2**bits, in l and the unit of time, as integers over 2**si_bits in SI units."""
    return [_scaled(table[:, i], length / unit ** (i // 3) * 2 ** (si_bits - bits)) for i in range(len(RUN))]


def _scaled(column: Any, factor: Fraction) -> Any:
    """Return integers times a factor, rounded down."""
    product = column * factor.numerator
    return product if factor.denominator == 1 else product // factor.denominator


def _transits(integration: Integration, plan: Plan, bits: int, si_bits: int) -> tuple[Table, list[int]]:
    """Return the zeros up to the last output time, and the signs of the crossings."""
    problem = integration.problem
    times, table, signs = integration.zeros()
    count = bisect_right(times, int(plan.times[-1] / problem.grain * 2**bits))
    moments = _scaled(times[:count], problem.grain * 2 ** (si_bits - bits))
    columns = _si(table[:count], plan.inputs.length, problem.unit, bits, si_bits)
    return Table(("t", *RUN), si_bits, list(zip(moments, *columns, strict=True))), signs[:count]
