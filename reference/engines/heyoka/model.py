"""heyoka's number types, with exact conversions; its integrator of any system, without events; the model in it.

The modules that make heyoka's arrays import this one, so that its memory handler is installed: without it arrays of
`real` leak.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import copy
from fractions import Fraction
from functools import lru_cache
from numbers import Real
from typing import Any

import heyoka as hy
import numpy as np
from mpmath.libmp import from_rational

from ...errors import InputError, IntegrationError
from ...model.constants import Constants
from ...model.force import acceleration
from ...model.formulations import Formulation
from ...model.start import Start
from ...numbers.columns import RUN
from ...numbers.precision import DOUBLE, LONG_DOUBLE, Array, NumberType, to_fraction
from ...numbers.table import Table
from .system import as_pairs, keep_on_disk, rates

hy.install_custom_numpy_mem_handler()
hy.set_logger_level_critical()  # its log is the process's stdout; what it would tell of lost roots is found otherwise

# Optimised code takes 0.1 to 1 s longer to compile. A step in hardware numbers is then 1 to 10 µs faster, with other
# last bits; one beyond them a sixth, with the same bits, and steps take the longer the more bits they have. So a run of
# fewer radians than these is compiled quickly. (In `lagrangian`, which is much longer, it takes 3 to 10 s, and a step
# is 30 to 100 µs faster.) Levels above 1 give no faster step.
SHORT_RUN = 20_000  # in hardware numbers
SHORT_WORK = 4e9  # beyond them: times the cube of the bits
KEPT = 24  # integrators, of 1 to 5 MB each, that are kept for further runs of their equations

# type, and that of arrays
_HARDWARE: dict[NumberType, Any] = {DOUBLE: (float, np.float64), LONG_DOUBLE: (np.longdouble, np.longdouble)}


def compiled(variables: Sequence[str], parameters: int, change: Callable[..., Sequence[Any]]) -> Any:
    """Return a map of doubles as machine code, called with an array of states and `pars`.

    Args:
        variables: names of a state's numbers.
        parameters: how many there are.
        change: `change(state, parameters)` returns the next state.
    """
    state = list(hy.make_vars(*variables))
    return hy.cfunc(change(state, [hy.par[i] for i in range(parameters)]), state)


class Numbers:
    """Conversions between exact numbers and one of heyoka's number types."""

    def __init__(self, number: NumberType) -> None:
        self.number = number
        self.type, self.dtype = _HARDWARE.get(number, (hy.real, hy.real))
        self.keywords: dict[str, Any] = {} if number.hardware else {"prec": number.prec}

    def of(self, value: Any) -> Any:
        """Return the number of the type that is nearest to an mpf, or a number of Python's or numpy's types."""
        if isinstance(value, float | np.floating) and self.number.hardware and np.isfinite(value):
            return self.type(value)
        exact = value if isinstance(value, int | Fraction) else to_fraction(value)
        if self.number == DOUBLE:
            return exact.numerator / exact.denominator
        sign, mantissa, shift, _ = from_rational(exact.numerator, exact.denominator, self.number.prec, "n")
        rounded = -int(mantissa) if sign else int(mantissa)
        if not self.number.hardware:
            prec = self.number.prec  # of a product with a power, whose exponent has 64 bits, it would be 64 at least
            return hy.real(hy.real(rounded, prec) * hy.real(2, prec) ** shift, prec)
        high = rounded >> 32 << 32
        return np.ldexp(np.longdouble(high) + np.longdouble(rounded - high), shift)

    def all_of(self, values: Sequence[Any] | Array) -> Any:
        """Return each value as a number of the type; doubles that are wanted as doubles are taken as they are."""
        if self.number == DOUBLE and getattr(values, "dtype", None) == np.float64 and np.isfinite(values).all():
            return values
        return [self.of(value) for value in values]

    def power_of_two(self, exponent: int) -> Any:
        """Return 2**exponent, exactly."""
        return self.of(Fraction(2) ** exponent)

    def fixed(self, values: Any, bits: int) -> list[int]:
        """Return each number of an array as an integer over 2**bits, cut off towards zero."""
        return [int(value) for value in (values * self.power_of_two(bits)).ravel()]

    def integrator(self, system: Any, state: Sequence[Any], *, radians: float = math.inf, **options: Any) -> Any:
        """Return heyoka's integrator of a system of pairs (variable, rate), compiled unless it was so before.

        `radians` is how far the run goes, by which compiling is thorough or quick; `events` are expressions, each with
        the function that is called where it is zero, which all that share the code have in common.
        """
        short = SHORT_RUN if self.number.hardware else SHORT_WORK / self.number.prec**3
        options["opt_level"] = int(radians >= short)
        integrator = copy(_compiled(self.number, tuple(system), **options))
        integrator.state[: len(state)] = np.array(state, self.dtype)
        return integrator

    def propagated(self, integrator: Any, times: Sequence[Any], **options: Any) -> tuple[Any, int]:
        """Return the states of a heyoka integrator at increasing times from its own on, and the number of steps.

        Raises:
            IntegrationError: it stopped before the last time, or a state is not finite.
        """
        if len(times) == 1:
            return integrator.state.copy()[None, :], 0
        grid = np.array(times, dtype=self.dtype)
        outcome, _, _, steps, _, states = integrator.propagate_grid(grid, **options)
        if outcome == hy.taylor_outcome.err_nf_state or not np.isfinite(states.astype(float)).all():
            raise IntegrationError("the state became infinite or not a number.")
        if outcome != hy.taylor_outcome.time_limit or len(states) != len(times):
            reached = f"{float(integrator.time)} s, after {steps} steps"
            raise IntegrationError(f"heyoka stopped at t = {reached}, with outcome {outcome}.")
        return states, int(steps)


