"""A run with event detection beside a proof: it must find the zeros that were proved, and nothing rests on it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

from ..engines.plan import Plan, Run
from ..engines.registry import run
from ..errors import IntegrationError, UnreachableError
from ..numbers.columns import POSITION, VELOCITY
from ..numbers.precision import cheapest_type
from ..numbers.table import Table, bits_in
from ..numbers.zeros import XDOT, Zeros
from .agreement import with_zero_errors
from .pilot import ESTIMATE_FACTOR, Pilot, second_order_bits
from .proving import EVALUATION_BITS
from .solution import CrossCheck, Solution

USUAL_DIGITS, FINER_DIGITS = 7, 27  # of the run with event detection, at first and on a second try
MOST_CHECK_PREC = 1024  # bits of a run with event detection; one that would need more is not made
SEEN_BITS = 12  # xdot has this many bits beside a transit in such a run


def guarded(solution: Solution, pilot: Pilot) -> Solution:
    """Have a run with event detection, in the cheapest type that serves, see the transits of a proved solution.

    What it measures is not the same on every machine, and goes into no dataset.

    Returns:
        The solution with that run as its `guard`, or with the reason why it could not be made.

    Raises:
        IntegrationError: the run finds other transits; names the first that differs.
    """
    scene, times = solution.scene, solution.times
    if not solution.zeros:
        return solution
    usual, finer = (
        pilot.bits_for(digits, times[-1], checked=False) for digits in (USUAL_DIGITS, FINER_DIGITS)
    )
    least, more = _bits_to_see(solution.transits, times[-1], pilot), second_order_bits(scene, pilot)
    contradiction: IntegrationError | None = None
    units = {name: Fraction(1, 10**places) for name, places in pilot.decimals(USUAL_DIGITS).items()}
    for prec in (max(usual + more, least), max(finer + more, least + finer - usual)):
        if prec > MOST_CHECK_PREC:
            reason: Exception = UnreachableError(
                f"A run would take {prec} bits to see transits so flat."
            )
            break
        try:
            event_run = run(
                Plan(scene.exact, "momentum", cheapest_type(prec), times, tuple(solution.zeros))
            )
        except (UnreachableError, OverflowError) as error:
            reason = error
            break
        gaps = solution.grid.distance(event_run.grid).largest()
        try:
            if any(gaps[name] > unit for name, unit in units.items()):
                raise IntegrationError(
                    f"heyoka's states are {float(max(gaps.values())):.1e} from the enclosure."
                )
            apart = _zero_gaps(event_run, solution, _between_rows(gaps))
        except (
            IntegrationError
        ) as error:  # the motion may amplify errors too much for so few digits
            contradiction = reason = error
            solution = replace(solution, discarded_s=solution.discarded_s + event_run.cpu_s)
        else:
            return replace(solution, guard=CrossCheck.by(event_run, gaps, apart.get(XDOT)))
    if contradiction is not None:
        raise contradiction
    return replace(solution, not_checked=str(reason))


def _between_rows(gaps: Mapping[str, Fraction]) -> dict[str, Fraction]:
    """Return how far a run may be off in each column, from how far it is at the grid's rows.

    From one row to the next the swing turns an error in one column into one in the others of its kind.
    """
    largest = {kind: max(gaps[name] for name in kind) for kind in (POSITION, VELOCITY)}
    return {name: ESTIMATE_FACTOR * gap for kind, gap in largest.items() for name in kind}


def _zero_gaps(
    event_run: Run, solution: Solution, errors: Mapping[str, Fraction]
) -> dict[str, Fraction]:
    """Return by word how far the zeros that a run found are from the enclosed ones, at most, in s.

    `errors` are how far its states may be off.

    Raises:
        IntegrationError: the run finds other zeros.
    """
    gaps = {}
    for word, zeros in solution.zeros.items():
        seen = with_zero_errors(event_run, errors, word, None)
        found = event_run.zeros[word]._replace(table=seen)
        gaps[word] = _zero_gap(word, zeros, found, event_run.plan.number.prec)
    return gaps


def _bits_to_see(transits: Table, end: Fraction, pilot: Pilot) -> int:
    """Return the bits at which xdot between any two transits is far above a run's rounding errors."""
    if not len(transits):
        return 0
    unit = 1 << transits.bits
    times = [0, *transits.whole("t", transits.bits), math.floor(end * unit)]
    apart = min((b - a for a, b in pairwise(times) if b > a), default=times[-1])
    least = Fraction(min(map(abs, transits.whole("ax", transits.bits))) * apart, unit**2)
    return (
        pilot.prec + bits_in(pilot.cautious["vx"] / least) + SEEN_BITS
        if least
        else MOST_CHECK_PREC + 1
    )


def _zero_gap(word: str, zeros: Zeros[Table], found: Zeros[Table], prec: int) -> Fraction:
    """Return how far the zeros that a run found are from the enclosed ones, at most, in s.

    Args:
        word: of the zeros.
        zeros: the enclosed ones.
        found: those of the run, with errors; there may be others where some are undecided.
        prec: bits of the run.

    Raises:
        IntegrationError: the run has others.
    """
    name = "transit" if word == XDOT else f"{word} passage"
    seen = found.table
    if len(seen) != len(zeros.directions) and not zeros.possible:
        raise IntegrationError(
            f"heyoka finds {len(seen)} {name}s, the enclosure {len(zeros.directions)}."
        )
    bits = max(zeros.table.bits, seen.bits)
    rounding = zeros.table.largest()["t"] * Fraction(2) ** (EVALUATION_BITS - prec)
    late = [math.floor((bound + rounding) * 2**bits) for bound in seen.bound("t")]
    remaining = iter(zip(seen.whole("t", bits), late, found.directions, strict=True))
    bounds = [math.ceil(bound * 2**bits) for bound in zeros.table.bound("t")]
    gaps = [0]
    rows = zip(zeros.table.whole("t", bits), bounds, zeros.directions, strict=True)
    for k, (t, bound, direction) in enumerate(rows, 1):
        near = (
            abs(t - time)
            for time, off, sign in remaining
            if sign == direction and abs(t - time) <= bound + off
        )
        gap = next(near, None)
        if gap is None:
            raise IntegrationError(
                f"heyoka does not find {name} {k} of the enclosure, at t = {t / 2**bits} s."
            )
        gaps.append(gap)
    return Fraction(max(gaps), 2**bits)
