"""The Taylor steps of a run of heyoka in `momentum`, for a proof: their lengths, and coefficients as large integers."""

from __future__ import annotations

import math
import time
from collections.abc import Generator
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from ...model.formulations import FORMULATIONS
from ...model.start import Start
from ...numbers.precision import GUARD_BITS, real
from ...numbers.taylor_step import LOCAL, TaylorStep
from ...scenes.inputs import Inputs
from ..plan import MOST_TURN, Plan, Run
from .run import result
from .stepper import Stepper

SHRINK = 0.995  # of the step size that heyoka would take, before it is cut to few bits
DECAYS = 5.0  # with a fast drag γ the step size is at most DECAYS MOST_TURN/γ
STEP_BITS = 6  # mantissa of a step size: equal steps share their scaled constants, and times stay short


def taylor_steps(
    inputs: Inputs, times: tuple[Fraction, ...], prec: int, coefficient_bits: int
) -> Generator[TaylorStep, None, Run]:
    """Yield the Taylor steps of a run from t = 0 to one step beyond the last time; return the run.

    Their rows are n east, north and up, and h H.
    """
    plan = Plan(inputs, "momentum", real(prec), times, transits=False)
    start = Start.of(inputs, prec + GUARD_BITS)
    stepper = Stepper(FORMULATIONS["momentum"], start, plan.number, span=times[-1])
    grid = [stepper.numbers.of(t) for t in times]
    started = time.process_time()
    rate = max(float(start.ctx.sqrt(start.ctx.norm(start.k.pull))), float(start.k.drag) / DECAYS)
    longest = _few_bits(MOST_TURN / rate) if rate > 0 else max(times[-1], Fraction(1))
    states, limit, beyond = [stepper.state], stepper.numbers.of(longest), False
    while not beyond:
        beyond = stepper.time > grid[-1]
        t, h, series = stepper.expand(limit, coefficient_bits)
        yield TaylorStep(t, h, Fraction(0), Fraction(1), coefficient_bits, partial(_integers, series), LOCAL)
        while len(states) < len(grid) and grid[len(states)] <= stepper.time:
            states.append(stepper.sample(grid[len(states)]))
        limit = stepper.numbers.of(min(_next_step(h, series, coefficient_bits), longest))
    return result(plan, stepper, np.array(states, dtype=stepper.numbers.dtype), None, started)


def _integers(series: Any) -> tuple[list[int], ...]:
    """Return the coefficients as integers, which costs a sixth of a step."""
    return tuple([int(c) for c in row] for row in series)


def _next_step(h: Fraction, series: Any, bits: int) -> Fraction:
    """Return about the step size that heyoka's rule would give next, with few bits; heyoka's own choice limits it too.

    The rule: h = ρ exp(-2 - 0.7/(p - 1)), ρ the smaller of |c_k|^(-1/k) of the last two orders.
    """
    order = series.shape[1] - 1
    largest = {k: max(abs(int(c)).bit_length() for c in series[:, k]) - bits for k in (order - 1, order)}
    power = min(-log2 / k for k, log2 in largest.items()) - (2 + 0.7 / (order - 1)) * math.log2(math.e)
    return _few_bits(float(h) * 2**power * SHRINK)


def _few_bits(h: float) -> Fraction:
    """Return a little less than h, with a mantissa of `STEP_BITS` bits."""
    mantissa, exponent = math.frexp(h)
    return Fraction(int(mantissa * 2**STEP_BITS)) * Fraction(2) ** (exponent - STEP_BITS)
