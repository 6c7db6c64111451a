"""A run as the candidate of a proof: its Taylor polynomials, heyoka's from a process of its own, or those of limbs.

A polynomial serves both sides of its centre, so that of two steps one is sent. The proof takes them as they
come: both cores work, and the pipe holds the run back if it is ahead. Nothing here is trusted: what is wrong
with a polynomial, the proof measures.
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
from ..engines.run import result, start_of
from ..errors import IntegrationError
from ..model.formulations import FORMULATIONS
from ..precision import real
from ..process import Emit, Worker
from ..scene import Inputs

if TYPE_CHECKING:
    from ..engines.heyoka.stepper import Polynomials

GUARD_BITS = 20  # coefficients carry this much below the run's epsilon
ORDER_PER_BIT = (
    0.5  # of a candidate in limbs: fewer steps to prove are worth a higher order than a run alone would take
)
BATCH = 32  # steps sent at once
SHRINK = 0.995  # of the step heyoka would take, before it is cut to few bits
MOST_TURN = 1.75  # of a step times the swing's frequency: nearly linear series reach further, but no bound follows them
DECAYS = 5.0  # likewise of a step with a fast drag
STEP_BITS = 6  # mantissa of a step: equal steps share their scaled constants, and times stay short


@dataclass
class Feed:
    """Starts a run at a precision, hands on its polynomials, and keeps what it computed.

    Attributes:
        inputs: the scene's exact inputs.
        times: output times in s; the run goes one step beyond the last.
        engine: limbs, whose run costs so little that it needs no process, or heyoka, in `momentum`.
    """

    inputs: Inputs
    times: tuple[Fraction, ...]
    engine: str = HEYOKA
    _worker: Worker | None = field(default=None, repr=False)
    _open: Iterator[Any] = field(default_factory=lambda: iter(()), repr=False)
    _done: Run | None = field(default=None, repr=False)

    def __call__(self, prec: int) -> Iterator[Any]:
        """The steps to prove of a run at `prec` bits, in order from t = 0."""
        self.stop()
        formulation, number = fastest(prec, self.engine)
        if number.name == "limbs":
            self._open = self._of_limbs(Plan(self.inputs, formulation, number, self.times, transits=False))
            return self._open
        self._worker = Worker(_proposals, self.inputs, self.times, prec)
        self._open = self._received(self._worker)
        return self._open

    @property
    def workers(self) -> int:
        """Processes that the proof may use: heyoka's run has one of its own; beside limbs one helper keeps up."""
        return min(2, os.cpu_count() or 1) if self.engine == LIMBS else 1

    def _of_limbs(self, plan: Plan) -> Iterator[Any]:
        from ..enclosure import pair
        from ..engines import limbs

        bits = plan.number.prec + GUARD_BITS

        def chain() -> Iterator[limbs.LimbsTaylorStep]:
            self._done = yield from limbs.taylor_steps(plan, round(ORDER_PER_BIT * bits))

        return pair(chain())

    def finished(self) -> Run:
        """What the last run computed at `times`."""
        for _ in self._open:
            pass
        if self._done is None:
            raise IntegrationError("heyoka's process ended without its states.")
        return self._done

    def _received(self, worker: Worker) -> Iterator[Any]:
        for item in worker:
            if isinstance(item, Run):
                self._done = item
            else:
                yield from item

    def stop(self) -> None:
        """End the process."""
        if self._worker is not None:
            self._worker.stop()


def expand(inputs: Inputs, times: tuple[Fraction, ...], prec: int) -> Generator[Polynomials, None, Run]:
    """The polynomials of a run at `prec` bits from t = 0 to one step beyond the last time; returns its `Run`."""
    from ..engines.heyoka import stepper as taylor

    plan = Plan(inputs, "momentum", real(prec), times, transits=False)
    ctx, k, n, v = start_of(inputs, plan.number)
    stepper = taylor.Stepper(FORMULATIONS["momentum"], k, n, v, ctx, plan.number)
    grid = [stepper.numbers.of(t) for t in times]
    begun = time.process_time()
    rate = max(float(ctx.sqrt(ctx.norm(k.pull))), float(k.drag) / DECAYS)
    most = _short(MOST_TURN / rate) if rate > 0 else max(times[-1], Fraction(1))
    states, limit, ahead = [stepper.state], stepper.numbers.of(most), False
    while not ahead:
        ahead = stepper.time > grid[-1]
        step = stepper.expand(limit, prec + GUARD_BITS)
        yield step
        while len(states) < len(grid) and grid[len(states)] <= stepper.time:
            states.append(stepper.sample(grid[len(states)]))
        limit = stepper.numbers.of(min(_next_step(step, stepper.order), most))
    return result(plan, stepper, np.array(states, dtype=stepper.numbers.dtype), None, begun)


def _next_step(step: Polynomials, order: int) -> Fraction:
    """About the step that heyoka's rule would take next (its own choice limits it anyway), with a short mantissa.

    The rule: h = ρ exp(-2 - 0.7/(p - 1)), ρ the smaller of |c_k|^(-1/k) of the last two orders.
    """
    reach = min(-step.log2_largest(k) / k for k in (order - 1, order)) - (2 + 0.7 / (order - 1)) * math.log2(math.e)
    return _short(float(step.h) * 2**reach * SHRINK)


def _short(h: float) -> Fraction:
    """A little less than h, with few bits."""
    mantissa, exponent = math.frexp(h)
    return Fraction(int(mantissa * 2**STEP_BITS)) * Fraction(2) ** (exponent - STEP_BITS)


def _proposals(emit: Emit, inputs: Inputs, times: tuple[Fraction, ...], prec: int) -> None:
    from ..enclosure import pair, turned

    done: list[Run] = []

    def chain() -> Iterator[Polynomials]:
        done.append((yield from expand(inputs, times, prec)))

    steps = pair(turned(inputs, chain()))
    while batch := list(islice(steps, BATCH)):
        emit(batch)
    emit(done[0])