@lru_cache(maxsize=KEPT)
def _compiled(number: NumberType, system: Any, varied: bool = False, events: Any = (), **options: Any) -> Any:
    """Return an integrator that begins at zero; a copy of it shares its code, and takes a millisecond."""
    keep_on_disk(number)
    numbers, pairs = Numbers(number), list(system)
    if "tol" in options:
        options["tol"] = numbers.of(options["tol"])
    options["nt_events"] = [hy.nt_event(zero, callback=call, fp_type=numbers.type) for zero, call in events]
    equations = hy.var_ode_sys(pairs, [hy.par[0]], order=1) if varied else pairs
    zero = np.array([numbers.of(0)] * len(pairs), numbers.dtype)
    return hy.taylor_adaptive(equations, zero, fp_type=numbers.type, **numbers.keywords, **options)


class Propagator:
    """A plain propagator for systems without events: any autonomous system, written for any number type.

    Args:
        variables: names of the state's variables.
        derivatives: `derivatives(state, functions)` or, with parameters, `derivatives(state, functions, parameters)`;
            `functions` offers sqrt, sin, cos.
        number: type to compute in.
        tolerance: relative error of a step; the type's epsilon if None.
        parameters: number of parameters.
        radians: how far a run goes, by which compiling is thorough or quick.
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
        radians: float = math.inf,
        varied: bool = False,
    ) -> None:
        self.numbers = Numbers(number)
        state = [hy.expression(name) for name in variables]
        extra = ([hy.par[i] for i in range(parameters)],) if parameters else ()
        system = as_pairs(state, derivatives(tuple(state), hy, *extra))
        options: dict[str, Any] = {"radians": radians, "varied": varied}
        if tolerance is not None:
            if not (isinstance(tolerance, Real) and 0 < tolerance < 1):
                raise InputError("tolerance", tolerance, "a relative error between 0 and 1")
            options["tol"] = Fraction(tolerance)
        self._ta = self.numbers.integrator(system, [], **options)
        self.parameters: Sequence[Any] = ()  # where none are given
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
        ta.pars[:] = parameters or self.parameters[: len(ta.pars)]
        states, steps = self.numbers.propagated(ta, times, max_steps=max_steps)
        self.steps += steps
        return states


class RoundedModel:
    """A formulation of the equations of motion, with constants rounded once to a number type.

    Args:
        formulation: the formulation.
        k: the constants, finer than the number type.
        number: type to compute in.

    Attributes:
        k: the constants in that type.
        symbols: heyoka's parameters in their place: scenes with the same exact zeros share the code of their equations.
        parameters: the values of these parameters, and then of constants that the equations do not have.
    """

    def __init__(self, formulation: Formulation, k: Constants, number: NumberType) -> None:
        self.formulation, self.numbers = formulation, Numbers(number)
        self.k = k.converted(self.numbers.of)
        entries = self.k.entries()
        self.symbols = Constants.of({name: hy.par[i] for i, name in enumerate(entries)})
        self.parameters = [*entries.values()]

    def release(self, start: Start) -> list[Any]:
        """Return the state at t = 0, in numbers of the type."""
        return [self.numbers.of(value) for value in start.state(self.formulation)]

    def propagator(self, tolerance: float | None = None, radians: float = math.inf) -> Propagator:
        """Compile the equations, without events; the tolerance is the type's epsilon if None."""
        variables, equations = self.formulation.variables, rates(self.formulation, self.symbols)
        made = Propagator(variables, equations, self.numbers.number, tolerance=tolerance, radians=radians)
        made.parameters = self.parameters
        return made

    def doubles(self, states: Any) -> Array:
        """Return x, y, z in m and vx, vy, vz in m/s, nearest doubles, from states of shape (rows, variables)."""
        n, v = self._cartesian(states)
        columns = [np.broadcast_to(part * self.k.length, len(states)) for part in (*n, *v)]
        return np.array([column.astype(np.float64) for column in columns]).T.copy()

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
