"""A scene as a problem in limbs: its constants, unit of time, limb count, order, first step and state at release.

The axes are those of the Earth: x east, w along its axis, m = (0, sin, -cos) of the latitude, so
that Ω has one component and six products a coefficient suffice for all linear terms. Without
rotation m is north and w is up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
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

# a series ends this much below the precision, as its tail keeps its sign, and so adds up, for many
# steps
_TAIL_BITS = 9
_ORDER_PER_BIT = 0.45  # the cheapest order for each bit of precision: an order then gains 2.2 bits
# bits added at most for a swing smaller than l; none are added where there is no swing
_MOST_SWING_BITS = 64
# of the order, and of the first and the longest step, in a run that takes other steps
_OTHER_STEPS = Fraction(7, 8)
_GUESS = 0.5  # first step, of the time in which the pendulum changes: no series is known yet


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

    `order` is that of the series; None for the cheapest of a run. A higher one makes fewer, longer
    steps. With `other_steps` the order is lower and the longest step shorter, so that no step is
    the same in both kinds of run.
    """
    start = _start(inputs)
    prec = _prec_from_l(start, prec)
    unit, first = _unit_of_time(start)
    h = start.ctx.mpf(unit.numerator) / unit.denominator
    order = order or round(_ORDER_PER_BIT * (prec + _TAIL_BITS)) + 2
    longest = _longest_step(start, h)
    if other_steps:
        order = _shortened(order)
        first = _shortened(first)
        longest = _shortened(longest)
    limb_count = limb_count_for(prec)
    sin, cos = _axis(start)
    model = LimbModel(
        limb_count=limb_count,
        order=order,
        drag=bool(start.k.drag),
        tolerance=math.ldexp(1.0, -(prec + _TAIL_BITS)),
        longest=longest,
        terms=_linear_terms(start, h, limb_count + 1),
        powers=LinearTerms(*(np.array(row, dtype=float) for row in _POWERS)),
        along=rows_of([1, sin, sin, 1, sin, sin, 1], limb_count),
        across=2 * rows_of([0, cos, -cos, 0, cos, -cos], limb_count),
    )
    state = _state(start, h, limb_count)
    return LimbProblem(model, state, unit, min(first, longest), start)


def _axis(start: Start) -> tuple[Any, Any]:
    """Return sine and cosine of the latitude; those of the pole without rotation."""
    k = start.k
    return (k.sin, k.cos) if k.rate else (1, 0)


def _to_earth(start: Start, vector: Sequence[Any]) -> tuple[Any, Any, Any]:
    """Return x, m, w of a vector east, north, up."""
    sin, cos = _axis(start)
    east, north, up = vector
    return east, north * sin - up * cos, north * cos + up * sin


def _longest_step(start: Start, h: Any) -> int:
    """Return the longest step in grains: not longer than an angle of MOST_TURN of a small swing."""
    pull = _to_earth(start, start.k.pull)
    swing_rate = h * start.ctx.sqrt(start.ctx.norm(pull))
    if not swing_rate:
        return MOST_GRAINS
    return min(MOST_GRAINS, max(1, int(GRAINS * MOST_TURN / swing_rate)))


def _shortened(size: int) -> int:
    """Return an order or a step in a run that takes other steps."""
    return max(1, int(size * _OTHER_STEPS))


def _state(start: Start, h: Any, limb_count: int) -> Array:
    """Return the limbs of n and h V at the release."""
    inertial = add(start.v, cross(start.k.turn, start.n))
    n = _to_earth(start, start.n)
    V = _to_earth(start, inertial)
    return rows_of([*n, *(h * component for component in V)], limb_count)


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
    ctx = start.ctx
    x, y, z = start.n
    rate = ctx.sqrt(ctx.norm(start.k.pull))
    height = 1 + z if start.k.pull[1] else 0
    reach = ctx.norm(start.v) / rate if rate else 1  # of a swing that starts with this velocity
    swing = max(abs(x), abs(y), height, reach)
    if not swing:
        return 0
    return min(_MOST_SWING_BITS, max(0, -int(ctx.floor(ctx.log(swing, 2)))))


# of the step length in the constants of `LinearTerms`, lane by lane
_POWERS = (
    (1, 1, 3, 1, 1, 2, 2, 2),
    (2, 2, 3, 1, 1, 1, 1, 1),
    (0, 3, 0, 0, 0, 0, 0, 2),
    (2, 2, 2, 2, 2, 2, 2, 2),
    (2, 2, 2, 2, 2, 2, 2, 2),
)


def _linear_terms(start: Start, h: Any, limb_count: int) -> LinearTerms:
    """Return the linear terms in the unit of time h."""
    _, _, turn = _to_earth(start, start.k.turn)
    _, pull_m, pull_w = _to_earth(start, start.k.pull)
    w = turn * h
    am = pull_m * h * h
    aw = pull_w * h * h
    g = start.k.drag * h
    return LinearTerms(
        turn=rows_of([w, -w, -am * w, w, -w, 3 * aw, 3 * am, am], limb_count),
        drag=rows_of([g * w, -g * w, 2 * g * aw, -g, -g, -g, -2 * g, -g], limb_count),
        drag_tension=rows_of([0, 2 * g * am, 0, 0, 0, 0, 0, 2 * g * w], limb_count),
        drag_axial=rows_of([-g * w], limb_count),
        steady=rows_of([0, 0, 0, 0, am, aw, 0, g * w], limb_count),
    )


def _unit_of_time(start: Start) -> tuple[Fraction, int]:
    """Return a power of two near the first step, in s, and that step in grains."""
    step = _GUESS / start.fastest_rate if start.fastest_rate > 0 else 1.0
    mantissa, exponent = math.frexp(step)
    return Fraction(2) ** exponent, max(1, int(mantissa * GRAINS))
