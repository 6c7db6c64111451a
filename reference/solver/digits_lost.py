"""Digits lost between release and end, because the motion amplifies errors of its inputs; from perturbed runs."""

from __future__ import annotations

import math
import operator
from dataclasses import replace
from fractions import Fraction
from typing import cast

from ..engines.plan import Plan
from ..engines.registry import run
from ..errors import UnreachableError
from ..numbers.columns import GRID
from ..numbers.precision import DOUBLE, LONG_DOUBLE, real
from ..scenes.inputs import Inputs
from .pilot import Pilot, run_pilot
from .reach import MAX_PREC

Quadruple = tuple[Fraction, Fraction, Fraction, Fraction]
DIVERGED = Fraction(1, 64)  # a change above this part of a column's size is no longer proportional to the perturbation


def digits_lost(
    inputs: Inputs, times: tuple[Fraction, ...], pilot: Pilot | None = None, *, constants: bool = True
) -> float:
    """Return the decimal digits that the motion costs: n digits of every result need n + this many in the inputs.

    Three runs are compared: the scene's own, one with a perturbed release, and one with perturbed constants. At a
    precision of p bits the perturbation is a relative 2**-(p // 2). The column that changes most counts, its change
    over its largest number. An input that is zero, or a latitude where a term vanishes, is taken as exact. If the
    perturbed runs diverge, they are repeated at a higher precision.

    Args:
        inputs: the exact inputs of a scene.
        times: increasing, from 0, in s.
        pilot: the result of `run_pilot` for the same inputs and times, to save two runs.
        constants: whether errors of the constants count as well, or only those of the release.

    Raises:
        UnreachableError: as `run_pilot`, or the perturbed runs diverge at every precision.
    """
    pilot = pilot or run_pilot(inputs, times)
    number = DOUBLE if pilot.prec <= DOUBLE.prec else real(2 * LONG_DOUBLE.prec)
    while number.prec <= MAX_PREC:
        nudge = Fraction(1, 2 ** (number.prec // 2))
        changed = [_perturbed_release(inputs, nudge), *([_perturbed_constants(inputs, nudge)] if constants else [])]
        base, *perturbed = (run(Plan(each, "momentum", number, times, transits=False)) for each in (inputs, *changed))
        changes = [base.grid.only(GRID).distance(other.grid).largest() for other in perturbed]
        worst = max(change[name] / size for change in changes for name, size in pilot.sizes.items() if size)
        if worst <= DIVERGED:
            ratio = worst / nudge
            return max(0.0, math.log10(ratio.numerator) - math.log10(ratio.denominator)) if ratio else 0.0
        number = LONG_DOUBLE if number is DOUBLE else real(2 * number.prec)
    raise UnreachableError(
        f"Even at {MAX_PREC} bits perturbed runs diverge completely, so the sensitivity cannot be measured.",
        "Ask for a shorter run: run.t_end.",
    )


def _perturbed_release(inputs: Inputs, nudge: Fraction) -> Inputs:
    """Change each number of the release by a factor; x, y and the angle get smaller, to stay on the sphere."""
    factors = (1 - nudge, 1 - nudge / 2, 1 + nudge, 1 - nudge)

    def perturbed(numbers: Quadruple | None) -> Quadruple | None:
        return numbers and cast("Quadruple", tuple(map(operator.mul, numbers, factors)))

    return replace(inputs, position=perturbed(inputs.position), angles=perturbed(inputs.angles))


def _perturbed_constants(inputs: Inputs, nudge: Fraction) -> Inputs:
    """Change each constant by a factor, length and gravity, which set the swing's frequency, in opposite directions."""
    up, down = ("length", "rotation_rate", "altitude", "flattening"), ("gravity", "equatorial_radius", "drag")
    values = {name: getattr(inputs, name) * (1 + nudge) for name in up}
    values |= {name: getattr(inputs, name) * (1 - nudge) for name in down}
    latitude = inputs.latitude * (1 - nudge) if inputs.latitude % 90 else inputs.latitude
    return replace(inputs, latitude=latitude, **values)
