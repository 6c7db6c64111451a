"""heyoka's integrator of any autonomous system: no events, but parameters and variational equations."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import heyoka as hy
import numpy as np

from ...numbers.precision import NumberType
from .machine_code import keep_on_disk
from .numbers import Numbers
from .system import as_pairs


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
