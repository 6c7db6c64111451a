"""Any autonomous system integrated by heyoka, without events; maps of doubles as machine code."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from numbers import Real
from typing import Any

from ...errors import InputError
from ...numbers.precision import NumberType
from .conversions import Numbers
from .library import hy
from .system import as_pairs


def compiled(
    variables: Sequence[str], parameters: int, change: Callable[..., Sequence[Any]]
) -> Any:
    """Return a map of doubles as machine code, called with an array of states and `pars`.

    Args:
        variables: names of a state's numbers.
        parameters: how many there are.
        change: `change(state, parameters)` returns the next state.
    """
    state = list(hy.make_vars(*variables))
    symbols = [hy.par[i] for i in range(parameters)]
    return hy.cfunc(change(state, symbols), state)


@dataclass(frozen=True)
class AutonomousSystem:
    """A system of equations y' = f(y), written for any number type.

    Attributes:
        variables: names of the state's variables.
        derivatives: `derivatives(state, functions)` or, with parameters, `derivatives(state,
            functions, parameters)`; `functions` offers sqrt, sin, cos.
        parameters: number of parameters.
        varied: whether the derivative of the state with respect to the first parameter is
            integrated as well, by the first-order variational equations.
    """

    variables: Sequence[str]
    derivatives: Callable[..., Sequence[Any]]
    parameters: int = 0
    varied: bool = False

    def equations(self) -> list[tuple[Any, Any]]:
        """Return the pairs (variable, rate), as heyoka's expressions."""
        state = [hy.expression(name) for name in self.variables]
        if self.parameters:
            parameters = [hy.par[i] for i in range(self.parameters)]
            return as_pairs(state, self.derivatives(tuple(state), hy, parameters))
        return as_pairs(state, self.derivatives(tuple(state), hy))


class Propagator:
    """A propagator for systems without events.

    Args:
        system: the equations.
        number: type to compute in.
        tolerance: relative error of a step; the type's epsilon if None.
        radians: how far a run goes, by which compiling is thorough or quick.
    """

    def __init__(
        self,
        system: AutonomousSystem,
        number: NumberType,
        *,
        tolerance: float | None = None,
        radians: float = math.inf,
    ) -> None:
        self.numbers = Numbers(number)
        self.parameters: Sequence[Any] = ()  # where a run is given none
        self.steps = 0
        equations = system.equations()
        options: dict[str, Any] = {"radians": radians, "varied": system.varied}
        if tolerance is not None:
            if not (isinstance(tolerance, Real) and 0 < tolerance < 1):
                raise InputError("tolerance", tolerance, "a relative error between 0 and 1")
            options["tol"] = Fraction(tolerance)
        self._ta = self.numbers.integrator(equations, [], **options)

    def from_zero(
        self, start: Sequence[Any], times: Any, parameters: Sequence[Any] = (), max_steps: int = 0
    ) -> Any:
        """Return the states at increasing times (the first is 0), shape (times, variables).

        With variational equations, `start` holds the state and then its derivative with respect to
        the first parameter, and so does each row.

        Raises:
            IntegrationError: heyoka stops before the last time, also because `max_steps` (0: any
                number) do not suffice, or a state is not finite.
        """
        ta = self._ta
        ta.time = self.numbers.of(0)
        ta.state[:] = start
        ta.pars[:] = parameters or self.parameters[: len(ta.pars)]
        states, steps = self.numbers.propagated(ta, times, max_steps=max_steps)
        self.steps += steps
        return states
