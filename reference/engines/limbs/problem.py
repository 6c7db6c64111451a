"""A scene as a problem in limbs: its constants, unit of time, limb count, order, first step and state at release.

The axes are those of the Earth: x east, w along its axis, m = (0, sin, -cos) of the latitude, so that Ω has one
component and six products a coefficient do for all linear terms. Without rotation m is north and w is up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ...model.algebra import add, cross
from ...model.start import Start
from ...numbers.precision import GUARD_BITS, Array
from ...scenes.inputs import Inputs
from ..plan import MOST_TURN
from .limb import rows_of
from .series import LinearTerms
from .size import MOST_PREC, highest_prec, limb_count_for
from .step import GRAINS, MOST_GRAINS, LimbModel

# a series ends this much below the precision, as its tail keeps its sign, and so adds up, for many steps
TAIL_BITS = 9
ORDER_PER_BIT = 0.45  # the cheapest order for each bit of precision: an order then gains 2.2 bits
# bits added at most for a swing smaller than l; none are added where there is no swing
MOST_SWING_BITS = 64
# of the order, and of the first and the longest step, in a run that takes other steps
OTHER_STEPS = Fraction(7, 8)
GUESS = 0.5  # first step, of the time in which the pendulum changes: no series is known yet


@dataclass(frozen=True)
class LimbProblem:
    """A scene in limbs.

    Attributes:
        model: constants, limb count and order.
        state: at the release: n in lanes 0 to 2, V in the unit of time in lanes 3 to 5.
        unit: the unit of time in s, a power of two.
        first: the first step in grains.
        start: the scene's constants and release as mpf.
    """

    model: LimbModel
    state: Array
    unit: Fraction
    first: int
    start: Start

    @property
    def grain(self) -> Fraction:
        """The grain of time in s."""
        return self.unit / GRAINS


def limb_problem(
    inputs: Inputs, prec: int, order: int | None = None, other_steps: bool = False
) -> LimbProblem:
    """Return a scene's problem, in which numbers as large as the swing keep about `prec` bits a step.

    `order` is that of the series; None for the cheapest of a run. A higher one makes fewer, longer steps. With
    `other_steps` the order is lower and the longest step shorter, so that steps of either kind are others.
    """
    start = _start(inputs)
    ctx, k = start.ctx, start.k
    prec = _prec_from_l(start, prec)
    limb_count = limb_count_for(prec)
    unit, first = _unit_of_time(start)
    order = order or round(ORDER_PER_BIT * (prec + TAIL_BITS)) + 2
    h = ctx.mpf(unit.numerator) / unit.denominator
    sin, cos = (k.sin, k.cos) if k.rate else (1, 0)
    vectors = k.turn, k.pull, start.n, add(start.v, cross(k.turn, start.n))
    # from the axes east, north, up to x, m, w
    turn, pull, n, inertial = ((a, b * sin - c * cos, b * cos + c * sin) for a, b, c in vectors)
    swing = h * ctx.sqrt(ctx.norm(pull))  # the rate of a small one
    longest = min(MOST_GRAINS, max(1, int(GRAINS * MOST_TURN / swing))) if swing else MOST_GRAINS
    if other_steps:
        order, first, longest = (
            max(1, int(size * OTHER_STEPS)) for size in (order, first, longest)
        )
    model = LimbModel(
        limb_count=limb_count,
        order=order,
        drag=bool(k.drag),
        tolerance=math.ldexp(1.0, -(prec + TAIL_BITS)),
        longest=longest,
        terms=_linear_terms(
            turn[2] * h, pull[1] * h * h, pull[2] * h * h, k.drag * h, limb_count + 1
        ),
        powers=LinearTerms(*(np.array(row, dtype=float) for row in _POWERS)),
        along=rows_of([1, sin, sin, 1, sin, sin, 1], limb_count),
        across=2 * rows_of([0, cos, -cos, 0, cos, -cos], limb_count),
    )
    state = rows_of([*n, *(h * u for u in inertial)], limb_count)
    return LimbProblem(model, state, unit, min(first, longest), start)


def highest_prec_of_fewer_limbs(inputs: Inputs, prec: int) -> int:
    """Return the highest precision at which a scene is integrated with fewer limbs than at `prec` bits."""
    start = _start(inputs)
    return highest_prec(limb_count_for(_prec_from_l(start, prec)) - 1) - _swing_bits(start)


def _start(inputs: Inputs) -> Start:
    return Start.of(inputs, MOST_PREC + 2 * GUARD_BITS)


def _prec_from_l(start: Start, prec: int) -> int:
    """Return the bits, counted from l, that keep `prec` bits of numbers as large as the swing; at most `MOST_PREC`."""
    return min(prec + _swing_bits(start), MOST_PREC)


def _swing_bits(start: Start) -> int:
    """Return by how many bits the swing is smaller than l: limbs count from l, so that many more bits are needed."""
    ctx, k, n, v = start.ctx, start.k, start.n, start.v
    rate = ctx.sqrt(ctx.norm(k.pull))
    swing = max(
        abs(n[0]), abs(n[1]), 1 + n[2] if k.pull[1] else 0, ctx.norm(v) / rate if rate else 1
    )
    return min(MOST_SWING_BITS, max(0, -int(ctx.floor(ctx.log(swing, 2))))) if swing else 0


# of the step length in the constants of `LinearTerms`, lane by lane
_POWERS = (
    (1, 1, 3, 1, 1, 2, 2, 2),
    (2, 2, 3, 1, 1, 1, 1, 1),
    (0, 3, 0, 0, 0, 0, 0, 2),
    (2, 2, 2, 2, 2, 2, 2, 2),
    (2, 2, 2, 2, 2, 2, 2, 2),
)


def _linear_terms(w: Any, am: Any, aw: Any, g: Any, limb_count: int) -> LinearTerms:
    """Return the linear terms in the unit of time."""
    return LinearTerms(
        turn=rows_of([w, -w, -am * w, w, -w, 3 * aw, 3 * am, am], limb_count),
        drag=rows_of([g * w, -g * w, 2 * g * aw, -g, -g, -g, -2 * g, -g], limb_count),
        drag_tension=rows_of([0, 2 * g * am, 0, 0, 0, 0, 0, 2 * g * w], limb_count),
        drag_axial=rows_of([-g * w], limb_count),
        steady=rows_of([0, 0, 0, 0, am, aw, 0, g * w], limb_count),
    )


def _unit_of_time(start: Start) -> tuple[Fraction, int]:
    """Return a power of two near the first step, in s, and that step in grains."""
    step = GUESS / start.fastest_rate if start.fastest_rate > 0 else 1.0
    mantissa, exponent = math.frexp(step)
    return Fraction(2) ** exponent, max(1, int(mantissa * GRAINS))
