"""Run a proof: choose method and bits, and go from an approximant's steps to enclosed states; with more bits if needed.

Untrusted: no bound is computed here. Every step goes to the trusted `Course`, whose results are handed on as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import chain, pairwise
from math import ceil
from time import process_time
from typing import Any, NamedTuple

from flint import arb

from ..errors import UnreachableError
from ..model.sections import gate_without_rest
from ..numbers.precision import log2
from ..numbers.taylor_step import TaylorStep
from ..numbers.zeros import XDOT
from .frames import ColumnSource
from .sums_checked import SumsChecked
from .trusted.course import Course
from .trusted.shapes import Proved, ProvedFunction, State
from .trusted.system import SceneBalls

MARGIN_BITS = 18  # lost to the rounding of coefficients and to norms; measured on Paris
COLUMN_MARGIN_BITS = 14  # lost besides where the error is carried in columns
# up to which one radius is always cheaper than columns: a step by columns takes six times as long
RADIUS_BITS = 400
# beyond that, share of the target bits that one radius may lose before columns are cheaper
RADIUS_SHARE = 0.2
LEAST_BITS, MAX_BITS = 96, 2048
LOOK_BITS = 128  # in which a scene is looked at before its proof
SCENE_GUARD_BITS = 64  # precision of the scene's balls beyond the steps' coefficients
ATTEMPTS = 4  # at rising precision
LEAST_RAISE = 8  # bits from one attempt to the next
USELESS = 2**12  # a state known this many times less closely than requested ends an attempt at once
TINY = -1e9  # stands for the logarithm of a width that is 0

Approximant = Callable[[int], Iterable[TaylorStep]]
# bits that an approximant of so many loses, if one radius carries its error
Lost = Callable[[int], int]


class ProofPlan(NamedTuple):
    """The method and the precision that an attempt at a proof begins with."""

    method: str  # "radius" or "columns"
    bits: int


@dataclass(frozen=True)
class Enclosure:
    """A proof's result as trusted code returned it, and how it was reached."""

    proved: Proved
    bits: int
    order: int
    steps: int
    method: str  # "radius" (Theorem C) or "columns" (Theorem E)
    position_radius: Fraction  # the largest of all, in m
    velocity_radius: Fraction  # in m/s
    cpu_s: float  # CPU seconds, without those of the approximant
    function: ProvedFunction | None = None  # the golden function, if it was asked for


class _TooWide(Exception):
    """The bounds are wider than requested; `bits` is the precision to try next."""

    def __init__(self, reason: str, bits: int) -> None:
        super().__init__(reason)
        self.bits = bits


