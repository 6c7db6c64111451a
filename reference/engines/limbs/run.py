"""Run a plan in limbs: states and transits in SI units as a `Run`; for a proof the polynomials of each Taylor step.

Output times are counted in grains, a power of two in s: an integer, and limbs for the remaining part of a grain.
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
from .problem import limb_problem
from .series import TENSION, M, W, X
from .size import MOST_PREC, fraction_bits
from .zeros import MOST_ZEROS

STEPS_PER_CALL = 1024
COMPILE_S = 18  # what compiling takes, about, of which users are told
ROWS = np.array((X, M, W, TENSION))
# of the series: more than a run alone would take, since every step must be proved
ORDER_PER_BIT = 0.5
POLYNOMIALS_PER_CALL = 64
FOR_EVER = 1 << 62  # in grains
# SI values carry this much below the last limb: l need not be a short binary fraction
SPARE_BITS = 32


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
                "Use the engine heyoka for more digits.",
            )
        self.problem = problem = limb_problem(plan.inputs, prec, order, plan.other_steps)
        self.seek = seek = plan.transits and not xdot_vanishes(problem.start)
        limb_count, model = problem.model.limb_count, problem.model
        unit, grain = 1 << fraction_bits(limb_count), problem.grain
        fixed = [
            unit * t.numerator * grain.denominator // (t.denominator * grain.numerator)
            for t in plan.times
        ]
        whole, remainders = zip(*(divmod(t, unit) for t in fixed), strict=True)
        multiplicity = zero_at_release(problem.start) if seek else 0
        self.state = state_at_release(problem.state, problem.first, multiplicity, model)
        room = STEPS_PER_CALL + MOST_ZEROS if seek else 0
        self.out = Outputs(
            np.array(whole, dtype=np.int64),
            split(remainders, limb_count).ravel(),
            aligned(len(whole) * limb_count * LANES),
            np.zeros(3 * room, dtype=np.int64),
            np.zeros(room * limb_count),
            aligned(room * limb_count * LANES),
            np.zeros(2 * polynomials, dtype=np.int64),
            aligned(polynomials * (model.order + 1) * limb_count * LANES),
        )
        self.until = FOR_EVER if polynomials else whole[-1] + 1
        # of xdot, of each call: time in grains and state, over 2**fraction_bits, and sign
        self.zeros: list[Any] = []
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
                f"zeros of xdot near t = {self.time} s: xdot touches zero within the precision.",
                AT_REST,
            )
        return bool(outcome == GOOD)

    def _arguments(self, steps: int) -> tuple[Any, ...]:
        """Return the arguments of `march`."""
        return self.state, self.problem.model, self.out, self.until, steps, self.seek

    def _keep_zeros(self) -> None:
        n, limb_count = int(self.state.counts[ZEROS]), self.problem.model.limb_count
        starts, lengths, signs = self.out.moments[: 3 * n].reshape(n, 3).T.astype(object)
        places = joined(self.out.places[: n * limb_count].reshape(n, limb_count))
        moments = (starts << fraction_bits(limb_count)) + lengths * places
        self.zeros.append(np.column_stack([moments, self.table(self.out.zero_states, n), signs]))
        self.state.counts[ZEROS] = 0

    def table(self, rows: Array, count: int) -> Any:
        """Return rows of limbs as integers over 2**fraction_bits, shape (count, COLUMNS)."""
        limb_count = self.problem.model.limb_count
        limbs = np.moveaxis(
            rows[: count * limb_count * LANES].reshape(count, limb_count, LANES), 1, 2
        )
        return joined(limbs[:, :COLUMNS])


def taylor_steps(plan: Plan, coefficient_bits: int) -> Generator[TaylorStep, None, Run]:
    """Yield the Taylor steps of a run in order from t = 0, up to one beyond the last time; return its `Run`.

    Args:
        plan: as for `run`.
        coefficient_bits: the coefficients are wanted to about 2**-coefficient_bits, which the order follows.
    """
    integration = Integration(plan, POLYNOMIALS_PER_CALL, round(ORDER_PER_BIT * coefficient_bits))
    spent = 0.0
    grain, limb_count, last = (
        integration.problem.grain,
        integration.problem.model.limb_count,
        plan.times[-1],
    )
    start, end, bits = Fraction(0), Fraction(1), fraction_bits(limb_count)
    while True:
        cpu_start = time.process_time()
        integration.advance(POLYNOMIALS_PER_CALL)
        spent += time.process_time() - cpu_start
        series = integration.out.series.reshape(POLYNOMIALS_PER_CALL, -1).copy()
        for (grains, length), of_step in zip(
            integration.out.steps.reshape(-1, 2).tolist(), series, strict=True
        ):
            t = grains * grain
            yield TaylorStep(
                t, length * grain, start, end, bits, partial(_digits, of_step, limb_count)
            )
            if t > last:
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
    factors = [plan.inputs.length / problem.unit ** (i // 3) for i in range(COLUMNS)]
    grid = _si(integration.table(integration.out.states, len(plan.times)), factors)
    zeros = np.concatenate(integration.zeros)
    zeros = zeros[zeros[:, 0] <= int(plan.times[-1] / problem.grain * 2**bits)]
    transits = Table(("t", *RUN), bits + SPARE_BITS, _si(zeros[:, :-1], [problem.grain, *factors]))
    return Run(
        plan=plan,
        grid=Table(RUN, bits + SPARE_BITS, grid),
        order=problem.model.order,
        steps=int(integration.state.counts[STEPS]),
        compile_s=integration.compile_s,
        cpu_s=time.process_time() - cpu_start,
        zeros={XDOT: Zeros(transits, zeros[:, -1].tolist())} if integration.seek else {},
    )


def _si(table: Any, factors: Sequence[Fraction]) -> list[tuple[int, ...]]:
    """Return the rows of a table of integers, each column times a factor, over 2**SPARE_BITS times their unit."""
    scaled = [factor * 2**SPARE_BITS for factor in factors]
    columns = [
        column * f.numerator // f.denominator for column, f in zip(table.T, scaled, strict=True)
    ]
    return list(zip(*columns, strict=True))
