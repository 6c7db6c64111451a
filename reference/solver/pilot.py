"""Pilot runs: how fast rounding errors grow on a scene, and the bits and steps a result will need.

A run of `momentum` in double beside one in long double shows how many digits are lost between release and end. A scene
that would take too many steps, because it is stiff or long, is refused before that, by the pace of its first steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from ..columns import GRID, HORIZONTAL, POSITION, VELOCITY
from ..engines.plan import Plan
from ..engines.registry import run
from ..errors import BeyondDoublesError, UnreachableError
from ..inputs import Inputs
from ..precision import DOUBLE, LONG_DOUBLE, NumberType, decimals_for, real
from ..table import Table, bits_in, decimals_of, resolved
from .reach import MAX_PREC, MAX_STEPS, check_pace, effort

if TYPE_CHECKING:
    from ..engines.heyoka.stepper import Stepper

MARGIN_BITS = 14  # a run's error stays this many bits below the last digit, so that rounding is rarely in doubt
CLOSE_TRANSIT_BITS = 12  # bits that the time of a day's worst conditioned transit loses against xdot
ESTIMATE_FACTOR = 16  # safety factor from the pilot's error to that of a run which no second one checks
LEAST_ULPS = 4  # and that error is never taken below this many units in the last place
LEAST_TIMES = 64  # the pilot runs are compared at more times than this, so that no error is small by luck
LOST = Fraction(1, 1 << 12)  # an error above this part of the largest position or speed leaves no digit
PILOT_GAP_BITS = 64  # bits between the two pilot runs in `real`
FIRST_PART = 16  # of a long run that is compared later itself, the finer pilot run computes this part
GROWTH = FIRST_PART**2  # until then errors are taken to grow like the square of the time
ZERO_PREC = 512  # bits from which a position or velocity that shrinks with the precision is taken for zero


@dataclass(frozen=True)
class Pilot:
    """How rounding errors grow on a scene.

    Attributes:
        prec: bits of the coarser pilot run.
        errors: its largest error in each column of the grid, in SI units.
        largest: largest number in each column of the grid.
        tension: least tension of the cord over l, in 1/s²; negative where a rod is pushed.
        cpu_s: CPU seconds of both runs.
        steps: steps of the coarser run.
    """

    prec: int
    errors: dict[str, Fraction]
    largest: dict[str, Fraction]
    tension: float
    cpu_s: float
    steps: int

    @property
    def sizes(self) -> dict[str, Fraction]:
        """Size of each column: its largest number, or that of its kind if the column is only rounding noise."""
        return resolved(self.largest, self.errors)

    @property
    def cautious(self) -> dict[str, Fraction]:
        """Errors to assume where no second run checks them: with a safety factor, a floor, and the same for x and y."""
        floored = {
            name: ESTIMATE_FACTOR * max(error, LEAST_ULPS * self.largest[name] / 2**self.prec)
            for name, error in self.errors.items()
        }
        return {name: max(floored[one] for one in HORIZONTAL.get(name, (name,))) for name in floored}

    def estimates(self, prec: int) -> dict[str, Fraction]:
        """Return the errors to state for a single run at a precision."""
        return {name: error * Fraction(2) ** (self.prec - prec) for name, error in self.cautious.items()}

    def compared(self, rough: Table, fine: Table, length: Fraction) -> Pilot | None:
        """Return the pilot with the errors of its coarser run against a better one; None if that keeps no digit."""
        errors, largest = fine.distance(rough).largest(), fine.largest()
        return None if _lost(errors, largest, length, self.prec) else replace(self, errors=errors, largest=largest)

    def decimals(self, digits: int) -> dict[str, int]:
        """Return the decimals of each column with which its largest number has `digits` significant digits."""
        return decimals_of(self.sizes, digits)

    def bits_for(self, digits: int, t_end: Fraction | None, *, checked: bool) -> int:
        """Return the bits with which every column's error stays `MARGIN_BITS` below its last digit.

        Args:
            digits: significant digits of each column's largest number.
            t_end: end of the run in s if the times of transits need their digits too, else None.
            checked: whether a second run will check the result; if not, `cautious` errors are assumed.
        """
        needed = 0
        expected = self.errors if checked else self.cautious
        for name, places in self.decimals(digits).items():
            unit = Fraction(1, 10**places)
            if expected[name]:
                needed = max(needed, self.prec + bits_in(expected[name] / unit) + MARGIN_BITS)
            elif self.largest[name]:
                needed = max(needed, bits_in(self.largest[name] / unit) + MARGIN_BITS)
        if t_end is not None:
            ratio = expected["vx"] * 10 ** decimals_for(t_end, digits)
            needed = max(needed, self.prec + bits_in(ratio) + CLOSE_TRANSIT_BITS)
        return needed


def run_pilot(inputs: Inputs, times: tuple[Fraction, ...]) -> Pilot:
    """Measure rounding errors from two cheap runs of `momentum`, in higher precision if the first keep no digit.

    Raises:
        UnreachableError: the run takes too many steps, or rounding grows so fast that no affordable run keeps a digit.
    """
    if len(times) <= LEAST_TIMES:
        times = tuple(times[-1] * k / LEAST_TIMES for k in range(LEAST_TIMES + 1))
    pair: tuple[NumberType, NumberType] = (DOUBLE, LONG_DOUBLE)
    look_ahead: Callable[[Stepper], None] | None = partial(check_pace, inputs, times[-1])
    last_prec, good_until, steps = 0, Fraction(0), 0
    while pair[1].prec <= MAX_PREC and effort(steps, pair[1].prec) <= MAX_STEPS:
        try:
            coarse, fine = (
                run(Plan(inputs, "momentum", number, times, transits=False), look_ahead=check)
                for number, check in zip(pair, (look_ahead, None), strict=True)
            )
        except OverflowError:
            raise BeyondDoublesError from None
        look_ahead, steps, prec = None, coarse.steps, pair[0].prec
        grid = fine.grid.only(GRID)
        gaps, largest = grid.distance(coarse.grid), grid.largest()
        errors = gaps.largest()
        if not _lost(errors, largest, inputs.length, prec):
            return Pilot(prec, errors, largest, coarse.tension, coarse.cpu_s + fine.cpu_s, steps)
        last, good_until = (last_prec, good_until), _good_until(gaps, times, largest)
        next_prec = max(2 * LONG_DOUBLE.prec, 2 * prec, _extrapolated_prec(last, (prec, good_until), times[-1]))
        pair, last_prec = (real(next_prec), real(next_prec + PILOT_GAP_BITS)), prec
    raise UnreachableError(
        f"Rounding grows so fast that runs keep no digit beyond t = {float(good_until):.3g} s; "
        f"to the end it takes about {pair[0].prec} bits, which is out of reach.",
        "Ask for a shorter run: run.t_end.",
    )


def begun_pilot(inputs: Inputs, times: tuple[Fraction, ...]) -> tuple[Pilot, Table | None]:
    """Measure rounding errors over the first part of a long run alone, and take them to grow with the time.

    Returns:
        The pilot, and the states of the run in double at `times`, by which `Pilot.compared` measures the errors of all
        of it when a better run is there. They are None, and the pilot that of `run_pilot`, if there are few times, or
        if double keeps no digit.

    Raises:
        UnreachableError: as `run_pilot`.
    """
    part = len(times) // FIRST_PART
    if part <= LEAST_TIMES:
        return run_pilot(inputs, times), None
    begun = run_pilot(inputs, times[: part + 1])
    errors = {name: GROWTH * error for name, error in begun.errors.items()}
    if begun.prec > DOUBLE.prec or _lost(errors, begun.largest, inputs.length, begun.prec):
        return run_pilot(inputs, times), None
    plan = Plan(inputs, "momentum", DOUBLE, times, transits=False)
    try:
        rough = run(plan, look_ahead=partial(check_pace, inputs, times[-1]))
    except OverflowError:
        raise BeyondDoublesError from None
    grid = rough.grid.only(GRID)
    cpu_s = begun.cpu_s + rough.cpu_s
    return Pilot(DOUBLE.prec, errors, grid.largest(), rough.tension, cpu_s, rough.steps), grid


def _lost(errors: dict[str, Fraction], largest: dict[str, Fraction], length: Fraction, prec: int) -> bool:
    """Return whether position or velocity keeps no digit; one that shrinks with the precision is zero, not lost."""
    parts = [tuple(max(of[name] for name in kind) for of in (errors, largest)) for kind in (POSITION, VELOCITY)]
    zero = length / 2 ** (prec // 2) if prec >= ZERO_PREC else Fraction(0)
    return any(error > size * LOST and size > zero for error, size in parts)


def _extrapolated_prec(last: tuple[int, Fraction], now: tuple[int, Fraction], end: Fraction) -> int:
    """Return the bits that keep a digit to the end, from two precisions and how long each kept one; 0 if unknown.

    The pair in double is not used: a single fall from the top may cost all its digits, and what follows little.
    """
    (less, sooner), (more, later) = last, now
    if less <= LONG_DOUBLE.prec or later <= sooner:
        return 0
    return math.ceil(more + (end - later) * (more - less) / (later - sooner))


def _good_until(gaps: Table, times: tuple[Fraction, ...], largest: dict[str, Fraction]) -> Fraction:
    """Return the time in s until which both position and velocity keep a digit."""
    most = {name: LOST * max(largest[one] for one in kind) for kind in (POSITION, VELOCITY) for name in kind}
    columns = [(gaps.exact(name), limit) for name, limit in most.items()]
    lost = (i for i in range(len(times)) if any(column[i] > limit for column, limit in columns))
    first = next(lost, len(times))
    return times[first - 1] if first else Fraction(0)
