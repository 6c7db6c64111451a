"""heyoka's integrator of one scene, step by step: events, dense output, Taylor coefficients, cartesian states."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import heyoka as hy
import numpy as np

from ...errors import IntegrationError
from ...model.constants import Constants, Vector
from ...model.force import acceleration, tension
from ...model.formulations import Formulation
from ...precision import NumberType
from .numbers import Numbers
from .system import System

STEPS_PER_LOOK = 64  # how often a run reports its progress
TIME_BITS = 64  # a step's exact times are read with so many bits below twice the precision


@dataclass(frozen=True)
class Zero:
    """A zero of xdot that heyoka found: time, sign of the crossing, state; numbers of the run's type."""

    t: Any
    direction: int
    state: Any


@dataclass(frozen=True)
class Polynomials:
    """Taylor polynomials of one step of `momentum`: n and h H as polynomials of s = (time - t)/h.

    Attributes:
        t: start of the step in s, exact.
        h: its length in s, exact.
        bits: coefficients are integers over 2**bits.
        scaled: coefficients times 2**bits, not yet integers, shape (6, order + 1).
    """

    t: Fraction
    h: Fraction
    bits: int
    scaled: Any = field(repr=False)

    @property
    def coefficients(self) -> tuple[list[int], ...]:
        """Six rows of integers, lowest order first; made when asked for, which costs a sixth of a step."""
        return tuple([int(c) for c in row] for row in self.scaled)

    def log2_largest(self, order: int) -> int:
        """The power of two above the coefficients of an order."""
        return max(abs(int(c)).bit_length() for c in self.scaled[:, order]) - self.bits


