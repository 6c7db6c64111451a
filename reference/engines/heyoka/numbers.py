"""heyoka's number types, and exact conversions to and from them.

The modules that make heyoka's arrays, `stepper` and `propagator`, import this one, so that its memory handler is
installed: without it arrays of `real` leak.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import heyoka as hy
import numpy as np

from ...errors import IntegrationError
from ...numbers.precision import DOUBLE, LONG_DOUBLE, Array, NumberType

hy.install_custom_numpy_mem_handler()
hy.set_logger_level_critical()  # its log is the process's stdout; what it would tell of lost roots is found otherwise

_HARDWARE = {DOUBLE: (float, np.float64), LONG_DOUBLE: (np.longdouble, np.longdouble)}  # type, and that of arrays


class Numbers:
    """Conversions between exact numbers and one of heyoka's number types."""

    def __init__(self, number: NumberType) -> None:
        self.number = number
        self.type: Any
        self.dtype: Any
        self.type, self.dtype = _HARDWARE.get(number, (hy.real, hy.real))
        self.keywords: dict[str, Any] = {} if number.hardware else {"prec": number.prec}
        self._twos: dict[int, Any] = {}

    def of(self, value: Any) -> Any:
        """Return the number of the type that is nearest to an mpf, int, Fraction or float."""
        if isinstance(value, float | np.floating):
            if self.number.hardware and np.isfinite(value):
                return self.type(value)
            value = Fraction(*value.as_integer_ratio())
        if isinstance(value, int | Fraction):
            top, bottom = value.numerator, value.denominator
        else:
            sign, mantissa, exponent, _ = value._mpf_
            mantissa = -int(mantissa) if sign else int(mantissa)
            top, bottom = (mantissa << exponent, 1) if exponent >= 0 else (mantissa, 1 << -exponent)
        if self.number == DOUBLE:
            return top / bottom
        rounded, shift = _rounded(top, bottom, self.number.prec)
        if not self.number.hardware:
            return hy.real(rounded, self.number.prec) * hy.real(2, self.number.prec) ** shift
        high = rounded >> 32 << 32
        return np.ldexp(np.longdouble(high) + np.longdouble(rounded - high), shift)

    def all_of(self, values: Sequence[Any] | Array) -> Any:
        """Return each value as a number of the type; doubles that are wanted as doubles are taken as they are."""
        if self.number == DOUBLE and getattr(values, "dtype", None) == np.float64 and np.isfinite(values).all():
            return values
        return [self.of(value) for value in values]

    def power_of_two(self, exponent: int) -> Any:
        """Return 2**exponent, exactly."""
        if exponent not in self._twos:
            self._twos[exponent] = self.of(Fraction(2) ** exponent)
        return self._twos[exponent]

    def fixed(self, values: Any, bits: int) -> list[int]:
        """Return each number of an array as an integer over 2**bits, cut off towards zero."""
        return [int(value) for value in (values * self.power_of_two(bits)).ravel()]

    def propagated(self, integrator: Any, times: Sequence[Any], **options: Any) -> tuple[Any, int]:
        """Return the states of a heyoka integrator at increasing times from its own on, and the number of steps.

        Raises:
            IntegrationError: it stopped before the last time, or a state is not finite.
        """
        grid = np.array(times, dtype=self.dtype)
        outcome, _, _, steps, _, states = integrator.propagate_grid(grid, **options)
        if outcome == hy.taylor_outcome.err_nf_state or not np.isfinite(states.astype(float)).all():
            raise IntegrationError("the state became infinite or not a number.")
        if outcome == hy.taylor_outcome.step_limit:
            raise IntegrationError(
                f"{steps} steps end at t = {float(integrator.time)} s, and no more are taken: {outcome}."
            )
        if outcome != hy.taylor_outcome.time_limit or len(states) != len(times):
            raise IntegrationError(f"heyoka stopped at t = {float(integrator.time)} s with outcome {outcome}.")
        return states, int(steps)


def _rounded(top: int, bottom: int, prec: int) -> tuple[int, int]:
    """Return an integer m of at most `prec` bits and an e with m 2**e nearest to top/bottom."""
    if top == 0:
        return 0, 0
    shift = abs(top).bit_length() - bottom.bit_length() - prec
    scaled = Fraction(top, bottom) / Fraction(2) ** shift
    if abs(scaled) >= 1 << prec:
        shift, scaled = shift + 1, scaled / 2
    return round(scaled), shift
