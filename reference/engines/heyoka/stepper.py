"""heyoka's integrator of one scene, step by step: events, dense output, Taylor coefficients."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from ...errors import IntegrationError
from ...model.formulations import Formulation
from ...model.start import Start
from ...numbers.precision import NumberType
from ...system.channel import ACTIVITY
from ..plan import Pace, Report
from .library import hy
from .model import RoundedModel
from .system import system_of

_STEPS_PER_REPORT = 64  # steps between two reports of progress
# a time, two numbers of the type, is read exactly with this many bits beyond twice the precision
_TIME_BITS = 64


class Zero(NamedTuple):
    """A zero of xdot: time, sign of the crossing, state; in numbers of the run's type."""

    t: Any
    direction: int
    state: Any


# `zeros` of the stepper that takes a step: integrators of one system share a callback
_at_work = threading.local()


def _record(integrator: Any, t: Any, direction: int) -> None:
    integrator.update_d_output(t)
    _at_work.zeros.append(Zero(t, int(direction), integrator.d_output.copy()))


class Stepper:
    """heyoka's integrator of a scene, one step at a time.

    It has dense output, and finds the zeros of xdot in each step.

    Args:
        formulation: the formulation to integrate.
        start: constants and release, in a precision finer than the run's.
        number: type to compute in.
        events: whether to detect the zeros of xdot.
        span: time in s that will be integrated, by which compiling is thorough or quick.
        longest: longest step in s; heyoka's own choice if None.
    """

    def __init__(
        self,
        formulation: Formulation,
        start: Start,
        number: NumberType,
        *,
        events: bool = False,
        span: Fraction | float = math.inf,
        longest: Fraction | None = None,
    ) -> None:
        self.number = number
        self.model = RoundedModel(formulation, start.k, number)
        self.numbers = self.model.numbers
        self.zeros: list[Zero] = []
        self.steps = 0
        self._longest = None if longest is None else self.numbers.of(longest)
        equations, xdot = system_of(formulation, self.model.symbols)
        ACTIVITY.send("compiling")
        started = time.process_time()
        self._ta = self.numbers.integrator(
            equations,
            self.model.release(start),
            radians=float(span) * start.rate,
            events=((xdot, _record),) if events else (),
        )
        self._ta.pars[:] = self.model.parameters[: len(self._ta.pars)]
        self.compile_s = time.process_time() - started
        ACTIVITY.send("integrating")
        self.order = int(self._ta.order)
        self._powers: tuple[Any, Any] = (None, None)

    @property
    def time(self) -> Any:
        """Time reached, in s, as a number of the run's type."""
        return self._ta.time

    @property
    def state(self) -> Any:
        """State reached (a copy)."""
        return self._ta.state.copy()

    def advance(self, limit: Any) -> None:
        """Take one step, at most `limit` seconds long; `zeros` then holds the zeros of xdot in it.

        Raises:
            IntegrationError: heyoka reports a failure, or the state is not finite.
        """
        self.zeros.clear()
        _at_work.zeros = self.zeros
        if self._longest is not None:
            limit = min(limit, self._longest)
        outcome, _ = self._ta.step(limit)
        self._count_step(outcome)

    def _count_step(self, outcome: Any) -> None:
        """Count a step, or raise if it failed."""
        if outcome not in (hy.taylor_outcome.success, hy.taylor_outcome.time_limit):
            raise IntegrationError(
                f"heyoka stopped at t = {float(self.time)} s with outcome {outcome}."
            )
        if not all(map(math.isfinite, self._ta.state.astype(float).tolist())):
            raise IntegrationError(f"the state is not finite at t = {float(self.time)} s.")
        self.steps += 1

    def sample(self, times: Sequence[Any], states: list[Any]) -> None:
        """Append the states at those of the times that the last step has passed.

        They come from dense output; `states` has one for each time passed before.
        """
        while len(states) < len(times) and times[len(states)] <= self.time:
            self._ta.update_d_output(times[len(states)])
            states.append(self._ta.d_output.copy())

    def mark(self) -> tuple[Any, Any]:
        """Return the time and state reached, for `back`."""
        return self._ta.time, self._ta.state.copy()

    def back(self, mark: tuple[Any, Any]) -> None:
        """Return to a mark, and forget the zeros found since."""
        self._ta.time, self._ta.state[:] = mark
        self.zeros.clear()

    def last_of_x(self) -> tuple[Any, Any]:
        """Return the Taylor coefficients of the first variable in the last step, and its length."""
        return self._ta.tc[0].copy(), self._ta.last_h

    def coefficients(self) -> tuple[Any, Any]:
        """Return the Taylor coefficients of every variable, and heyoka's step size.

        The coefficients have the shape (variables, order + 1).

        The stepper goes back to where it was.
        """
        start = self.mark()
        _at_work.zeros = self.zeros
        _, h = self._ta.step(write_tc=True)
        coefficients = np.array(self._ta.tc)
        self.back(start)
        return coefficients, h

    def expand(self, limit: Any, bits: int) -> tuple[Fraction, Fraction, Any]:
        """Take one step, at most `limit` seconds long; return its start, length and series.

        Start and length in s are exact.

        The series, of s = (time - start)/length, is that of `momentum`: n, and length times H, each
        times 2**bits and not yet integer, shape (6, order + 1).
        """
        start = self._exact_time()
        outcome, _ = self._ta.step(limit, True)
        self._count_step(outcome)
        h = self._exact_time() - start
        if (h, bits) != self._powers[0]:
            self._powers = ((h, bits), self._row_powers(h, bits))
        return start, h, self._ta.tc * self._powers[1]

    def _row_powers(self, h: Fraction, bits: int) -> Any:
        """Return h**k 2**bits for the coefficients of n, h**(k+1) 2**bits for those of H.

        Shape (6, order + 1).
        """
        factors = [self.numbers.power_of_two(bits), *[self.numbers.of(h)] * (self.order + 1)]
        powers = np.cumprod(factors)
        half = len(self._ta.state) // 2
        return np.array([powers[:-1]] * half + [powers[1:]] * half)

    def _exact_time(self) -> Fraction:
        bits = 2 * self.number.prec + _TIME_BITS
        high, low = self.numbers.fixed(np.array(self._ta.dtime), bits)
        return Fraction(high + low, 1 << bits)

    def propagate(
        self, times: Sequence[Any], report: Report | None = None, pace: Pace | None = None
    ) -> Any:
        """Return the states at increasing times from the one reached; not with events.

        Shape (times, variables).
        """
        count = 0

        def progress(integrator: Any) -> bool:
            nonlocal count
            count += 1
            if count % _STEPS_PER_REPORT == 0:
                t = float(integrator.time)
                if pace is not None:
                    pace(count, t)
                if report is not None:
                    report(t)
            return True

        options: dict[str, Any] = {}
        if report or pace:
            options["callback"] = progress
        if self._longest is not None:
            options["max_delta_t"] = self._longest
        states, steps = self.numbers.propagated(self._ta, times, **options)
        self.steps += steps
        return states