def enclose(
    inputs: Any,
    times: Sequence[Fraction],
    *,
    radius: Fraction,
    approximant: Approximant,
    zeros: tuple[str, ...] = (XDOT,),
    progress: Callable[[float], None] | None = None,
    method: str | None = None,
    flint_only: bool = False,
    function: bool = False,
    lost: Lost | None = None,
) -> Enclosure:
    """Prove where the pendulum is at `times` (s, increasing), and every zero of some forms up to the last of them.

    Args:
        inputs: the exact numbers of a scene (`Scene.exact`).
        times: output times in s, from 0 on, increasing.
        radius: largest half-width to accept, in m for positions and m/s for velocities.
        approximant: function of a precision in bits that gives steps from t = 0 to the last time, as `pair` yields
            them; it is called again, with more bits, where the bounds are too wide.
        zeros: words of the zeros to enclose: `XDOT` for transits, and those of sections.
        progress: called with the part of the time span that is proved.
        method: "radius" or "columns"; None for the one that is likely to be cheaper.
        flint_only: prove by FLINT alone, and have the sums of digits compared with its integers.
        function: also make the golden function, and bound it.
        lost: bits that a run of so many loses besides `MARGIN_BITS`, if one radius carries its error (`Feed.lost`).

    Raises:
        UnreachableError: no bound of this width was reached; says how wide it is.
    """
    if not times or times[0] < 0 or any(b <= a for a, b in pairwise(times)):
        raise ValueError("times: got a sequence that is empty, negative or not increasing")
    try:
        plan, reason = plan_for(inputs, times[-1], radius, method, lost), "nothing tried"
    except (ArithmeticError, ValueError) as error:
        advice = "Its numbers are too far apart: check lengths, rates and angles."
        raise UnreachableError(
            f"enclosure: no precision can be chosen for this scene; {error}.", advice
        ) from None
    for _ in range(ATTEMPTS):
        try:
            run = _Run(inputs, plan, list(times), radius, zeros, progress, flint_only, function)
            return run.prove(approximant)
        except _TooWide as error:
            reason, bits = str(error), max(error.bits, plan.bits + LEAST_RAISE)
        except (ArithmeticError, ValueError) as error:
            # a bound that is not finite, a matrix without inverse, a step that does not join
            reason, bits = f"at {plan.bits} bits: {error}", plan.bits * 4 // 3
        plan = plan._replace(bits=bits)
        if plan.bits > MAX_BITS:
            break
    raise UnreachableError(
        f"enclosure: no bound of {short(radius)} m at {float(times[-1]):g} s; {reason}.",
        "Ask for fewer digits or a shorter time.",
    )


@dataclass
class _Run:
    """One attempt at one precision."""

    inputs: Any
    plan: ProofPlan
    times: list[Fraction]
    radius: Fraction
    zeros: tuple[str, ...]
    progress: Callable[[float], None] | None
    flint_only: bool
    function: bool

    def prove(self, approximant: Approximant) -> Enclosure:
        """Prove all steps; raise _TooWide if a state is known less closely than to the radius."""
        steps, end = iter(approximant(self.plan.bits)), self.times[-1]
        first = next(steps, None)
        if first is None:
            raise UnreachableError("enclosure: the approximant is empty.")
        bits, order = first.bits, len(first.coefficients[0]) - 1
        balls = SceneBalls(self.inputs, bits + SCENE_GUARD_BITS, self.flint_only)
        columns = ColumnSource(balls) if self.plan.method == "columns" else None
        course = Course(balls, self.times, columns is not None, self.zeros)
        if self.flint_only:
            course.followers.append(SumsChecked())
        fit, steps, count, known, spent = None, chain([first], steps), 0, 0, 0.0
        # a proof rests on the code of a function only where it has one
        if self.function:
            from .fit import FunctionFit, on_doubles

            fit, steps = (
                FunctionFit(course),
                on_doubles(steps),
            )  # the same polynomials, each ended at the double below its end
        for step in until(steps, end):
            begun = process_time()
            course.advance(
                step,
                *([columns.propose(step, [_log(z) for z in course.bound.z])] if columns else []),
            )
            if fit:
                fit.add()
            spent += process_time() - begun
            count += 1
            if len(course.states) > known:
                known = len(course.states)
                self._check_widths(course.states[-1:], self.times[known - 1], USELESS, bits)
            if self.progress:
                self.progress(float((step.centre + step.h * step.high) / end) if end else 1.0)
        # the proof of a function finishes the course, and hands on what that has proved
        begun, function = process_time(), fit.finish() if fit else None
        proved = function.proved if function else course.finish()
        position, velocity = self._check_widths(proved.states, end, 1, bits)
        spent += process_time() - begun
        return Enclosure(
            proved, bits, order, count, self.plan.method, position, velocity, spent, function
        )

    def _check_widths(
        self, states: Sequence[State], time: Fraction, factor: int, bits: int
    ) -> list[Fraction]:
        """Return the largest half-widths of position and velocity up to `time`; raise _TooWide above `factor` radii."""
        widths = [[(i.high - i.low) / 2 for i in row] for row in states]
        position, velocity = (
            max(max(row[part]) for row in widths) for part in (slice(3), slice(3, 6))
        )
        if max(position, velocity) > factor * self.radius:
            missing = magnitude(max(position, velocity) / self.radius) + 6
            # what the rest of the run will lose, if it is like what lies behind
            lost = max(0, bits + magnitude(position / self.inputs.length))
            missing += ceil(lost * (self.times[-1] - time) / time) if time else lost
            reason = f"{bits} bits gave {short(position)} m and {short(velocity)} m/s ({self.plan.method})"
            raise _TooWide(reason, bits + 8 * ceil(missing / 8))
        return [position, velocity]


