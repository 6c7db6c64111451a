"""Clocks that did not start at the release.

Rows are counted from the first of them, if that is the release. Of passages the differences are
compared: what the clock showed at the release is fitted, as an interval.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np

from reference import InputError, Scene
from reference.errors import Described
from reference.model.start import Start
from reference.numbers.precision import DOUBLE_BITS, Array
from reference.solver.doubles import TOLERANCE

from ..candidates.candidate import Candidate, Deviation
from ..candidates.clock import shown

Ends = tuple[Fraction, Fraction]

_MOST_PLACES = 9  # of a time in s
SUBTRACT = "Subtract what the clock showed at the release."


def counted_from_release(
    candidate: Candidate, scene: Scene, tolerance_m: float | None
) -> Candidate:
    """Return a candidate of which all times, also of transits, are since the release.

    No row is changed whose times may be since the release already. Times from beyond the scene's
    end on, or of a clock's text, are counted from the first row: this is the release if it has its
    position.

    Args:
        candidate: rows of positions.
        scene: the problem.
        tolerance_m: how far the first row may be off the release; None for `TOLERANCE` of its
            distance from the vertical.

    Raises:
        InputError: the first row is elsewhere, so that the time of the release is not known.
    """
    clock_s = candidate.clock_s
    if clock_s is None and _started_elsewhere(candidate.t, scene):
        clock_s = float(candidate.t[0])
        candidate = replace(candidate, t=_since(clock_s, candidate.t), clock_s=clock_s)
    if clock_s is None:
        return candidate

    release = [float(place) for place in Start.of(scene.exact, DOUBLE_BITS).position[:2]]
    allowed_m = TOLERANCE * math.hypot(*release) if tolerance_m is None else tolerance_m
    distance_m = math.dist((candidate.columns["x"][0], candidate.columns["y"][0]), release)
    if distance_m > allowed_m:
        got = Described(f"{shown(clock_s)} in the first row, {distance_m:.3g} m from the release")
        raise InputError(f"{candidate.name}: t", got, "times since the release", SUBTRACT)

    text = (
        f"the clock showed {shown(clock_s)} in the first row, which is at the release: "
        "times are counted from it"
    )
    transits = candidate.transits
    return replace(
        candidate,
        transits=None if transits is None else _since(clock_s, transits),
        conventions=(*candidate.conventions, Deviation("clock_start", text)),
    )


def _started_elsewhere(times: Array, scene: Scene) -> bool:
    """Return whether no time is in the scene's span, though all would fit into it.

    One time alone tells nothing.
    """
    end = float(scene.exact.t_end + scene.exact.grid_step)
    return bool(len(times) > 1 and times[0] > end and times[-1] - times[0] <= end)


def _since(clock_s: float, times: Array) -> Array:
    """Return times in s since another, each the nearest double to the difference of the decimals."""
    start = Fraction(repr(clock_s))
    return np.array([float(Fraction(repr(float(time))) - start) for time in times])


def clock_starts(times: Sequence[Fraction], intervals: Iterable[Ends]) -> list[Ends]:
    """Return what a clock may have shown at the release, as intervals in s, the nearest to 0 first.

    By such a clock each time lies in some interval. Two times or more are needed: one would fit at
    any.

    Args:
        times: of passages, by the clock, in s.
        intervals: of the passages since the release, in s.
    """
    true = _merged(intervals)
    if len(times) < 2 or not true:
        return []

    def starts_by(time: Fraction) -> list[Ends]:
        return [(time - high, time - low) for low, high in reversed(true)]

    possible = starts_by(times[0])
    for time in times[1:]:
        possible = list(_common(possible, starts_by(time)))
    return sorted(possible, key=lambda start: abs(start[0] + start[1]))


def starts_in_words(starts: Iterable[Ends]) -> str:
    """Return what a clock may have shown at the release, each end rounded outward."""
    return ", or ".join(f"{_outward(low, high)} s" for low, high in starts)


def _outward(low: Fraction, high: Fraction) -> str:
    """Return the ends of an interval with two digits of its width, each rounded away from it."""
    places = _MOST_PLACES
    if high > low:
        needed = 1 - math.floor(math.log10(high - low))
        places = min(_MOST_PLACES, max(0, needed))
    unit = Fraction(1, 10**places)
    below = float(math.floor(low / unit) * unit)
    above = float(math.ceil(high / unit) * unit)
    return f"{below:.{places}f} to {above:.{places}f}"


def _merged(intervals: Iterable[Ends]) -> list[Ends]:
    """Return the union of intervals as disjoint ones in order."""
    merged: list[Ends] = []
    for low, high in sorted(intervals):
        if merged and low <= merged[-1][1]:
            first, last = merged.pop()
            merged.append((first, max(high, last)))
        else:
            merged.append((low, high))
    return merged


def _common(first: Sequence[Ends], second: Sequence[Ends]) -> Iterator[Ends]:
    """Yield what two unions of disjoint intervals, in order, have in common."""
    i = k = 0
    while i < len(first) and k < len(second):
        low = max(first[i][0], second[k][0])
        high = min(first[i][1], second[k][1])
        if low <= high:
            yield low, high
        if first[i][1] < second[k][1]:
            i += 1
        else:
            k += 1
