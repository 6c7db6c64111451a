"""Run the proof of a box of inputs: precision from its width, steps of the scene's own motion. Untrusted."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from time import process_time

from flint import arb

from ..errors import UnreachableError
from ..numbers.taylor_step import TaylorStep
from ..numbers.zeros import XDOT
from .prove import SCENE_GUARD_BITS, demand_rest_positions, plan_for, until
from .trusted.balls import interval, times
from .trusted.box import BoxBalls, Windows
from .trusted.shapes import Box, Interval, ProvedBox, ProvedDerivatives

LOOK_BITS = 192  # in which a box is looked at
BOX_BITS = 12  # the approximant is off by this part of the box at most
# logarithm of what one radius grows by: beyond it the motion is followed by its derivatives
GROWTH = 1.0
ADVICE = "Make the inputs less uncertain, or the run shorter (run.t_end)."


@dataclass(frozen=True)
class BoxEnclosure:
    """A proof of a box as trusted code returned it, and how it was reached.

    `radius` is that of the tube at the end, in m; `pace` the interval of the factors of time; `lean` how far unit
    vectors across the plumb line are from the scene's, at most; `cpu_s` the CPU seconds,
    without those of the approximant.
    """

    proved: ProvedBox
    bits: int
    steps: int
    radius: Fraction
    pace: Interval
    lean: Fraction
    cpu_s: float
    derivatives: ProvedDerivatives | None = None


def enclose_box(
    box: Box,
    until_times: list[Fraction],
    approximant: Callable[[int, Fraction], Iterable[TaylorStep]],
    zeros: tuple[str, ...] = (XDOT,),
    progress: Callable[[float], None] | None = None,
    halves: dict[str, Fraction] | None = None,
    derivatives: bool = False,
) -> BoxEnclosure:
    """Prove what holds at times from 0 on for all inputs of a box, and every zero up to the last of them.

    Args:
        box: the scene, and the least and largest inputs.
        until_times: output times in s, from 0 on, increasing.
        approximant: function of a precision in bits and an end in s that gives steps of the scene's motion, paired.
        zeros: words of the zeros to enclose: `XDOT` for transits, and those of sections.
        progress: called with the part of the time span that is proved.
        halves: half of the width of each uncertain input by its full name; with them derivatives may be used.
        derivatives: whether they are wanted; else they are used where one radius grows too much.

    Raises:
        UnreachableError: the box is too wide; says up to which time it holds.
    """
    begun, reached, count, end = process_time(), Fraction(0), 0, until_times[-1]
    try:
        balls = BoxBalls(box, LOOK_BITS)
        demand_rest_positions(balls, zeros)
        bits = plan_for(
            box.inputs, end, box.inputs.length * _width(balls) / (1 << BOX_BITS), "radius"
        ).bits
        windows = Windows(box, bits + SCENE_GUARD_BITS, until_times, zeros)
        course, latest = windows.course, windows.course.times[-1]
        follower = source = None
        # the rate at which Theorem C's radius grows, in 1/s
        growth = float(max(balls.lambda_minus, balls.lambda_plus + balls.S**2, key=float)) / (
            2 * float(balls.w0)
        )
        if halves and (derivatives or growth * float(latest) > GROWTH):
            from .tangents import TangentSource, scales_of
            from .trusted.derivatives import Derivatives

            follower = Derivatives(windows, halves, scales_of(windows.balls, list(halves)))
            source = TangentSource(windows.balls, follower.bound.sensitivities)
        cpu_s = process_time() - begun
        for step in until(approximant(bits, latest), latest):
            begun = process_time()
            course.advance(step, *([source.propose(step)] if source else []))
            reached, count, cpu_s = course.bound.time, count + 1, cpu_s + process_time() - begun
            if progress:
                progress(float(reached / latest))
        begun, found = process_time(), follower.finish() if follower else None
        proved = found.proved if found else windows.finish()
        cpu_s += process_time() - begun
    except (ArithmeticError, ValueError):
        holds = float(reached / windows.pace.high) if reached else 0.0
        raise UnreachableError(
            f"The box of inputs is too wide: it holds up to t = {holds:.4g} s.", ADVICE
        ) from None
    radius = interval(course.bound.eta * balls.length).high
    # these balls hold the scene's own
    lean = interval(sum((2 * x.rad() for x in balls.tilt), arb(0))).high
    return BoxEnclosure(proved, bits, count, radius, windows.pace, lean, cpu_s, found)


def _width(balls: BoxBalls) -> Fraction:
    """Return about how far apart motions of the box are, over the length, after a time of 1/w0."""
    w = balls.w0
    slow = [balls.pace, *balls.r, *times(1 / w, [*balls.H, *balls.omega, balls.drag])]
    widest = interval(max((arb(x.rad()) for x in slow), key=float)).high
    return max(widest, Fraction(1, 1 << LOOK_BITS // 2))
