"""How many digits the flow of a scene costs between release and end, from runs with perturbed inputs."""

from __future__ import annotations

import math
import operator
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, cast

from ..engines.plan import Plan
from ..engines.run import run
from ..errors import UnreachableError
from ..precision import DOUBLE, LONG_DOUBLE, real
from ..scene import Inputs
from ..table import disagreement
from .pilot import Pilot, run_pilot
from .reach import MAX_PREC

if TYPE_CHECKING:
    pass

Quadruple = tuple[Fraction, Fraction, Fraction, Fraction]
PARTED = Fraction(1, 64)  # twins further apart than this, against the column's size, no longer measure a slope


def digits_lost(inputs: Inputs, times: tuple[Fraction, ...], pilot: Pilot | None = None) -> float:
    """Decimal digits that the flow costs: n digits of every result take n + this many digits of the inputs.

    Twin runs whose inputs differ by a relative 2**-26, once in the release and once in all the constants, drift
    apart. What counts is the column that suffers most, its change over its largest number; an input that is zero or
    a latitude where a term vanishes is taken as exact. Where the twins part company wholly, finer ones are sent.

    Args:
        inputs: the exact inputs of a scene.
        times: increasing, from 0, in s.
        pilot: as measured over `times`, to save two runs.

    Raises:
        UnreachableError: as `run_pilot`.
    """
    pilot = pilot or run_pilot(inputs, times)
    number = DOUBLE if pilot.prec <= DOUBLE.prec else real(2 * LONG_DOUBLE.prec)
    while number.prec <= MAX_PREC:
        nudge = Fraction(1, 2 ** (number.prec // 2))
        base, *twins = (
            run(Plan(each, "momentum", number, times, transits=False))
            for each in (inputs, _other_release(inputs, nudge), _other_constants(inputs, nudge))
        )
        parted = [disagreement(base.grid, base.bits, twin.grid, twin.bits) for twin in twins]
        sizes = pilot.sizes
        worst = max(change[i] / size for change in parted for i, size in enumerate(sizes) if size)
        if worst <= PARTED:
            ratio = worst / nudge
            return max(0.0, math.log10(ratio.numerator) - math.log10(ratio.denominator)) if ratio else 0.0
        number = LONG_DOUBLE if number is DOUBLE else real(2 * number.prec)
    raise UnreachableError(f"Twins part company wholly even at {MAX_PREC} bits.", "Ask for a shorter run: run.t_end.")


def _other_release(inputs: Inputs, nudge: Fraction) -> Inputs:
    """Each number of the release by its own factor; position and angle inwards, so that they stay on the sphere."""
    factors = (1 - nudge, 1 - nudge / 2, 1 + nudge, 1 - nudge)

    def changed(numbers: Quadruple | None) -> Quadruple | None:
        return numbers and cast("Quadruple", tuple(map(operator.mul, numbers, factors)))

    return replace(inputs, position=changed(inputs.position), angles=changed(inputs.angles))


def _other_constants(inputs: Inputs, nudge: Fraction) -> Inputs:
    """Each constant by a factor, those of the swing's frequency in opposite directions."""
    up, down = ("length", "rotation_rate", "altitude", "flattening"), ("gravity", "equatorial_radius", "drag")
    changed = {name: getattr(inputs, name) * (1 + nudge) for name in up}
    changed |= {name: getattr(inputs, name) * (1 - nudge) for name in down}
    latitude = inputs.latitude * (1 - nudge) if inputs.latitude % 90 else inputs.latitude
    return replace(inputs, latitude=latitude, **changed)
