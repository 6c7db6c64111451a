"""Run a plan in limbs: states and transits in SI units as a `Run`; for a proof the polynomials of each Taylor step.

Output times are counted in grains, a power of two in s: an integer, and limbs for the remaining
part of a grain.
"""

from __future__ import annotations

import time
from collections.abc import Generator, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from ...errors import InputError, IntegrationError
from ...model.start import xdot_vanishes, zero_at_release
from ...numbers.columns import RUN
from ...numbers.precision import Array
from ...numbers.table import Table
from ...numbers.taylor_step import Digits, TaylorStep
from ...numbers.zeros import XDOT, Zeros
from ...system.machine_code import prepare
from ..plan import AT_REST, Pace, Plan, Report, Run
from ..simd.lanes import LANES, aligned
from .limb import joined, split
from .march import (
    COLUMNS,
    DOUBTFUL,
    GOOD,
    STEPS,
    STUCK,
    TIME,
    ZEROS,
    Outputs,
    march,
    state_at_release,
)
from .problem import LimbProblem, limb_problem
from .series import TENSION, M, W, X
from .size import MOST_PREC, fraction_bits
from .zeros import MOST_ZEROS

_STEPS_PER_CALL = 1024
_COMPILE_S = 18  # about what compiling takes, as announced to users
_ROWS = np.array((X, M, W, TENSION))
# of the series: more than a run alone would take, since every step must be proved
_ORDER_PER_BIT = 0.5
_POLYNOMIALS_PER_CALL = 64
_FOR_EVER = 1 << 62  # in grains
# SI values carry this much below the last limb: l need not be a short binary fraction
_SPARE_BITS = 32


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
            raise InputError(
                "precision",
                prec,
                f"at most {MOST_PREC} bits",
                "For more digits use the engine heyoka.",
            )
        self.problem = limb_problem(plan.inputs, prec, order, plan.other_steps)
        start = self.problem.start
        self.seek = plan.transits and not xdot_vanishes(start)
        multiplicity = zero_at_release(start) if self.seek else 0
        self.state = state_at_release(
            self.problem.state, self.problem.first, multiplicity, self.problem.model
        )
        self.out = _empty_outputs(self.problem, plan.times, self.seek, polynomials)
        self.until = _FOR_EVER if polynomials else int(self.out.whole[-1]) + 1
        # of xdot, of each call: time in grains and state, over 2**fraction_bits, and sign
        self.zeros: list[Any] = []
        cpu_start = time.process_time()
        prepare(march, "limbs", _COMPILE_S, *self._arguments(0))
        self.compile_s = time.process_time() - cpu_start

    def finish(self, report: Report | None, pace: Pace | None = None) -> None:
        """Advance to the last output time.

        Raises:
            IntegrationError: zeros of xdot stay in doubt, or no step is short enough.
        """
        while not self.advance(_STEPS_PER_CALL):
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
            raise IntegrationError(f"even the shortest step is too long at t = {self.time} s.")
        if outcome == DOUBTFUL:
            raise IntegrationError(
                f"near t = {self.time} s, this precision cannot tell whether xdot crosses zero or touches it.",
                AT_REST,
            )
        return bool(outcome == GOOD)

    def _arguments(self, steps: int) -> tuple[Any, ...]:
        """Return the arguments of `march`."""
        return self.state, self.problem.model, self.out, self.until, steps, self.seek

    def _keep_zeros(self) -> None:
        """Keep the zeros of a call of `march`, and make room for those of the next one."""
        n = int(self.state.counts[ZEROS])
        limb_count = self.problem.model.limb_count
        starts, lengths, signs = self.out.moments[: 3 * n].reshape(n, 3).T.astype(object)
        places = joined(self.out.places[: n * limb_count].reshape(n, limb_count))
        moments = (starts << fraction_bits(limb_count)) + lengths * places
        self.zeros.append(np.column_stack([moments, self.table(self.out.zero_states, n), signs]))
        self.state.counts[ZEROS] = 0

    def table(self, rows: Array, count: int) -> Any:
        """Return rows of limbs as integers over 2**fraction_bits, shape (count, COLUMNS)."""
        limb_count = self.problem.model.limb_count
        blocks = rows[: count * limb_count * LANES].reshape(count, limb_count, LANES)
        return joined(np.moveaxis(blocks, 1, 2)[:, :COLUMNS])