class Stepper:
    """heyoka's integrator, one step at a time, with the events of the last step and dense output.

    Args:
        formulation: which equations.
        constants: the model's constants in an mpmath context finer than the run.
        n: release position over l, in the same context.
        v: release velocity over l.
        ctx: that context.
        number: type to compute in.
        events: whether to detect the zeros of xdot.
    """

    def __init__(
        self,
        formulation: Formulation,
        constants: Constants,
        n: Vector,
        v: Vector,
        ctx: Any,
        number: NumberType,
        *,
        events: bool = False,
    ) -> None:
        self.number, self.numbers, self.formulation = number, Numbers(number), formulation
        self.constants = constants.converted(self.numbers.of)
        self.found: list[Zero] = []
        self.steps = 0
        system = System.build(formulation, self.constants)
        self._variables = [name for name, _ in system.equations]
        keywords = dict(self.numbers.keywords)
        if events:
            found = self.found  # heyoka deep-copies callbacks: a function stays itself, a bound method would not

            def note(integrator: Any, t: Any, direction: int) -> None:
                integrator.update_d_output(t)
                found.append(Zero(t, int(direction), integrator.d_output.copy()))

            made = hy.nt_event(system.xdot, callback=note, fp_type=self.numbers.type)
            keywords["nt_events"] = [made]
        start = [self.numbers.of(value) for value in formulation.start(n, v, constants, ctx)]
        hy.llvm_state.set_diskcache_enabled(number.name != "real")
        begun = time.process_time()
        self._ta: Any = hy.taylor_adaptive(
            system.equations, np.array(start, dtype=self.numbers.dtype), fp_type=self.numbers.type, **keywords
        )
        if events:
            looks = [system.xdot, system.xddot]
            self._look = hy.cfunc(looks, self._variables, fp_type=self.numbers.type, **self.numbers.keywords)
        self.compile_s = time.process_time() - begun
        self.terms, self.order = len(self._ta.decomposition), int(self._ta.order)
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
        """One step, at most `limit` seconds long; its zeros of xdot are in `found` then.

        Raises:
            IntegrationError: heyoka says anything but success.
        """
        self.found.clear()
        self._checked(self._ta.step(limit)[0])

    def _checked(self, outcome: Any) -> None:
        if outcome not in (hy.taylor_outcome.success, hy.taylor_outcome.time_limit):
            raise IntegrationError(f"heyoka stopped at t = {float(self.time)} s with outcome {outcome}.")
        if not np.isfinite(self._ta.state.astype(float)).all():
            raise IntegrationError(f"the state is not finite at t = {float(self.time)} s.")
        self.steps += 1

    def sample(self, t: Any) -> Any:
        """State at a time within the last step (a copy)."""
        self._ta.update_d_output(t)
        return self._ta.d_output.copy()

    def mark(self) -> tuple[Any, Any]:
        """Where the run is, for `back`."""
        return self._ta.time, self._ta.state.copy()

    def back(self, mark: tuple[Any, Any]) -> None:
        """Return to a mark, forgetting the events found since."""
        self._ta.time, self._ta.state[:] = mark
        self.found.clear()

    def look(self, state: Any) -> tuple[float, float]:
        """Velocity and acceleration over l of the x coordinate (with events), in binary64 but with the right signs."""
        xdot, xddot = self._look(state)
        return float(xdot), float(xddot)

    def coefficients(self) -> tuple[Any, Any]:
        """Taylor coefficients at t = 0 of every variable (shape (variables, order + 1)), and a step h; stays at 0."""
        start = self.mark()
        _, h = self._ta.step(write_tc=True)
        taken = np.array(self._ta.tc)
        self.back(start)
        return taken, h

    def expand(self, limit: Any, bits: int) -> Polynomials:
        """One step, at most `limit` seconds long, with its Taylor polynomials; stays exact in time."""
        begun = self._exact_time()
        self._checked(self._ta.step(limit, True)[0])
        h = self._exact_time() - begun
        if (h, bits) != self._powers[0]:
            self._powers = ((h, bits), self._row_powers(h, bits))
        return Polynomials(begun, h, bits, self._ta.tc * self._powers[1])

    def _row_powers(self, h: Fraction, bits: int) -> Any:
        """h**k 2**bits for the coefficients of n and h**(k+1) 2**bits for those of H, shape (6, order + 1)."""
        step, powers = self.numbers.of(h), [self.numbers.power_of_two(bits)]
        for _ in range(self.order + 1):
            powers.append(powers[-1] * step)
        half = len(self._variables) // 2
        return np.array([powers[:-1]] * half + [powers[1:]] * half)

    def _exact_time(self) -> Fraction:
        bits = 2 * self.number.prec + TIME_BITS
        return Fraction(sum(self.numbers.fixed(np.array(self._ta.dtime), bits)), 1 << bits)

    def race(self, end: Any, steps: int) -> int:
        """Go on towards `end` without output or checks, at most so many steps; how many were taken."""
        outcome, _, _, taken, _, _ = self._ta.propagate_until(end, max_steps=steps)
        if outcome not in (hy.taylor_outcome.step_limit, hy.taylor_outcome.time_limit):
            raise IntegrationError(
                f"Lengths, forces or rates of the scene are too far apart for {self.number}: {outcome}."
            )
        return int(taken)

    def propagate(self, times: Sequence[Any], report: Callable[[float], None] | None = None) -> Any:
        """States at increasing times (the first is the present), shape (times, variables), without events."""
        if len(times) == 1:
            return self._ta.state.copy()[None, :]
        count = 0

        def called(integrator: Any) -> bool:
            nonlocal count
            count += 1
            if report is not None and count % STEPS_PER_LOOK == 0:
                report(float(integrator.time))
            return True

        grid = np.array(times, dtype=self.numbers.dtype)
        keywords = {} if report is None else {"callback": called}
        outcome, _, _, steps, _, states = self._ta.propagate_grid(grid, **keywords)
        self.steps += int(steps)
        if outcome != hy.taylor_outcome.time_limit or len(states) != len(times):
            raise IntegrationError(f"heyoka stopped at t = {float(self.time)} s with outcome {outcome}.")
        if not np.isfinite(states.astype(float)).all():
            raise IntegrationError("the state became infinite or not a number.")
        return states


@dataclass(frozen=True)
class Samples:
    """States in cartesian coordinates, as integers over 2**bits: exact values of what a run computed.

    Attributes:
        rows: per time x, y, z (m), vx, vy, vz (m/s) and ax (m/s²).
    """

    bits: int
    rows: list[tuple[int, ...]] = field(repr=False)


def cartesian(stepper: Stepper, states: Any, bits: int) -> Samples:
    """x, y, z, vx, vy, vz, ax of states of shape (rows, variables), in SI units."""
    if len(states) == 0:
        return Samples(bits, [])
    columns = tuple(np.ascontiguousarray(states.T))
    n, v = stepper.formulation.cartesian(columns, stepper.constants, np)
    ax = acceleration(n, v, stepper.constants)[0]
    length = stepper.constants.length
    fixed = [stepper.numbers.fixed(np.asarray(column) * length, bits) for column in (*n, *v, ax)]
    return Samples(bits, list(zip(*fixed, strict=True)))


def least_tension(stepper: Stepper, states: Any) -> float:
    """The least pull of the cord, v·v + n·F in 1/s², over states of shape (rows, variables)."""
    columns = tuple(np.ascontiguousarray(states.T))
    n, v = stepper.formulation.cartesian(columns, stepper.constants, np)
    pull = tension(n, v, stepper.constants)
    return float(np.min(np.asarray(pull).astype(float)))
