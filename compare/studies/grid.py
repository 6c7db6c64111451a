"""A scene's grid moved to times that are doubles, so that a method and the truth are compared at the same times.

0.1 s is not a double, nor are most of its multiples. Between such a time and the nearest double the bob moves by some
1e-16 of its path, which would hide the error of a method with many digits.
"""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction

from reference import Scene

STEP_BITS = 12  # bits of a step's mantissa: its first 2**41 multiples are doubles


def on_doubles(scene: Scene) -> Scene:
    """Return the scene; if one of its grid times is not a double, with a grid step of few bits and the same end.

    Args:
        scene: its inputs read as binary64, so that its end is a double.
    """
    inputs = scene.exact
    if all(Fraction(float(t)) == t for t in inputs.grid):
        return scene
    mantissa, exponent = math.frexp(float(inputs.grid_step))
    step = Fraction(round(mantissa * 2**STEP_BITS)) * Fraction(2) ** (exponent - STEP_BITS)
    return scene.with_values([f"run.grid_step={_decimal(step)}", f"run.t_end={_decimal(inputs.t_end)}"])


def _decimal(value: Fraction) -> str:
    """Write a dyadic number in decimal, with all its digits."""
    places = max(0, value.denominator.bit_length() - 1)
    return f"{Decimal(value.numerator * 5**places).scaleb(-places):f}"
