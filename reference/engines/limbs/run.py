"""Run a plan in limbs: states and transits in SI units as a `Run`; for a proof the polynomials of each Taylor step.

Output times are counted in grains, a power of two in s: an integer, and limbs for the remaining part of a grain.
"""

from __future__ import annotations

import time
from bisect import bisect_right
from collections.abc import Generator, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from ...errors import InputError, IntegrationError
from ...model.start import xdot_vanishes, zero_at_release
from ...numbers.columns import RUN
from ...numbers.table import Table
from ...numbers.taylor_step import Digits, TaylorStep
from ...system.machine_code import prepare
from ..plan import AT_REST, Pace, Plan, Report, Run
from .lanes import LANES
from .limb import Array, aligned, joined, split
from .march import COLUMNS, DOUBTFUL, GOOD, STEPS, STUCK, TIME, ZEROS, Outputs, march, state_at_release
from .problem import limb_problem
from .series import TENSION, Counts, M, W, X
from .size import MOST_PREC, fraction_bits
from .zeros import MOST_ZEROS

STEPS_PER_CALL = 1024
COMPILE_S = 18  # what compiling takes, about, of which users are told
ROWS = np.array((X, M, W, TENSION))
ORDER_PER_BIT = 0.5  # of the series: more than a run alone would take, since every step must be proved
POLYNOMIALS_PER_CALL = 64
FOR_EVER = 1 << 62  # in grains
SPARE_BITS = 32  # SI values carry this much below the last limb: l need not be a short binary fraction


def limbs_of_fractions(times: Sequence[Fraction], grain: Fraction, limb_count: int) -> tuple[Counts, Array]:
    """Return exact times in s as whole grains and the limbs of the remainders, cut after the last limb.

    Shapes (times,) and (times * limb_count,).
    """
    unit = 1 << fraction_bits(limb_count)
    fixed = [unit * t.numerator * grain.denominator // (t.denominator * grain.numerator) for t in times]
    whole, remainders = zip(*(divmod(t, unit) for t in fixed), strict=True)
    return np.array(whole, dtype=np.int64), split(remainders, limb_count).ravel()


class Integration:
    """The integration of a plan, at its release or in progress: problem, state and output arrays.

    Args:
        plan: what to integrate.
        polynomials: for how many steps of each call of `advance` the coefficients are kept.
        order: of the series; None for the cheapest.

    Raises:
        InputError: more bits than limbs can hold.
    """

    def __init__(self, plan: Plan, polynomials: int = 0, order: int | None = None) -> None:
        prec = plan.number.prec
        if prec > MOST_PREC:
            advice = "Use the engine heyoka for more digits."
            raise InputError("precision", prec, f"at most {MOST_PREC} bits", advice)
        self.problem = problem = limb_problem(plan.inputs, prec, order, plan.other_steps)
        self.seek = seek = plan.transits and not xdot_vanishes(problem.start)
        limb_count, model = problem.model.limb_count, problem.model
        whole, remainders = limbs_of_fractions(plan.times, problem.grain, limb_count)
        multiplicity = zero_at_release(problem.start) if seek else 0
        self.state = state_at_release(problem.state, problem.first, multiplicity, model)
        room = STEPS_PER_CALL + MOST_ZEROS if seek else 0
        self.out = Outputs(
            whole,
            remainders,
            aligned(len(whole) * limb_count * LANES),
            np.zeros(3 * room, dtype=np.int64),
            np.zeros(room * limb_count),
            aligned(room * limb_count * LANES),
            np.zeros(2 * polynomials, dtype=np.int64),
            aligned(polynomials * (model.order + 1) * limb_count * LANES),
        )
        self.until = int(whole[-1]) + 1
        self.moments: list[int] = []  # of zeros of xdot: times in grains and states, over 2**fraction_bits
        self.zero_states: list[list[int]] = []
        self.signs: list[int] = []
        cpu_start = time.process_time()
        prepare(march, "limbs", COMPILE_S, *self._arguments(0))
        self.compile_s = time.process_time() - cpu_start

    def finish(self, report: Report | None, pace: Pace | None = None) -> None:
        """Advance to the last output time.

        Raises:
            IntegrationError: zeros of xdot stay in doubt, or no step is short enough.
        """
        while not self.advance(STEPS_PER_CALL):
            if pace is not None:
                pace(int(self.state.counts[STEPS]), self.time)
            if report is not None:
                report(self.time)

    @property
    def time(self) -> float:
        """Time reached, in s."""
        return float(int(self.state.counts[TIME]) * self.problem.grain)

    def advance(self, steps: int) -> bool:
        """Take at most `steps` steps; return true when the last output time is passed."""
        outcome = march(*self._arguments(steps))
        self._keep_zeros()
        if outcome == STUCK:
            raise IntegrationError(f"no step is short enough at t = {self.time} s.")
        if outcome == DOUBTFUL:
            raise IntegrationError(
                f"zeros of xdot near t = {self.time} s: xdot touches zero within the precision.", AT_REST
            )
        return bool(outcome == GOOD)

    def _arguments(self, steps: int) -> tuple[Any, ...]:
        """Return the arguments of `march`."""
        return self.state, self.problem.model, self.out, self.until, steps, self.seek

    def _keep_zeros(self) -> None:
        n, limb_count = int(self.state.counts[ZEROS]), self.problem.model.limb_count
        starts, lengths, signs = self.out.moments[: 3 * n].reshape(n, 3).T.tolist()
        places = joined(self.out.places[: n * limb_count].reshape(n, limb_count))
        parts, bits = zip(starts, lengths, places, strict=True), fraction_bits(limb_count)
        self.moments += [(start << bits) + length * place for start, length, place in parts]
        self.zero_states += self.table(self.out.zero_states, n).tolist()
        self.signs += signs
        self.state.counts[ZEROS] = 0

    def table(self, rows: Array, count: int) -> Any:
        """Return rows of limbs as integers over 2**fraction_bits, shape (count, COLUMNS)."""
        limb_count = self.problem.model.limb_count
        limbs = np.moveaxis(rows[: count * limb_count * LANES].reshape(count, limb_count, LANES), 1, 2)
        return joined(limbs[:, :COLUMNS])


def taylor_steps(plan: Plan, coefficient_bits: int) -> Generator[TaylorStep, None, Run]:
    """Yield the Taylor steps of a run in order from t = 0, up to one beyond the last time; return its `Run`.

    Args:
        plan: as for `run`.
        coefficient_bits: the coefficients are wanted to about 2**-coefficient_bits, which the order follows.
    """
    integration = Integration(plan, POLYNOMIALS_PER_CALL, round(ORDER_PER_BIT * coefficient_bits))
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
    integration = Integration(plan)
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
    count = bisect_right(integration.moments, int(plan.times[-1] / problem.grain * 2**bits))
    moments = _scaled(np.array(integration.moments[:count], dtype=object), problem.grain * 2 ** (si_bits - bits))
    states = np.array(integration.zero_states[:count], dtype=object).reshape(count, COLUMNS)
    columns = _si(states, plan.inputs.length, problem.unit, bits, si_bits)
    return Table(("t", *RUN), si_bits, list(zip(moments, *columns, strict=True))), integration.signs[:count]
