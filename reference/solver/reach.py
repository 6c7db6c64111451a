"""What is out of reach: the most bits and steps of a run, and how fast its first steps get on (stiff scenes)."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from ..errors import UnreachableError
from ..model.constants import constants
from ..precision import LONG_DOUBLE, context
from ..scene import Inputs

if TYPE_CHECKING:
    from ..engines.heyoka.stepper import Stepper

MAX_PREC = 8192
MAX_STEPS = 1 << 24  # at 160 bits or less: a year of Paris, three CPU hours
LOOK_STEPS = 1 << 16  # of which this many show the pace
SETTLED = 10  # with drag the pace may change until so many of its times have passed


def effort(steps: int, prec: int) -> int:
    """Steps at 160 bits that take as long: a step's cost grows with the cube of the bits."""
    return steps * max(1, prec // 32) ** 3 // 125


def check_pace(inputs: Inputs, end: Fraction, stepper: Stepper) -> None:
    """Look how fast the first steps get on, and leave the stepper where it was.

    Raises:
        UnreachableError: at that pace it takes more than `MAX_STEPS` steps to the end, in s.
    """
    start, span, taken, reached = stepper.mark(), float(end), 0, 0.0
    while reached < span:
        steps, begun = stepper.race(stepper.numbers.of(end), LOOK_STEPS), reached
        taken, reached = taken + steps, float(stepper.time)
        pace = steps / (reached - begun) if reached > begun else math.inf
        needed = taken + (span - reached) * pace
        if needed <= MAX_STEPS:
            break
        if taken >= MAX_STEPS or inputs.drag * Fraction(reached) >= SETTLED or not inputs.drag:
            raise UnreachableError(_why_so_many(inputs, needed, pace), _until(reached + (MAX_STEPS - taken) / pace))
    stepper.back(start)


def _why_so_many(inputs: Inputs, needed: float, pace: float) -> str:
    """The reason, in rates: drag alone makes a scene stiff, for the cord's own frequencies are all of one size."""
    altogether = f"{needed:.1e} steps, and at most {MAX_STEPS:.1e} are taken."
    ctx = context(LONG_DOUBLE.prec)
    k = constants(inputs, ctx)
    swing = float(ctx.norm(k.pull)) ** 0.5
    if 2 * swing >= k.drag:
        return f"The run takes {pace:.1e} steps a second, altogether {altogether}"
    fast = float(k.drag) * (1 + math.sqrt(1 - (2 * swing / float(k.drag)) ** 2)) / 2
    slow = swing**2 / fast
    then = f"the bob creeps at {slow:.1e}/s, rates {fast / slow:.1e} times apart" if slow else "nothing moves any more"
    return (
        f"Stiff: drag takes the speed away at {fast:.1e}/s and then {then}. "
        f"An explicit method's steps are held to the faster rate: {altogether}"
    )


def _until(t: float) -> str:
    return f"Ask for a shorter run (run.t_end up to about {0.95 * t:.2g}) or less drag."
