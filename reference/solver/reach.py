"""Limits of a run: most bits and steps, and the pace of its first steps, by which stiff scenes are refused at once."""

from __future__ import annotations

import math
from fractions import Fraction

from ..errors import UnreachableError
from ..model.constants import constants
from ..numbers.precision import LONG_DOUBLE, context
from ..scenes.inputs import Inputs

MAX_PREC = 8192  # bits; a run that needs more is refused
MAX_RAISES = 6  # of the precision, before giving up
MAX_STEPS = 1 << 24  # at 160 bits or less: a year of Paris, three CPU hours
PACE_STEPS = 1 << 16  # steps over which the pace is measured, once or, with drag, again and again
SETTLED = 10  # with drag γ the pace may change until t = SETTLED/γ


def effort(steps: int, prec: int) -> int:
    """Return the number of steps at 160 bits that cost as much, if a step's cost grows with the cube of the bits.

    That is cautious, for a limit: at a few hundred bits it grows more like the square (`Engine.expected_s`).
    """
    return steps * max(1, prec // 32) ** 3 // 125


def out_of_reach(steps: int, prec: int) -> bool:
    """Return whether a run of `steps` steps in `prec` bits costs more than the solver begins."""
    return prec > MAX_PREC or effort(steps, prec) > MAX_STEPS


def check_reach(steps: int, prec: int, digits: int, advice: str = "") -> None:
    """Refuse a run that is out of reach.

    Raises:
        UnreachableError: it would take too many bits or steps.
    """
    if out_of_reach(steps, prec):
        raise UnreachableError(
            f"{digits} digits take {prec} bits over about {steps} steps, which is out of reach.",
            advice or "Ask for fewer digits (run.digits) or a shorter run (run.t_end).",
        )


class Pace:
    """The pace of a run, which is called with the steps taken and the time reached in s.

    Args:
        inputs: the exact inputs of a scene.
        end: end of the run in s.

    Raises:
        UnreachableError: at that pace the run takes more than `MAX_STEPS` steps.
    """

    def __init__(self, inputs: Inputs, end: Fraction) -> None:
        self._inputs, self._end, self._before, self._watching = inputs, float(end), (0, 0.0), True

    def __call__(self, steps: int, t: float) -> None:
        """Measure the pace once, or with drag again and again."""
        steps_before, t_before = self._before
        if not self._watching or steps - steps_before < PACE_STEPS:
            return
        self._before, pace = (steps, t), (steps - steps_before) / (t - t_before) if t > t_before else math.inf
        needed, drag = steps + (self._end - t) * pace, self._inputs.drag
        self._watching = needed > MAX_STEPS
        if self._watching and (steps >= MAX_STEPS or drag * Fraction(t) >= SETTLED or not drag):
            raise UnreachableError(_reason(self._inputs, needed, pace), _advice(t + (MAX_STEPS - steps) / pace))


def _reason(inputs: Inputs, needed: float, pace: float) -> str:
    """Return why a run takes too many steps: it is long, or strong drag makes it stiff (rates far apart in size)."""
    altogether = f"{needed:.1e} steps, and at most {MAX_STEPS:.1e} are taken."
    ctx = context(LONG_DOUBLE.prec)
    k = constants(inputs, ctx)
    swing = float(ctx.norm(k.pull)) ** 0.5
    if 2 * swing >= k.drag:
        return f"The run takes {pace:.1e} steps per simulated second, altogether {altogether}"
    fast = float(k.drag) * (1 + math.sqrt(1 - (2 * swing / float(k.drag)) ** 2)) / 2
    slow = swing**2 / fast
    then = "nothing moves any more"
    if slow:
        then = f"the bob relaxes at {slow:.1e}/s; the rates differ by a factor of {fast / slow:.1e}"
    return (
        f"Stiff: drag takes the speed away at {fast:.1e}/s, and after that {then}. "
        f"An explicit method's steps are limited by the faster rate: {altogether}"
    )


def _advice(t: float) -> str:
    return f"Ask for a shorter run (run.t_end up to about {0.95 * t:.2g}) or less drag."
