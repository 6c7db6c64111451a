"""heyoka as an engine: any formulation, any precision."""

from __future__ import annotations

from fractions import Fraction

from ...numbers.precision import LONG_DOUBLE_BITS, cheapest_type
from ...scenes.inputs import Inputs
from ..plan import Engine, Plan

_STEP_S = 6e-4  # CPU seconds of a step at 160 bits; a step's cost grows with the square of the bits
_HARDWARE_STEP_S = 4e-5  # in double and long double


class Heyoka(Engine):
    """Taylor series of adaptive order and step, compiled from expressions.

    heyoka is imported when it runs.
    """

    name = "heyoka"
    formulation = "momentum"
    requires = ("heyoka",)
    extra = ""
    bits = range(1, 1 << 30)
    own_process = True
    start_s = 0.0  # its import, 0.1 s, is not worth counting
    proof_step_s = 1.6e-3

    def plan(
        self, inputs: Inputs, prec: int, times: tuple[Fraction, ...], zeros: tuple[str, ...] = ()
    ) -> Plan:
        """Return the run of `momentum` in the cheapest type with `prec` bits."""
        return Plan(inputs, self.formulation, cheapest_type(prec), times, zeros, self.name)

    def expected_s(self, steps: int, prec: int) -> float:
        """Return the expected CPU seconds of `steps` steps at `prec` bits."""
        return steps * (
            _HARDWARE_STEP_S if prec <= LONG_DOUBLE_BITS else _STEP_S * (prec / 160) ** 2
        )


ENGINE = Heyoka()