def check_gates(inputs: Any, words: tuple[str, ...]) -> None:
    """Refuse gates of a scene that no precision encloses, before any work.

    Raises:
        InputError: as `demand_rest_positions`.
    """
    # of other faults of a scene the proof tells the reason
    with suppress(ArithmeticError, ValueError):
        demand_rest_positions(SceneBalls(inputs, LOOK_BITS), words)


def demand_rest_positions(balls: SceneBalls, words: tuple[str, ...]) -> None:
    """Refuse gates whose rest position cannot be singled out (Lemma 13.3).

    Raises:
        InputError: it names the gate.
    """
    sections = [word for word in words if word != XDOT]
    if sections:
        from .trusted.sections import form

    for word in sections:
        try:
            form(balls, word)
        except ArithmeticError:
            reason = "in so fast a rotation a proof singles none out, unlike lower levels"
            raise gate_without_rest(word, reason) from None


def plan_for(
    inputs: Any, end: Fraction, radius: Fraction, method: str | None, lost: Lost | None = None
) -> ProofPlan:
    """Choose method and precision for balls of `radius` at `end`.

    Raises:
        UnreachableError: it would take more than MAX_BITS.
    """
    balls = SceneBalls(inputs, LOOK_BITS)
    w, span = float(balls.w0), float(end)
    loss = (
        span
        * float(max(balls.lambda_minus, balls.lambda_plus + balls.S**2, key=float))
        / (2 * w)
        / 0.693
    )
    target = magnitude(inputs.length / radius) + log2(2 + span * w)
    cheap = (
        target + MARGIN_BITS + loss <= RADIUS_BITS or loss <= RADIUS_SHARE * target + MARGIN_BITS
    )
    method = method or ("radius" if cheap else "columns")
    extra = loss if method == "radius" else COLUMN_MARGIN_BITS + 2 * log2(2 + span * w) / 2
    bits = max(LEAST_BITS, 8 * ceil((target + MARGIN_BITS + extra) / 8))
    bits += lost(bits) if lost and method == "radius" else 0
    if bits > MAX_BITS:
        reason = f"enclosure: {short(radius)} m would take more than {MAX_BITS} bits."
        raise UnreachableError(reason, "Ask for fewer digits.")
    return ProofPlan(method, bits)


def magnitude(ratio: Fraction) -> int:
    """Return the logarithm to base 2, about."""
    return ratio.numerator.bit_length() - ratio.denominator.bit_length()


def short(x: Fraction) -> str:
    """Return a number with two digits, even one that a float cannot hold."""
    return f"{Decimal(x.numerator) / Decimal(x.denominator):.1e}"


def until(steps: Iterable[TaylorStep], end: Fraction) -> Iterator[TaylorStep]:
    """Yield the steps up to the end of the run, the last one cut there."""
    for step in steps:
        if step.centre + step.h * step.high >= end:
            high = (end - step.centre) / step.h
            # a run of no duration ends where it starts, but a step must have a length
            yield step._replace(high=high if high > step.low else step.low + Fraction(1, 1 << 20))
            return
        yield step
    raise UnreachableError(f"enclosure: the approximant ends before {float(end):g} s.")


def _log(z: arb) -> float:
    return float(z.log()) if z > 0 else TINY
