"""The Taylor steps of a run in limbs, for a proof: one polynomial per step, its coefficients as large integers."""

from __future__ import annotations

import time
from collections.abc import Generator
from fractions import Fraction
from functools import partial

import numpy as np

from ...numbers.packing import Digits
from ...numbers.taylor_step import TaylorStep
from ..plan import Plan, Run
from .integration import integration_of
from .lanes import LANES
from .limb import Array
from .run import result
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
