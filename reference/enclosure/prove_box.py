"""Run the proof of a box of inputs, along the scene's own motion. Untrusted."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from time import process_time

from flint import arb

from ..errors import BoxTooWideError
from ..numbers.taylor_step import TaylorStep
from ..numbers.zeros import XDOT
from .prove import SCENE_GUARD_BITS, demand_rest_positions, plan_for, until
from .trusted.balls import interval, times
from .trusted.box import BoxBalls, Windows
from .trusted.shapes import Box, Interval, ProvedBox, ProvedDerivatives

LOOK_BITS = 192  # for a first look at a box
BOX_BITS = 12  # the error of the approximant is at most 2^-12 of the width of the box
# logarithm of the growth of one radius, from which on derivatives are used
GROWTH = 1.0
ADVICE = (
    "Make the inputs less uncertain (`foucault show` says which), or the run shorter (run.t_end)."
)


@dataclass(frozen=True)
class BoxEnclosure:
    """A proof of a box as trusted code returned it, and how it was reached."""

    proved: ProvedBox
    bits: int
    steps: int
    radius: Fraction  # of the tube at the end, in m
    pace: Interval  # of the factors of time (Lemma 11.1)
    lean: Fraction  # a bound of how far unit vectors across the plumb line are from the scene's
    cpu_s: float  # CPU seconds, without those of the approximant
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
    """Prove the states at some times for all inputs of a box, and every zero up to the last of them.

    Args:
        box: the scene, and the least and largest inputs.
        until_times: output times in s, from 0 on, increasing.
        approximant: function of a precision in bits and an end in s; it returns the steps of the
            scene's motion, paired.
        zeros: words of the zeros to enclose: `XDOT` for transits, and those of sections.
        progress: called with the part of the time span that is proved.
        halves: half-width of each uncertain input by its full name; derivatives need them.
        derivatives: whether they are wanted; else they are used if one radius grows too much.

    Raises:
        BoxTooWideError: the box is too wide; says up to which time it holds.
    """
    attempt: _BoxAttempt | None = None
    begun = process_time()
    try:
        balls = BoxBalls(box, LOOK_BITS)
        demand_rest_positions(balls, zeros)
        accuracy = box.inputs.length * _width(balls) / (1 << BOX_BITS)
        bits = plan_for(box.inputs, until_times[-1], accuracy, "radius").bits
        windows = Windows(box, bits + SCENE_GUARD_BITS, until_times, zeros)
        latest = windows.course.times[-1]
        grows = float(latest) * _growth_rate(balls) > GROWTH
        attempt = _BoxAttempt(windows, halves if derivatives or grows else None)
        attempt.cpu_s = process_time() - begun
        for step in until(approximant(bits, latest), latest):
            attempt.advance(step)
            if progress:
                progress(float(attempt.reached / latest))
        proved = attempt.finish()
    except (ArithmeticError, ValueError):
        holds_s = float(attempt.reached / attempt.windows.pace.high) if attempt else 0.0
        raise BoxTooWideError(holds_s, ADVICE) from None

    radius = interval(windows.course.bound.eta * balls.length).high
    # these balls hold the scene's own
    lean = interval(sum((2 * x.rad() for x in balls.tilt), arb(0))).high
    return BoxEnclosure(
        proved=proved,
        bits=bits,
        steps=attempt.steps,
        radius=radius,
        pace=windows.pace,
        lean=lean,
        cpu_s=attempt.cpu_s,
        derivatives=attempt.derivatives,
    )


class _BoxAttempt:
    """The course of a box, and what proposes derivatives to it; without `halves` there are none."""

    def __init__(self, windows: Windows, halves: dict[str, Fraction] | None) -> None:
        self.windows = windows
        self.follower = self.source = None
        if halves:
            from .tangents import TangentSource, scales_of
            from .trusted.derivatives import Derivatives

            scales = scales_of(windows.balls, list(halves))
            self.follower = Derivatives(windows, halves, scales)
            self.source = TangentSource(windows.balls, self.follower.bound.sensitivities)
        self.derivatives: ProvedDerivatives | None = None
        self.reached = Fraction(0)
        self.steps = 0
        self.cpu_s = 0.0

    def advance(self, step: TaylorStep) -> None:
        """Prove the next step."""
        begun = process_time()
        course = self.windows.course
        if self.source:
            course.advance(step, self.source.propose(step))
        else:
            course.advance(step)
        self.reached = course.bound.time
        self.steps += 1
        self.cpu_s += process_time() - begun

    def finish(self) -> ProvedBox:
        """Return what was proved."""
        begun = process_time()
        if self.follower:
            self.derivatives = self.follower.finish()
            proved = self.derivatives.proved
        else:
            proved = self.windows.finish()
        self.cpu_s += process_time() - begun
        return proved


def _growth_rate(balls: BoxBalls) -> float:
    """Return the rate at which Theorem C's radius grows, in 1/s."""
    two_w_mu = max(balls.lambda_minus, balls.lambda_plus + balls.S**2, key=float)
    return float(two_w_mu) / (2 * float(balls.w0))


def _width(balls: BoxBalls) -> Fraction:
    """Return about how far apart motions of the box are, over the length, after a time of 1/w0."""
    rates = times(1 / balls.w0, [*balls.H, *balls.omega, balls.drag])
    radii = [arb(x.rad()) for x in (balls.pace, *balls.r, *rates)]
    widest = interval(max(radii, key=float)).high
    return max(widest, Fraction(1, 1 << LOOK_BITS // 2))
