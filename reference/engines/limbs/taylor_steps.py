"""The Taylor steps of a run in limbs, for a proof: one polynomial per step, its coefficients as large integers."""

from __future__ import annotations

import time
from collections.abc import Generator
from fractions import Fraction
from functools import partial

import numpy as np
import numpy.typing as npt

from ...packing import WORD_BITS, Words
from ...taylor_step import TaylorStep
from ..plan import Plan, Run
from .integration import integration_of
from .lanes import LANES, entry
from .limb import Array
from .run import result
from .series import TENSION, M, W, X
from .size import LIMB_BITS, fraction_bits

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
            yield TaylorStep(t, length * grain, start, end, bits, partial(_words, of_step, limb_count))
            if t > last:
                ahead = True
                break
    return result(integration, plan, time.process_time() - spent)


def _words(series: Array, limb_count: int) -> Words:
    """Return the rows x, m, w and h² λ of a step, lowest order first."""
    words, orders = LIMB_BITS * limb_count // WORD_BITS + 1, len(series) // (LANES * limb_count)
    table = np.empty((len(ROWS), words, orders), dtype=np.int64)
    write_words(table, series, ROWS, limb_count)
    return Words(table)


@entry
def write_words(to: npt.NDArray[np.int64], series: Array, rows: npt.NDArray[np.int64], limb_count: int) -> None:
    """Write the limbs of the lanes `rows` as words of WORD_BITS bits, shape (rows, words, orders)."""
    for i in range(to.shape[0]):
        for k in range(to.shape[2]):
            word, bits, over, place = 0, 0, 0, 0
            for q in range(limb_count - 1, -1, -1):
                value = int(series[(k * limb_count + q) * LANES + rows[i]]) + over
                over = value >> LIMB_BITS
                limb, room = value - (over << LIMB_BITS), WORD_BITS - bits
                if room <= LIMB_BITS:
                    to[i, place, k] = word | (limb & ((1 << room) - 1)) << bits
                    word, bits, place = limb >> room, LIMB_BITS - room, place + 1
                else:
                    word |= limb << bits
                    bits += LIMB_BITS
            to[i, place, k] = word + (over << bits)
