"""A grid whose times are doubles: what a method is asked for and what the truth is known at are then the same times.

A step of 0.1 s is no double and its multiples are none either; between a time and the double next to it the bob moves
by some 1e-16 of its path, which is the whole error of a method with many digits.
"""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction

from reference import Scene

STEP_BITS = 12  # of a step's mantissa: its multiples up to 2**41 are doubles


def on_doubles(scene: Scene) -> Scene:
    """The scene, with a grid step and an end of few bits where some grid time is no double."""
    inputs = scene.exact
    if all(Fraction(float(t)) == t for t in inputs.grid):
        return scene
    mantissa, exponent = math.frexp(float(inputs.grid_step))
    step = Fraction(round(mantissa * 2**STEP_BITS)) * Fraction(2) ** (exponent - STEP_BITS)
    rows = max(1, math.floor(inputs.t_end / step))
    return scene.with_values([f"run.grid_step={_decimal(step)}", f"run.t_end={_decimal(rows * step)}"])


def _decimal(value: Fraction) -> str:
    """A dyadic number in full."""
    places = max(0, value.denominator.bit_length() - 1)
    return f"{Decimal(value.numerator * 5**places).scaleb(-places):f}"
