"""What a scene asks of a run: how rounding grows over it, the bits that digits need, the steps it takes.

A double run of `momentum` beside a long double run shows what is lost between release and end. Before it the pace of
its first steps is looked at: an explicit method is slow where the scene is stiff, and says so before it starts.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, cast

from ..engines.plan import Plan, Run
from ..engines.run import run
from ..errors import UnreachableError
from ..model.constants import constants
from ..precision import DOUBLE, LONG_DOUBLE, NumberType, context, decimals_for, real
from ..scene import Inputs
from .solution import NOISE, grid_decimals

if TYPE_CHECKING:
    from ..engines.heyoka.taylor import Stepper

MARGIN_BITS = 14  # a run aims this far below the last digit, so that rounding is rarely in doubt
CLOSE_TRANSIT_BITS = 12  # what the time of a day's worst conditioned transit loses against xdot
ESTIMATE_FACTOR = 16  # a single run's error is estimated from the pilot's, with this in hand
LEAST_ULPS = 4  # and is never estimated below this many units in the last place
LEAST_LOOKS = 64  # times at which the pilot runs are compared at least, so that none is small by luck
PARTED = Fraction(1, 64)  # twins further apart than this, against the column's size, no longer measure a slope
MAX_PREC = 8192
MAX_STEPS = 1 << 24  # at 160 bits or less: a year of Paris, three CPU hours
LOST = Fraction(1, 1 << 12)  # an error of this part of the largest position or speed: no digit is kept
FINER_LOOK = 64  # bits between two pilot runs in `real`
ZERO_PREC = 512  # bits from which noise is taken for a zero
LOOK_STEPS = 1 << 16  # of which this many show the pace
SETTLED = 10  # with drag the pace may change until so many of its times have passed


Quadruple = tuple[Fraction, Fraction, Fraction, Fraction]


@dataclass(frozen=True)
class Growth:
    """What a run at `prec` bits loses on this scene: its largest error per grid column, in m and m/s."""

    prec: int
    errors: tuple[Fraction, ...]
    largest: tuple[Fraction, ...]
    tension: float
    cpu_s: float
    steps: int

    @property
    def sizes(self) -> tuple[Fraction, ...]:
        """What a change of a column is measured by: its largest number, or of its kind where it is only rounding."""
        resolved = [size if size > NOISE * error else 0 for size, error in zip(self.largest, self.errors, strict=True)]
        return tuple(Fraction(size or max(resolved[i // 3 * 3 :][:3])) for i, size in enumerate(resolved))

    @property
    def cautious(self) -> tuple[Fraction, ...]:
        """The errors where no second run will check them: with a factor, a floor, and x and y taken together."""
        floored = [
            ESTIMATE_FACTOR * max(error, LEAST_ULPS * largest / 2**self.prec)
            for error, largest in zip(self.errors, self.largest, strict=True)
        ]
        x, y, z, vx, vy, vz = floored
        return (max(x, y), max(x, y), z, max(vx, vy), max(vx, vy), vz)

    def estimates(self, prec: int) -> tuple[Fraction, ...]:
        """The errors to state for a single run at a precision."""
        return tuple(error * Fraction(2) ** (self.prec - prec) for error in self.cautious)

    def bits_for(self, digits: int, t_end: Fraction | None, *, checked: bool) -> int:
        """Bits with which every column's error stays `MARGIN_BITS` below its last digit.

        Args:
            digits: significant digits of each column's largest number.
            t_end: where given, the times of transits up to then are a column too.
            checked: whether another run will check the result, so that a guess by column will do.
        """
        needed = 0
        expected = self.errors if checked else self.cautious
        decimals = grid_decimals(self.largest, self.errors, digits)
        for error, largest, places in zip(expected, self.largest, decimals, strict=True):
            unit = Fraction(1, 10**places)
            if error:
                needed = max(needed, self.prec + bits_in(error / unit) + MARGIN_BITS)
            elif largest:
                needed = max(needed, bits_in(largest / unit) + MARGIN_BITS)
        if t_end is not None:
            late = expected[3] * 10 ** decimals_for(t_end, digits)
            needed = max(needed, self.prec + bits_in(late) + CLOSE_TRANSIT_BITS)
        return needed


def bits_in(ratio: Fraction) -> int:
    """The power of two at or above a ratio; 0 for nothing."""
    if ratio <= 0:
        return 0
    power = ratio.numerator.bit_length() - ratio.denominator.bit_length()
    return power if ratio <= Fraction(2) ** power else power + 1


def measure_growth(inputs: Inputs, times: tuple[Fraction, ...]) -> Growth:
    """Compare two cheap runs of `momentum`, finer ones if the first are wholly lost.

    Raises:
        UnreachableError: the run takes too many steps, or rounding grows so fast that no affordable run keeps a digit.
    """
    if len(times) <= LEAST_LOOKS:
        times = tuple(times[-1] * k / LEAST_LOOKS for k in range(LEAST_LOOKS + 1))
    pair: tuple[NumberType, NumberType] = (DOUBLE, LONG_DOUBLE)
    look_ahead: Callable[[Stepper], None] | None = partial(check_pace, inputs, times[-1])
    lost_at, kept, steps = 0, Fraction(0), 0
    while pair[1].prec <= MAX_PREC and effort(steps, pair[1].prec) <= MAX_STEPS:
        try:
            coarse, fine = (
                run(Plan(inputs, "momentum", number, times, transits=False), look_ahead=look)
                for number, look in zip(pair, (look_ahead, None), strict=True)
            )
        except OverflowError:
            raise UnreachableError(
                "A length, force, rate or time of the scene is beyond the range of binary64."
            ) from None
        look_ahead, steps, prec = None, coarse.steps, pair[0].prec
        errors = disagreement(coarse.grid, coarse.scale, fine.grid, fine.scale)[:6]
        largest = largest_of(fine.grid, fine.scale)[:6]
        if not _lost(errors, largest, inputs.length, prec):
            return Growth(prec, errors, largest, coarse.tension, coarse.cpu_s + fine.cpu_s, steps)
        before, kept = (lost_at, kept), _kept_until(coarse, fine, largest)
        wanted = max(2 * LONG_DOUBLE.prec, 2 * prec, _at_that_rate(before, (prec, kept), times[-1]))
        pair, lost_at = (real(wanted), real(wanted + FINER_LOOK)), prec
    raise UnreachableError(
        f"Rounding grows so fast that runs keep no digit beyond t = {float(kept):.3g} s; "
        f"to the end it takes about {pair[0].prec} bits, which is out of reach.",
        "Ask for a shorter run: run.t_end.",
    )


def _lost(errors: tuple[Fraction, ...], largest: tuple[Fraction, ...], length: Fraction, prec: int) -> bool:
    """Whether position or velocity keeps no digit; one that shrinks with the precision for ever is zero, not lost."""
    parts = [(max(errors[i : i + 3]), max(largest[i : i + 3])) for i in (0, 3)]
    zero = length / 2 ** (prec // 2) if prec >= ZERO_PREC else Fraction(0)
    return any(error > size * LOST and size > zero for error, size in parts)


def _at_that_rate(before: tuple[int, Fraction], now: tuple[int, Fraction], end: Fraction) -> int:
    """Bits that keep a digit to the end, from two precisions and how long each kept one; 0 if the two do not tell.

    What only double loses tells nothing: a single fall from the top may cost that much, and the rest little.
    """
    (less, sooner), (more, later) = before, now
    if less <= LONG_DOUBLE.prec or later <= sooner:
        return 0
    return math.ceil(more + (end - later) * (more - less) / (later - sooner))


def _kept_until(coarse: Run, fine: Run, largest: tuple[Fraction, ...]) -> Fraction:
    """Until when, in s, both position and velocity keep a digit."""
    sizes = [max(largest[i : i + 3]) for i in (0, 0, 0, 3, 3, 3)]
    kept = Fraction(0)
    for t, a, b in zip(coarse.plan.times, coarse.grid, fine.grid, strict=True):
        gaps = disagreement([a], coarse.scale, [b], fine.scale)
        if any(gap > size * LOST for gap, size in zip(gaps, sizes, strict=False)):
            break
        kept = t
    return kept


def effort(steps: int, prec: int) -> int:
    """Steps at 160 bits that take as long: a step's cost grows with the cube of the bits."""
    return steps * max(1, prec // 32) ** 3 // 125


def digits_lost(inputs: Inputs, times: tuple[Fraction, ...], growth: Growth | None = None) -> float:
    """Decimal digits that the flow costs: n digits of every result take n + this many digits of the inputs.

    Twin runs whose inputs differ by a relative 2**-26, once in the release and once in all the constants, drift
    apart. What counts is the column that suffers most, its change over its largest number; an input that is zero or
    a latitude where a term vanishes is taken as exact. Where the twins part company wholly, finer ones are sent.

    Args:
        inputs: the exact inputs of a scene.
        times: increasing, from 0, in s.
        growth: as measured over `times`, to save two runs.

    Raises:
        UnreachableError: as `measure_growth`.
    """
    growth = growth or measure_growth(inputs, times)
    number = DOUBLE if growth.prec <= DOUBLE.prec else real(2 * LONG_DOUBLE.prec)
    while number.prec <= MAX_PREC:
        nudge = Fraction(1, 2 ** (number.prec // 2))
        base, *twins = (
            run(Plan(each, "momentum", number, times, transits=False))
            for each in (inputs, _other_release(inputs, nudge), _other_constants(inputs, nudge))
        )
        parted = [disagreement(base.grid, base.scale, twin.grid, twin.scale) for twin in twins]
        sizes = growth.sizes
        worst = max(change[i] / size for change in parted for i, size in enumerate(sizes) if size)
        if worst <= PARTED:
            ratio = worst / nudge
            return max(0.0, math.log10(ratio.numerator) - math.log10(ratio.denominator)) if ratio else 0.0
        number = LONG_DOUBLE if number is DOUBLE else real(2 * number.prec)
    raise UnreachableError(f"Twins part company wholly even at {MAX_PREC} bits.", "Ask for a shorter run: run.t_end.")


def _other_release(inputs: Inputs, nudge: Fraction) -> Inputs:
    """Each number of the release by its own factor; position and angle inwards, so that they stay on the sphere."""
    factors = (1 - nudge, 1 - nudge / 2, 1 + nudge, 1 - nudge)

    def changed(numbers: Quadruple | None) -> Quadruple | None:
        return numbers and cast("Quadruple", tuple(map(operator.mul, numbers, factors)))

    return replace(inputs, position=changed(inputs.position), angles=changed(inputs.angles))


def _other_constants(inputs: Inputs, nudge: Fraction) -> Inputs:
    """Each constant by a factor, those of the swing's frequency in opposite directions."""
    up, down = ("length", "rotation_rate", "altitude", "flattening"), ("gravity", "equatorial_radius", "drag")
    changed = {name: getattr(inputs, name) * (1 + nudge) for name in up}
    changed |= {name: getattr(inputs, name) * (1 - nudge) for name in down}
    latitude = inputs.latitude * (1 - nudge) if inputs.latitude % 90 else inputs.latitude
    return replace(inputs, latitude=latitude, **changed)


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


def largest_of(rows: Sequence[tuple[int, ...]], scale: int) -> tuple[Fraction, ...]:
    """Largest size of each column of a table of integers over 2**scale."""
    return tuple(Fraction(max(map(abs, column)), 2**scale) for column in zip(*rows, strict=True))


def disagreement(
    a: Sequence[tuple[int, ...]], a_scale: int, b: Sequence[tuple[int, ...]], b_scale: int
) -> tuple[Fraction, ...]:
    """Largest difference of two tables, per column."""
    up_a, up_b = max(0, b_scale - a_scale), max(0, a_scale - b_scale)
    columns = zip(zip(*a, strict=True), zip(*b, strict=True), strict=True)
    common = 2 ** max(a_scale, b_scale)
    return tuple(
        Fraction(max(abs((p << up_a) - (q << up_b)) for p, q in zip(one, other, strict=True)), common)
        for one, other in columns
    )
