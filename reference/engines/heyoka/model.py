"""heyoka's integrator of any system, without events; the model in it: a formulation with a scene's constants."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import heyoka as hy
import numpy as np

from ...model.constants import Constants
from ...model.force import acceleration
from ...model.formulations import Formulation
from ...model.start import Start
from ...numbers.columns import RUN
from ...numbers.precision import Array, NumberType
from ...numbers.table import Table
from .numbers import Numbers
from .system import as_pairs, keep_on_disk, rates


class Propagator:
    """A plain propagator for systems without events: any autonomous system, written for any number type.

    Args:
        variables: names of the state's variables.
        derivatives: `derivatives(state, functions)` or, with parameters, `derivatives(state, functions, parameters)`;
            `functions` offers sqrt, sin, cos.
        number: type to compute in.
        tolerance: relative error of a step; the type's epsilon if None.
        parameters: number of parameters.
        varied: whether the derivative of the state with respect to the first parameter is integrated as well, by
            the first-order variational equations.
    """

    def __init__(
        self,
        variables: Sequence[str],
        derivatives: Callable[..., Sequence[Any]],
        number: NumberType,
        *,
        tolerance: float | None = None,
        parameters: int = 0,
        varied: bool = False,
    ) -> None:
        self.numbers = Numbers(number)
        state = [hy.expression(name) for name in variables]
        extra = ([hy.par[i] for i in range(parameters)],) if parameters else ()
        system: Any = as_pairs(state, derivatives(tuple(state), hy, *extra))
        if varied:
            system = hy.var_ode_sys(system, [hy.par[0]], order=1)
        keywords = dict(self.numbers.keywords)
        if tolerance is not None:
            keywords["tol"] = self.numbers.of(Fraction(tolerance))
        started = time.process_time()
        zeros = np.array([self.numbers.of(0)] * len(state), dtype=self.numbers.dtype)
        keep_on_disk(number)
        self._ta: Any = hy.taylor_adaptive(system, zeros, fp_type=self.numbers.type, **keywords)
        self.compile_s = time.process_time() - started
        self.steps = 0

    def from_zero(self, start: Sequence[Any], times: Any, parameters: Sequence[Any] = (), max_steps: int = 0) -> Any:
        """Return the states at increasing times (the first is 0), shape (times, variables).

        With variational equations, `start` holds the state and then its derivative with respect to the first
        parameter, and so does each row.

        Raises:
            IntegrationError: heyoka stops before the last time, also because `max_steps` (0: any number) do not
                suffice, or a state is not finite.
        """
        ta = self._ta
        ta.time = self.numbers.of(0)
        ta.state[:] = start
        if len(parameters):
            ta.pars[:] = parameters
        if len(times) == 1:
            return ta.state.copy()[None, :]
        states, steps = self.numbers.propagated(ta, times, max_steps=max_steps)
        self.steps += steps
        return states


class RoundedModel:
    """A formulation of the equations of motion, with constants rounded once to a number type.

    Args:
        formulation: the formulation.
        k: the constants, finer than the number type.
        number: type to compute in.
    """

    def __init__(self, formulation: Formulation, k: Constants, number: NumberType) -> None:
        self.formulation, self.numbers = formulation, Numbers(number)
        self.k = k.converted(self.numbers.of)

    def release(self, start: Start) -> list[Any]:
        """Return the state at t = 0, in numbers of the type."""
        return [self.numbers.of(value) for value in start.state(self.formulation)]

    def propagator(self, tolerance: float | None = None) -> Propagator:
        """Compile the equations, without events; the tolerance is the type's epsilon if None."""
        equations = rates(self.formulation, self.k)
        return Propagator(self.formulation.variables, equations, self.numbers.number, tolerance=tolerance)

    def columns(self, states: Any) -> list[Any]:
        """Return x, y, z in m and vx, vy, vz in m/s, each of shape (rows,), from states of shape (rows, variables)."""
        n, v = self._cartesian(states)
        return [np.broadcast_to(part * self.k.length, len(states)) for part in (*n, *v)]

    def doubles(self, states: Any) -> Array:
        """Return the same as the nearest doubles, shape (rows, 6)."""
        return np.array([column.astype(np.float64) for column in self.columns(states)]).T.copy()

    def table(self, states: Any, bits: int) -> Table:
        """Return `columns.RUN` over 2**bits, exactly as computed, from states of shape (rows, variables)."""
        if len(states) == 0:
            return Table(RUN, bits, [])
        n, v = self._cartesian(states)
        ax = acceleration(n, v, self.k)[0]
        fixed = [self.numbers.fixed(np.asarray(column) * self.k.length, bits) for column in (*n, *v, ax)]
        return Table(RUN, bits, list(zip(*fixed, strict=True)))

    def _cartesian(self, states: Any) -> Any:
        return self.formulation.cartesian(tuple(np.ascontiguousarray(states.T)), self.k, np)
