"""limbs as an engine: always `inertial`, beyond long double."""

from __future__ import annotations

from fractions import Fraction

from ...numbers.precision import NumberType
from ...scenes.inputs import Inputs
from ..plan import Engine, Plan
from .size import LEAST_PREC, MOST_PREC

# CPU seconds of a step at 160 bits: a fiftieth of heyoka's; it grows with the square of the bits
_STEP_S = 1.2e-5


class Limbs(Engine):
    """Taylor series of fixed order and adaptive step in compiled multiprecision.

    Numba is imported when it runs.
    """

    name = "limbs"
    formulation = "inertial"
    requires = ("numba",)
    extra = "fast"
    bits = range(LEAST_PREC, MOST_PREC + 1)
    own_process = False
    start_s = 0.5
    proof_step_s = 4e-4  # its steps are twice as long as heyoka's

    def plan(
        self, inputs: Inputs, prec: int, times: tuple[Fraction, ...], zeros: tuple[str, ...] = ()
    ) -> Plan:
        """Return the run that keeps `prec` bits of a number as large as the swing."""
        return Plan(inputs, self.formulation, NumberType("limbs", prec), times, zeros, self.name)

    def witness(self, published: Plan, prec: int) -> Plan:
        """Return a run of at most `prec` bits, with fewer limbs than the published run, and in other steps."""
        from .problem import highest_prec_of_fewer_limbs

        highest = highest_prec_of_fewer_limbs(published.inputs, published.number.prec)
        return super().witness(published, min(prec, highest))

    def expected_s(self, steps: int, prec: int) -> float:
        """Return about how many CPU seconds a run takes that would be `steps` steps in double."""
        return steps * _STEP_S * (prec / 160) ** 2


ENGINE = Limbs()
