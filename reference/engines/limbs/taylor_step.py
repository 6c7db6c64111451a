"""The Taylor steps of a run in limbs, for a proof: one polynomial per step, its coefficients as large integers."""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from ...packing import WORD_BITS, Words
from ..plan import Plan, Run
from .integration import integration_of
from .lanes import LANES, entry
from .limb import LIMB_BITS, Array, fraction_bits
from .run import result
from .series import TENSION, M, W, X

ROWS = np.array((X, M, W, TENSION))
POLYNOMIALS_PER_CALL = 64
FOR_EVER = 1 << 62  # in grains


@dataclass(frozen=True)
class LimbsTaylorStep:
    """Taylor polynomials of n and h² λ at t, of s = (time - t)/h, to be used up to t + h, in the axes of `series`.

    Attributes:
        t: centre in s, exact.
        h: step in s, exact.
        limb_count: limbs of a coefficient.
    """

    t: Fraction
    h: Fraction
    limb_count: int
    _series: Array = field(repr=False)

    @property
    def bits(self) -> int:
        """Coefficients are integers over 2**bits."""
        return fraction_bits(self.limb_count)

    @property
    def coefficients(self) -> Words:
        """Rows x, m, w and h² λ, lowest order first; computed on request, as a proof needs every second step only."""
        words, orders = LIMB_BITS * self.limb_count // WORD_BITS + 1, len(self._series) // (LANES * self.limb_count)
        table = np.empty((len(ROWS), words, orders), dtype=np.int64)
        write_words(table, self._series, ROWS, self.limb_count)
        return Words(table)


def taylor_steps(plan: Plan, order: int | None = None) -> Generator[LimbsTaylorStep, None, Run]:
    """Yield the Taylor steps of a run in order from t = 0, up to one beyond the last time; return its `Run`.

    Args:
        plan: as for `run`.
        order: of the series; None for the one that is cheapest to compute.
    """
    integration, ahead = integration_of(plan, POLYNOMIALS_PER_CALL, order), False
    integration.until = FOR_EVER
    spent = 0.0
    grain, model, last = integration.problem.grain, integration.problem.model, plan.times[-1]
    while not ahead:
        cpu_start = time.process_time()
        integration.advance(POLYNOMIALS_PER_CALL)
        spent += time.process_time() - cpu_start
        series = integration.out.series.reshape(POLYNOMIALS_PER_CALL, -1).copy()
        for (start, length), of_step in zip(integration.out.steps.reshape(-1, 2).tolist(), series, strict=True):
            t = start * grain
            yield LimbsTaylorStep(t, length * grain, model.limb_count, of_step)
            if t > last:
                ahead = True
                break
    return result(integration, plan, time.process_time() - spent)


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
