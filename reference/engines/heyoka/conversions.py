"""Conversions between exact numbers and the number types of heyoka."""

from __future__ import annotations

import math
from collections.abc import Sequence
from copy import copy
from fractions import Fraction
from functools import lru_cache
from typing import Any

import heyoka as hy
import numpy as np
from mpmath.libmp import from_rational

from ...errors import IntegrationError
from ...numbers.precision import DOUBLE, LONG_DOUBLE, Array, NumberType, to_fraction
from .system import keep_on_disk

# Optimised code takes 0.1 to 1 s longer to compile. A step in hardware numbers is then 1 to 10 µs faster, with other
# last bits; one beyond them a sixth, with the same bits, and steps take the longer the more bits they have. So a run of
# fewer radians than these is compiled quickly. (In `lagrangian`, which is much longer, it takes 3 to 10 s, and a step
# is 30 to 100 µs faster.) Levels above 1 give no faster step.
SHORT_RUN = 20_000  # in hardware numbers
SHORT_WORK = 4e9  # beyond them: times the cube of the bits
KEPT = 24  # integrators, of 1 to 5 MB each, that are kept for further runs of their equations
# type, and that of arrays
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
        """Return the number of the type that is nearest to an mpf, or a number of Python's or numpy's types."""
        if isinstance(value, float | np.floating) and self.number.hardware and np.isfinite(value):
            return self.type(value)
        exact = value if isinstance(value, int | Fraction) else to_fraction(value)
        if self.number == DOUBLE:
            return exact.numerator / exact.denominator
        sign, mantissa, shift, _ = from_rational(
            exact.numerator, exact.denominator, self.number.prec, "n"
        )
        rounded = -int(mantissa) if sign else int(mantissa)
        if not self.number.hardware:
            # of a product with a power, whose exponent has 64 bits, it would be 64 at least
            prec = self.number.prec
            return hy.real(hy.real(rounded, prec) * hy.real(2, prec) ** shift, prec)
        high = rounded >> 32 << 32
        return np.ldexp(np.longdouble(high) + np.longdouble(rounded - high), shift)

    def all_of(self, values: Sequence[Any] | Array) -> Any:
        """Return each value as a number of the type; doubles that are wanted as doubles are taken as they are."""
        if (
            self.number == DOUBLE
            and getattr(values, "dtype", None) == np.float64
            and np.isfinite(values).all()
        ):
            return values
        return [self.of(value) for value in values]

    def power_of_two(self, exponent: int) -> Any:
        """Return 2**exponent, exactly."""
        return self.of(Fraction(2) ** exponent)

    def fixed(self, values: Any, bits: int) -> list[int]:
        """Return each number of an array as an integer over 2**bits, cut off towards zero."""
        return [int(value) for value in (values * self.power_of_two(bits)).ravel()]

    def integrator(
        self, system: Any, state: Sequence[Any], *, radians: float = math.inf, **options: Any
    ) -> Any:
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
def _compiled(
    number: NumberType, system: Any, varied: bool = False, events: Any = (), **options: Any
) -> Any:
    """Return an integrator that begins at zero; a copy of it shares its code, and takes a millisecond."""
    keep_on_disk(number)
    numbers, pairs = Numbers(number), list(system)
    if "tol" in options:
        options["tol"] = numbers.of(options["tol"])
    options["nt_events"] = [
        hy.nt_event(zero, callback=call, fp_type=numbers.type) for zero, call in events
    ]
    equations = hy.var_ode_sys(pairs, [hy.par[0]], order=1) if varied else pairs
    zero = np.array([numbers.of(0)] * len(pairs), numbers.dtype)
    return hy.taylor_adaptive(equations, zero, fp_type=numbers.type, **numbers.keywords, **options)
