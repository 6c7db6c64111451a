"""Conversions between exact numbers and the number types of heyoka."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from mpmath.libmp import from_rational

from ...errors import IntegrationError
from ...numbers.precision import DOUBLE, LONG_DOUBLE, Array, NumberType, to_fraction
from .library import hy
from .system import keep_on_disk

# Optimised code takes 0.1 to 1 s longer to compile. In hardware numbers a step is then 1 to 10 µs
# faster, with other last bits; beyond them a sixth faster, with the same bits, and steps take
# longer the more bits they have. So a run of fewer radians than these is compiled quickly.
# (Compiling `lagrangian`, which is much longer, takes 3 to 10 s, and a step is 30 to 100 µs
# faster.) Levels above 1 give no faster step.
_SHORT_RUN = 20_000  # in hardware numbers
_SHORT_WORK = 4e9  # beyond them: times the cube of the bits
_KEPT = 24  # integrators, of 1 to 5 MB each, that are kept for further runs of their equations
# type of numbers, and that of arrays
_HARDWARE: dict[NumberType, Any] = {
    DOUBLE: (float, np.float64),
    LONG_DOUBLE: (np.longdouble, np.longdouble),
}


class Numbers:
    """Conversions between exact numbers and one of heyoka's number types."""

    def __init__(self, number: NumberType) -> None:
        self.number = number
        self.type, self.dtype = _HARDWARE.get(number, (hy.real, hy.real))
        self.keywords: dict[str, Any] = {} if number.hardware else {"prec": number.prec}

    def of(self, value: Any) -> Any:
        """Return the nearest number of the type to an mpf, or to a number of Python or numpy."""
        is_float = isinstance(value, float | np.floating)
        if is_float and self.number.hardware and np.isfinite(value):
            return self.type(value)
        exact = value if isinstance(value, int | Fraction) else to_fraction(value)
        if self.number == DOUBLE:
            return exact.numerator / exact.denominator

        prec = self.number.prec
        sign, mantissa, shift, _ = from_rational(exact.numerator, exact.denominator, prec, "n")
        rounded = -int(mantissa) if sign else int(mantissa)
        if self.number.hardware:
            # a mantissa of 64 bits, from two halves that are exact
            high = rounded >> 32 << 32
            return np.ldexp(np.longdouble(high) + np.longdouble(rounded - high), shift)
        # the power's exponent has 64 bits, so that the product's precision would be 64 at least
        return hy.real(hy.real(rounded, prec) * hy.real(2, prec) ** shift, prec)

    def all_of(self, values: Sequence[Any] | Array) -> Any:
        """Return each value as a number of the type; doubles for doubles are taken as they are."""
        are_doubles = getattr(values, "dtype", None) == np.float64
        if are_doubles and self.number == DOUBLE and np.isfinite(values).all():
            return values
        return [self.of(value) for value in values]

    def power_of_two(self, exponent: int) -> Any:
        """Return 2**exponent, exactly."""
        return self.of(Fraction(2) ** exponent)

    def fixed(self, values: Any, bits: int) -> list[int]:
        """Return each number of an array as an integer over 2**bits, truncated towards zero."""
        return [int(value) for value in (values * self.power_of_two(bits)).ravel()]

    def integrator(
        self, system: Any, state: Sequence[Any], *, radians: float = math.inf, **options: Any
    ) -> Any:
        """Return heyoka's integrator of a system of pairs (variable, rate).

        It is compiled unless an equal one was before.

        Args:
            system: the pairs.
            state: values of the first variables; the others are 0.
            radians: how far the run goes, by which compiling is thorough or quick.
            options: those of `_compiled`. `events` are expressions, each with the function that is
                called where it is zero; integrators that share the code share these functions.
        """
        short = _SHORT_RUN if self.number.hardware else _SHORT_WORK / self.number.prec**3
        options["opt_level"] = int(radians >= short)
        integrator = copy(_compiled(self.number, tuple(system), **options))
        integrator.state[: len(state)] = np.array(state, self.dtype)
        return integrator

    def propagated(self, integrator: Any, times: Sequence[Any], **options: Any) -> tuple[Any, int]:
        """Return the states of an integrator at increasing times from its own on, and its steps.

        Raises:
            IntegrationError: it stopped before the last time, or a state is not finite.
        """
        if len(times) == 1:
            return integrator.state.copy()[None, :], 0
        grid = np.array(times, dtype=self.dtype)
        outcome, _, _, steps, _, states = integrator.propagate_grid(grid, **options)
        if outcome == hy.taylor_outcome.err_nf_state or not np.isfinite(states.astype(float)).all():
            raise IntegrationError("the state became infinite or NaN.")
        if outcome != hy.taylor_outcome.time_limit or len(states) != len(times):
            reached = f"{float(integrator.time)} s, after {steps} steps"
            raise IntegrationError(f"heyoka stopped at t = {reached}, with outcome {outcome}.")
        return states, int(steps)


@lru_cache(maxsize=_KEPT)
def _compiled(
    number: NumberType, system: Any, varied: bool = False, events: Any = (), **options: Any
) -> Any:
    """Return an integrator that begins at zero; a copy shares its code, and takes a millisecond."""
    keep_on_disk(number)
    numbers = Numbers(number)
    pairs = list(system)
    if "tol" in options:
        options["tol"] = numbers.of(options["tol"])
    options["nt_events"] = [
        hy.nt_event(zero, callback=call, fp_type=numbers.type) for zero, call in events
    ]
    equations = hy.var_ode_sys(pairs, [hy.par[0]], order=1) if varied else pairs
    zeros = np.array([numbers.of(0)] * len(pairs), numbers.dtype)
    return hy.taylor_adaptive(equations, zeros, fp_type=numbers.type, **numbers.keywords, **options)
