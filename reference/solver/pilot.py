"""What a scene asks of a run: how rounding grows over it, the bits that digits need, the steps it takes.

A double run of `momentum` beside a long double run shows what is lost between release and end. Before it the pace of
its first steps is looked at: an explicit method is slow where the scene is stiff, and says so before it starts.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from ..engines.plan import Plan, Run
from ..engines.run import run
from ..errors import UnreachableError
from ..precision import DOUBLE, LONG_DOUBLE, NumberType, decimals_for, real
from ..scene import Inputs
from ..table import bits_in, disagreement, largest_of
from .reach import MAX_PREC, MAX_STEPS, check_pace, effort
from .rounding import NOISE, grid_decimals

if TYPE_CHECKING:
    from ..engines.heyoka.stepper import Stepper

MARGIN_BITS = 14  # a run aims this far below the last digit, so that rounding is rarely in doubt
CLOSE_TRANSIT_BITS = 12  # what the time of a day's worst conditioned transit loses against xdot
ESTIMATE_FACTOR = 16  # a single run's error is estimated from the pilot's, with this in hand
LEAST_ULPS = 4  # and is never estimated below this many units in the last place
LEAST_LOOKS = 64  # times at which the pilot runs are compared at least, so that none is small by luck
LOST = Fraction(1, 1 << 12)  # an error of this part of the largest position or speed: no digit is kept
FINER_LOOK = 64  # bits between two pilot runs in `real`
ZERO_PREC = 512  # bits from which noise is taken for a zero


@dataclass(frozen=True)
class Pilot:
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


def run_pilot(inputs: Inputs, times: tuple[Fraction, ...]) -> Pilot:
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
        errors = disagreement(coarse.grid, coarse.bits, fine.grid, fine.bits)[:6]
        largest = largest_of(fine.grid, fine.bits)[:6]
        if not _lost(errors, largest, inputs.length, prec):
            return Pilot(prec, errors, largest, coarse.tension, coarse.cpu_s + fine.cpu_s, steps)
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
        gaps = disagreement([a], coarse.bits, [b], fine.bits)
        if any(gap > size * LOST for gap, size in zip(gaps, sizes, strict=False)):
            break
        kept = t
    return kept
