"""A run with event detection beside a proof: it must find the zeros that were proved.

The proof does not rely on it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from typing import Any

from ..engines.plan import Plan, Report, Run
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

_USUAL_DIGITS = 7  # of the run with event detection
_FINER_DIGITS = 27  # of a second one, if the first fails
_MOST_CHECK_PREC = 1024  # bits of a run with event detection; one that would need more is not made
_SEEN_BITS = 12  # xdot has this many bits beside a transit in such a run


def guarded(solution: Solution, pilot: Pilot, report: Report | None = None) -> Solution:
    """Have a run with event detection find the zeros of a proved solution.

    It is made in the cheapest type that serves.

    What it measures is not the same on every machine, and goes into no dataset.

    Returns:
        The solution with that run as its `guard`, or with the reason why it could not be made.

    Raises:
        IntegrationError: the run finds other zeros; names the first that differs.
    """
    if not solution.zeros:
        return solution
    inputs = solution.scene.exact
    words = tuple(solution.zeros)
    contradiction: IntegrationError | None = None
    for prec in _precisions(solution, pilot):
        if prec > _MOST_CHECK_PREC:
            reason: Exception = UnreachableError(
                f"To resolve transits so close to a double zero, a run would need {prec} bits."
            )
            break
        try:
            plan = Plan(inputs, "momentum", cheapest_type(prec), solution.times, words)
            event_run = run(plan, report)
        except (UnreachableError, OverflowError) as error:
            reason = error
            break
        try:
            return replace(solution, guard=_check(event_run, solution, pilot))
        except IntegrationError as error:
            # the motion may amplify errors too much for so few digits
            contradiction = reason = error
            solution = replace(solution, discarded_s=solution.discarded_s + event_run.cpu_s)
    if contradiction is not None:
        raise contradiction
    return replace(solution, not_checked=str(reason))


def _precisions(solution: Solution, pilot: Pilot) -> tuple[int, int]:
    """Return the bits of a run with event detection, and of a second one if the first fails."""
    end = solution.times[-1]
    usual = pilot.bits_for(_USUAL_DIGITS, end, checked=False)
    finer = pilot.bits_for(_FINER_DIGITS, end, checked=False)
    least = _bits_to_see(solution.transits, end, pilot)
    more = second_order_bits(solution.scene, pilot)
    return max(usual + more, least), max(finer + more, least + finer - usual)


def _check(event_run: Run, solution: Solution, pilot: Pilot) -> CrossCheck:
    """Return a run with event detection as a check of a solution.

    Raises:
        IntegrationError: its states are too far from the enclosure, or it finds other zeros.
    """
    gaps = solution.grid.distance(event_run.grid).largest()
    for name, places in pilot.decimals(_USUAL_DIGITS).items():
        if gaps[name] > Fraction(1, 10**places):
            raise IntegrationError(
                f"heyoka's states differ from the enclosure by {float(max(gaps.values())):.1e}."
            )
    zero_gaps = _zero_gaps(event_run, solution, _between_rows(gaps))
    return CrossCheck.by(event_run, gaps, zero_gaps.get(XDOT))


def _between_rows(gaps: Mapping[str, Fraction]) -> dict[str, Fraction]:
    """Return how far a run may be off in each column, from how far it is at the grid's rows.

    From one row to the next the swing turns an error in one column into one in the others of its
    kind.
    """
    errors: dict[str, Fraction] = {}
    for kind in (POSITION, VELOCITY):
        error = ESTIMATE_FACTOR * max(gaps[name] for name in kind)
        errors |= dict.fromkeys(kind, error)
    return errors


def _zero_gaps(
    event_run: Run, solution: Solution, errors: Mapping[str, Fraction]
) -> dict[str, Fraction]:
    """Return by word the largest distance in s of the zeros of a run from the enclosed ones.

    `errors` is how far its states may be off.

    Raises:
        IntegrationError: the run finds other zeros.
    """
    gaps = {}
    for word, zeros in solution.zeros.items():
        table = with_zero_errors(event_run, errors, word, None)
        found = event_run.zeros[word]._replace(table=table)
        gaps[word] = _zero_gap(word, zeros, found, event_run.plan.number.prec)
    return gaps


def _bits_to_see(transits: Table, end: Fraction, pilot: Pilot) -> int:
    """Return the bits at which xdot between two transits is far above a run's rounding errors."""
    if not len(transits):
        return 0
    unit = 1 << transits.bits
    times = [0, *transits.whole("t", transits.bits), math.floor(end * unit)]
    shortest = min((b - a for a, b in pairwise(times) if b > a), default=times[-1])
    slope = min(map(abs, transits.whole("ax", transits.bits)))
    least_xdot = Fraction(slope * shortest, unit**2)
    if not least_xdot:
        return _MOST_CHECK_PREC + 1
    return pilot.prec + bits_in(pilot.cautious["vx"] / least_xdot) + _SEEN_BITS


def _zero_gap(word: str, zeros: Zeros[Table], found: Zeros[Table], prec: int) -> Fraction:
    """Return the largest distance of the zeros that a run found from the enclosed ones, in s.

    Args:
        word: of the zeros.
        zeros: the enclosed ones.
        found: those of the run, with errors; there may be others where some are undecided.
        prec: bits of the run.

    Raises:
        IntegrationError: the run has others.
    """
    name = "transit" if word == XDOT else f"{word} passage"
    if len(found.table) != len(zeros.directions) and not zeros.possible:
        raise IntegrationError(
            f"heyoka finds {len(found.table)} {name}s, but the proof finds {len(zeros.directions)}."
        )
    bits = max(zeros.table.bits, found.table.bits)
    rounding = zeros.table.largest()["t"] * Fraction(2) ** (EVALUATION_BITS - prec)
    errors = [math.floor((bound + rounding) * 2**bits) for bound in found.table.bound("t")]
    bounds = [math.ceil(bound * 2**bits) for bound in zeros.table.bound("t")]
    enclosed = zip(zeros.table.whole("t", bits), bounds, zeros.directions, strict=True)
    # those that come after the last one that was matched
    candidates = iter(zip(found.table.whole("t", bits), errors, found.directions, strict=True))

    largest = 0
    for k, (t, bound, direction) in enumerate(enclosed, 1):
        gap = _gap_of_the_next(candidates, t, bound, direction)
        if gap is None:
            raise IntegrationError(
                f"heyoka did not find {name} {k}, which the proof has at t = {t / 2**bits} s."
            )
        largest = max(largest, gap)
    return Fraction(largest, 2**bits)


def _gap_of_the_next(
    candidates: Iterator[tuple[Any, int, int]], t: Any, bound: int, direction: int
) -> int | None:
    """Return the distance of an enclosed zero from the next candidate that may be it.

    None if there is none.
    """
    for time, error, sign in candidates:
        gap = abs(t - time)
        if sign == direction and gap <= bound + error:
            return int(gap)
    return None
