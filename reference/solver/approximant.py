"""The approximant of a proof: the Taylor polynomials of a run, by heyoka in a child process, or by limbs.

A polynomial serves both sides of its centre, so only every other step is sent. The proof consumes the polynomials as
they arrive; the pipe provides back-pressure. The proof bounds the defect of every polynomial, so none need be trusted.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Generator, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from ..engines.plan import Plan, Run
from ..engines.registry import HEYOKA, LIMBS, fastest
from ..engines.run import result
from ..errors import IntegrationError
from ..model.formulations import FORMULATIONS
from ..model.start import Start
from ..precision import GUARD_BITS, real
from ..process import Emit, Worker
from ..scene import Inputs

if TYPE_CHECKING:
    from ..engines.heyoka.stepper import HeyokaTaylorStep

COEFFICIENT_BITS = 20  # coefficients carry this many bits below the run's epsilon, so that cutting them costs nothing
ORDER_PER_BIT = 0.5  # of the polynomials of limbs: more than a run alone would take, since every step must be proved
BATCH = 32  # steps sent at once
SHRINK = 0.995  # of the step size that heyoka would take, before it is cut to few bits
MOST_TURN = 1.75  # largest step size times the swing's frequency: a small swing's series reach further, bounds do not
DECAYS = 5.0  # with a fast drag γ the step size is at most DECAYS MOST_TURN/γ
STEP_BITS = 6  # mantissa of a step size: equal steps share their scaled constants, and times stay short


@dataclass
class Feed:
    """The run whose Taylor polynomials the proof takes.

    Called with a precision, it starts the run and yields its steps; `finished` then returns the states.

    Attributes:
        inputs: the scene's exact inputs.
        times: output times in s; the run goes one step beyond the last.
        engine: limbs, whose run costs so little that it needs no process, or heyoka, in `momentum`.
    """

    inputs: Inputs
    times: tuple[Fraction, ...]
    engine: str = HEYOKA
    _worker: Worker | None = field(default=None, repr=False)
    _steps: Iterator[Any] = field(default_factory=lambda: iter(()), repr=False)
    _run: Run | None = field(default=None, repr=False)

    def __call__(self, prec: int) -> Iterator[Any]:
        """Start a run at `prec` bits and return its steps, in order from t = 0."""
        self.stop()
        formulation, number = fastest(prec, self.engine)
        if number.name == "limbs":
            self._steps = self._of_limbs(Plan(self.inputs, formulation, number, self.times, transits=False))
            return self._steps
        self._worker = Worker(_send_steps, self.inputs, self.times, prec)
        self._steps = self._received(self._worker)
        return self._steps

    @property
    def workers(self) -> int:
        """Number of processes that the proof may use: one beside heyoka's child, two with limbs, which has none."""
        return min(2, os.cpu_count() or 1) if self.engine == LIMBS else 1

    def _of_limbs(self, plan: Plan) -> Iterator[Any]:
        from ..enclosure import pair
        from ..engines import limbs

        bits = plan.number.prec + COEFFICIENT_BITS

        def chain() -> Iterator[limbs.LimbsTaylorStep]:
            self._run = yield from limbs.taylor_steps(plan, round(ORDER_PER_BIT * bits))

        return pair(chain())

    def finished(self) -> Run:
        """Exhaust the steps and return the run, with its states at `times`."""
        for _ in self._steps:
            pass
        if self._run is None:
            raise IntegrationError("heyoka's process ended without its states.")
        return self._run

    def _received(self, worker: Worker) -> Iterator[Any]:
        for item in worker:
            if isinstance(item, Run):
                self._run = item
            else:
                yield from item

    def stop(self) -> None:
        """End the process."""
        if self._worker is not None:
            self._worker.stop()


def expand(inputs: Inputs, times: tuple[Fraction, ...], prec: int) -> Generator[HeyokaTaylorStep, None, Run]:
    """Yield the Taylor steps of a run at `prec` bits from t = 0 to one step beyond the last time; return its `Run`."""
    from ..engines.heyoka import stepper as heyoka

    plan = Plan(inputs, "momentum", real(prec), times, transits=False)
    start = Start.of(inputs, prec + GUARD_BITS)
    stepper = heyoka.Stepper(FORMULATIONS["momentum"], start, plan.number)
    grid = [stepper.numbers.of(t) for t in times]
    started = time.process_time()
    rate = max(float(start.ctx.sqrt(start.ctx.norm(start.k.pull))), float(start.k.drag) / DECAYS)
    longest = _few_bits(MOST_TURN / rate) if rate > 0 else max(times[-1], Fraction(1))
    states, limit, beyond = [stepper.state], stepper.numbers.of(longest), False
    while not beyond:
        beyond = stepper.time > grid[-1]
        step = stepper.expand(limit, prec + COEFFICIENT_BITS)
        yield step
        while len(states) < len(grid) and grid[len(states)] <= stepper.time:
            states.append(stepper.sample(grid[len(states)]))
        limit = stepper.numbers.of(min(_next_step(step, stepper.order), longest))
    return result(plan, stepper, np.array(states, dtype=stepper.numbers.dtype), None, started)


def _next_step(step: HeyokaTaylorStep, order: int) -> Fraction:
    """Return about the step size that heyoka's rule would give next, with few bits; heyoka's own choice limits it too.

    The rule: h = ρ exp(-2 - 0.7/(p - 1)), ρ the smaller of |c_k|^(-1/k) of the last two orders.
    """
    power = min(-step.log2_largest(k) / k for k in (order - 1, order)) - (2 + 0.7 / (order - 1)) * math.log2(math.e)
    return _few_bits(float(step.h) * 2**power * SHRINK)


def _few_bits(h: float) -> Fraction:
    """Return a little less than h, with a mantissa of `STEP_BITS` bits."""
    mantissa, exponent = math.frexp(h)
    return Fraction(int(mantissa * 2**STEP_BITS)) * Fraction(2) ** (exponent - STEP_BITS)


def _send_steps(emit: Emit, inputs: Inputs, times: tuple[Fraction, ...], prec: int) -> None:
    from ..enclosure import pair, turned

    runs: list[Run] = []

    def chain() -> Iterator[HeyokaTaylorStep]:
        runs.append((yield from expand(inputs, times, prec)))

    steps = pair(turned(inputs, chain()))
    while batch := list(islice(steps, BATCH)):
        emit(batch)
    emit(runs[0])