def _empty_outputs(
    problem: LimbProblem, times: Sequence[Fraction], seek: bool, polynomials: int
) -> Outputs:
    """Return the output times, and room for what a call of `march` writes."""
    order = problem.model.order
    limb_count = problem.model.limb_count
    unit = 1 << fraction_bits(limb_count)
    grain = problem.grain
    scaled = [
        unit * t.numerator * grain.denominator // (t.denominator * grain.numerator) for t in times
    ]
    whole = [t // unit for t in scaled]
    remainders = [t % unit for t in scaled]
    room = _STEPS_PER_CALL + MOST_ZEROS if seek else 0
    return Outputs(
        whole=np.array(whole, dtype=np.int64),
        remainders=split(remainders, limb_count).ravel(),
        states=aligned(len(times) * limb_count * LANES),
        moments=np.zeros(3 * room, dtype=np.int64),
        places=np.zeros(room * limb_count),
        zero_states=aligned(room * limb_count * LANES),
        steps=np.zeros(2 * polynomials, dtype=np.int64),
        series=aligned(polynomials * (order + 1) * limb_count * LANES),
    )


def taylor_steps(plan: Plan, coefficient_bits: int) -> Generator[TaylorStep, None, Run]:
    """Yield the Taylor steps of a run in order from t = 0, up to one beyond the last time.

    Return its `Run`.

    Args:
        plan: as for `run`.
        coefficient_bits: the coefficients are wanted to about 2**-coefficient_bits, which the order
            follows.
    """
    order = round(_ORDER_PER_BIT * coefficient_bits)
    integration = Integration(plan, _POLYNOMIALS_PER_CALL, order)
    grain = integration.problem.grain
    limb_count = integration.problem.model.limb_count
    bits = fraction_bits(limb_count)
    spent_s = 0.0
    while True:
        cpu_start = time.process_time()
        integration.advance(_POLYNOMIALS_PER_CALL)
        spent_s += time.process_time() - cpu_start
        steps = integration.out.steps.reshape(-1, 2).tolist()
        series = integration.out.series.reshape(_POLYNOMIALS_PER_CALL, -1).copy()
        for (grains, length), of_step in zip(steps, series, strict=True):
            t = grains * grain
            digits = partial(_digits, of_step, limb_count)
            yield TaylorStep(t, length * grain, Fraction(0), Fraction(1), bits, digits)
            if t > plan.times[-1]:
                return result(integration, plan, time.process_time() - spent_s)


def _digits(series: Array, limb_count: int) -> Digits:
    """Return the rows x, m, w and h² λ of a step, lowest order first."""
    limbs = series.reshape(-1, limb_count, LANES)[:, :, _ROWS]
    return Digits(np.ascontiguousarray(limbs.transpose(2, 1, 0), dtype=np.int32))


def run(plan: Plan, report: Report | None = None, pace: Pace | None = None) -> Run:
    """Integrate a plan in limbs, in `inertial` whatever its formulation.

    `plan.number` has the precision.

    Args:
        plan: what to run; times increasing from 0 on.
        report: called with the simulated time in s.
        pace: as in `Engine.run`.

    Raises:
        InputError: more bits than limbs can hold.
        IntegrationError: zeros of xdot stay in doubt, or no step is short enough.
    """
    integration = Integration(plan)
    cpu_start = time.process_time()
    integration.finish(report, pace)
    return result(integration, plan, cpu_start)


def result(integration: Integration, plan: Plan, cpu_start: float) -> Run:
    """Return what an integration computed, in SI units.

    `cpu_start` is `time.process_time()` when its steps began.
    """
    problem = integration.problem
    bits = fraction_bits(problem.model.limb_count)
    factors = [plan.inputs.length / problem.unit ** (i // 3) for i in range(COLUMNS)]
    grid = _si(integration.table(integration.out.states, len(plan.times)), factors)
    zeros = np.concatenate(integration.zeros)
    zeros = zeros[zeros[:, 0] <= int(plan.times[-1] / problem.grain * 2**bits)]
    moments_and_states = _si(zeros[:, :-1], [problem.grain, *factors])
    transits = Table(("t", *RUN), bits + _SPARE_BITS, moments_and_states)
    return Run(
        plan=plan,
        grid=Table(RUN, bits + _SPARE_BITS, grid),
        order=problem.model.order,
        steps=int(integration.state.counts[STEPS]),
        compile_s=integration.compile_s,
        cpu_s=time.process_time() - cpu_start,
        zeros={XDOT: Zeros(transits, zeros[:, -1].tolist())} if integration.seek else {},
    )


def _si(table: Any, factors: Sequence[Fraction]) -> list[tuple[int, ...]]:
    """Return the rows of a table of integers, each column times a factor, over 2**_SPARE_BITS times their unit."""
    columns = []
    for column, factor in zip(table.T, factors, strict=True):
        scaled = factor * 2**_SPARE_BITS
        columns.append(column * scaled.numerator // scaled.denominator)
    return list(zip(*columns, strict=True))
