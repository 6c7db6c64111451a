"""From a scene's exact inputs to a model and a start in digits.

The axes are those of the Earth: x east, w along its axis, m = (0, sin, -cos) of the latitude, so that Ω has one
component and six products a coefficient do for all linear terms. Without rotation north and up stay as they are.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ...model.algebra import add, cross
from ...model.constants import Constants, Vector, constants, release, scaled
from ...precision import GUARD_BITS, context
from ...scene import Inputs
from .limb import MOST_LIMBS, Array, fraction_bits, rows_of
from .series import Line
from .step import GRAINS, MOST_GRAINS, Model

ROUNDING_BITS = 9  # what the sums of a step lose below the last digit they keep
TAIL_BITS = 9  # by which the last coefficients are below the precision: what is cut off has one sign for many steps
ORDER_PER_BIT = 0.45  # of cheapest orders: a step then loses 2.2 bits an order
SMALLEST_SWING = 64  # bits; at rest on the vertical there is none
MOST_TURN = 1.75  # of a step times the swing's frequency: its square is h² λ at rest, which digits hold up to 4
GUESS = 0.5  # of the time in which the pendulum changes: the first step, before the series has been seen


@dataclass(frozen=True)
class Problem:
    """A scene in digits.

    Attributes:
        model: constants, limbs and order.
        start: the state at release: n in lanes 0 to 2, V in the unit of time in lanes 3 to 5.
        unit: the unit of time in s, a power of two.
        first: a first step in grains.
        k, n, v: the scene's constants and release as mpf, for whoever needs them exactly.
    """

    model: Model
    start: Array
    unit: Fraction
    first: int
    k: Constants
    n: Vector
    v: Vector

    @property
    def grain(self) -> Fraction:
        """The grain of time in s."""
        return self.unit / GRAINS


def limbs_for(prec: int) -> int:
    """How many digits keep `prec` bits of numbers up to 1 through a step."""
    return max(3, -(-(prec + ROUNDING_BITS + 1) // 22))


def most_bits() -> int:
    """The largest precision that can be had."""
    return fraction_bits(MOST_LIMBS) - ROUNDING_BITS


def problem(inputs: Inputs, prec: int, order: int | None = None) -> Problem:
    """The problem of a scene in which numbers as large as the swing keep about `prec` bits a step.

    The order is the cheapest for a run; a higher one makes fewer, longer steps.
    """
    ctx = context(most_bits() + 2 * GUARD_BITS)
    k = constants(inputs, ctx)
    position, velocity = release(inputs, ctx)
    n, v = (scaled(vector, k.length) for vector in (position, velocity))
    prec = min(prec + _smallness(k, n, v, ctx), most_bits())
    limbs = limbs_for(prec)
    unit, guess = _unit(k, v, ctx)
    h = ctx.mpf(unit.numerator) / unit.denominator
    sin, cos = (k.sin, k.cos) if k.rate else (1, 0)
    turn, pull = _earthly(k.turn, sin, cos), _earthly(k.pull, sin, cos)
    whole = _earthly(add(v, cross(k.turn, n)), sin, cos)
    most = (
        min(MOST_GRAINS, max(1, int(GRAINS * MOST_TURN / (h * ctx.sqrt(ctx.norm(pull)))))) if any(pull) else MOST_GRAINS
    )
    model = Model(
        limbs=limbs,
        order=order or round(ORDER_PER_BIT * (prec + TAIL_BITS)) + 2,
        drag=bool(k.drag),
        tolerance=2.0 ** -(prec + TAIL_BITS),
        most=most,
        line=_line(turn[2] * h, pull[1] * h * h, pull[2] * h * h, k.drag * h, limbs + 1),
        powers=Line(*(np.array(row, dtype=float) for row in _POWERS)),
        along=rows_of([1, sin, sin, 1, sin, sin, 1], limbs),
        across=2 * rows_of([0, cos, -cos, 0, cos, -cos], limbs),
    )
    start = rows_of([*_earthly(n, sin, cos), *(h * u for u in whole)], limbs)
    return Problem(model, start, unit, min(guess, most), k, n, v)


def _smallness(k: Constants, n: Vector, v: Vector, ctx: Any) -> int:
    """By how many bits the swing is smaller than l: digits count from l, and so many more are needed."""
    rate = ctx.sqrt(ctx.norm(k.pull))
    swing = max(abs(n[0]), abs(n[1]), 1 + n[2] if k.pull[1] else 0, ctx.norm(v) / rate if rate else 1)
    return min(SMALLEST_SWING, max(0, -int(ctx.floor(ctx.log(swing, 2))))) if swing else 0


def _earthly(a: Vector, sin: Any, cos: Any) -> Vector:
    """East, north, up as x, m, w."""
    return a[0], a[1] * sin - a[2] * cos, a[1] * cos + a[2] * sin


_POWERS = (
    (1, 1, 3, 1, 1, 2, 2, 2),
    (2, 2, 3, 1, 1, 1, 1, 1),
    (0, 3, 0, 0, 0, 0, 0, 2),
    (2, 2, 2, 2, 2, 2, 2, 2),
    (2, 2, 2, 2, 2, 2, 2, 2),
)


def _line(w: Any, am: Any, aw: Any, g: Any, limbs: int) -> Line:
    """The constants of `series.Line` in the unit of time."""
    return Line(
        turn=rows_of([w, -w, -am * w, w, -w, 3 * aw, 3 * am, am], limbs),
        drag=rows_of([g * w, -g * w, 2 * g * aw, -g, -g, -g, -2 * g, -g], limbs),
        drag_pull=rows_of([0, 2 * g * am, 0, 0, 0, 0, 0, 2 * g * w], limbs),
        drag_axial=rows_of([-g * w], limbs),
        steady=rows_of([0, 0, 0, 0, am, aw, 0, g * w], limbs),
    )


def _unit(k: Constants, v: Vector, ctx: Any) -> tuple[Fraction, int]:
    """A power of two near the first step, in s, and that step in grains of it."""
    rate = float(ctx.sqrt(ctx.norm(k.pull)) + ctx.norm(v) + abs(k.rate) + k.drag)
    step = GUESS / rate if rate > 0 else 1.0
    mantissa, exponent = math.frexp(step)
    return Fraction(2) ** exponent, max(1, int(mantissa * GRAINS))
