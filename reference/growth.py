"""What rounding does to a scene: its growth over the run, measured, and the bits that digits need.

A double run of `momentum` beside a long double run shows what is lost between release and end.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from .errors import UnreachableError
from .precision import DOUBLE, LONG_DOUBLE, NumberType, decimals_for, real
from .runs import Plan, run
from .scene import Inputs
from .solution import grid_decimals

MARGIN_BITS = 14  # a run aims this far below the last digit, so that rounding is rarely in doubt
CLOSE_TRANSIT_BITS = 12  # what the time of a day's worst conditioned transit loses against xdot
ESTIMATE_FACTOR = 16  # a single run's error is estimated from the pilot's, with this in hand
LEAST_ULPS = 4  # and is never estimated below this many units in the last place
LEAST_LOOKS = 64  # times at which the pilot runs are compared at least, so that none is small by luck
MAX_PREC = 8192


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
    return math.ceil(math.log2(ratio)) if ratio > 0 else 0


def measure_growth(inputs: Inputs, times: tuple[Fraction, ...]) -> Growth:
    """Compare two cheap runs of `momentum`, finer ones if the first are wholly lost.

    Raises:
        UnreachableError: even `MAX_PREC` bits keep no digit.
    """
    pair: tuple[NumberType, NumberType] = (DOUBLE, LONG_DOUBLE)
    if len(times) <= LEAST_LOOKS:
        times = tuple(times[-1] * k / LEAST_LOOKS for k in range(LEAST_LOOKS + 1))
    while pair[1].prec <= MAX_PREC:
        coarse, fine = (run(Plan(inputs, "momentum", number, times, transits=False)) for number in pair)
        errors = disagreement(coarse.grid, coarse.scale, fine.grid, fine.scale)[:6]
        largest = largest_of(fine.grid, fine.scale)[:6]
        scale = max(largest[:3]), max(largest[3:])
        lost = any(error > Fraction(1, 2**12) * scale[i // 3] for i, error in enumerate(errors))
        if not lost:
            return Growth(pair[0].prec, errors, largest, coarse.tension, coarse.cpu_s + fine.cpu_s, coarse.steps)
        pair = (pair[1], real(2 * pair[1].prec))
    raise UnreachableError(
        f"Rounding grows so fast that {MAX_PREC} bits keep no digit.", "Ask for a shorter run: run.t_end."
    )


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
