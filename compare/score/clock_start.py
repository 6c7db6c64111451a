"""A candidate whose clock did not start at the release: its times are counted from its first row, if that is there."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from reference import InputError, Scene
from reference.model.start import Start
from reference.numbers.precision import DOUBLE_BITS, Array

from ..candidates.candidate import Candidate, Deviation
from ..candidates.clock import shown

TOLERANCE = 1e-6  # default tolerance, as a part of the amplitude
SUBTRACT = "Subtract what the clock showed at the release."


def counted_from_release(
    candidate: Candidate, transits: Array | None, scene: Scene, tolerance: float | None
) -> tuple[Candidate, Array | None]:
    """Return a candidate and its transits with times since the release.

    No row is changed whose times may be since the release already. Times from beyond the scene's end on, or of a clock's
    text, are counted from the first row: this is the release if it has its position.

    Args:
        candidate: rows of positions.
        transits: times by the same clock, in s, or None.
        scene: the problem.
        tolerance: how far the first row may be off the release, in m; None for `TOLERANCE` of its distance from the
            vertical.

    Raises:
        InputError: the first row is elsewhere, so that nobody can tell when the release was.
    """
    clock_s = candidate.clock_s
    if clock_s is None and started_elsewhere(candidate.t, scene):
        clock_s = float(candidate.t[0])
        candidate = replace(candidate, t=since(clock_s, candidate.t), clock_s=clock_s)
    if clock_s is None:
        return candidate, transits
    release = [float(place) for place in Start.of(scene.exact, DOUBLE_BITS).position[:2]]
    allowed_m = TOLERANCE * float(np.hypot(*release)) if tolerance is None else tolerance
    distance_m = float(np.hypot(candidate.columns["x"][0] - release[0], candidate.columns["y"][0] - release[1]))
    if distance_m > allowed_m:
        got = f"{shown(clock_s)} in the first row, {distance_m:.3g} m off the release"
        raise InputError(f"{candidate.name}: t", got, "times since the release", SUBTRACT)
    text = f"the clock showed {shown(clock_s)} in the first row, which is at the release: times are counted from it"
    conventions = (*candidate.conventions, Deviation("clock_start", text))
    shifted = None if transits is None else since(clock_s, transits)
    return replace(candidate, conventions=conventions), shifted


def started_elsewhere(times: Array, scene: Scene) -> bool:
    """Return whether no time is in the scene's span, though all would fit into it."""
    end = float(scene.exact.t_end + scene.exact.grid_step)
    return bool(times[0] > end and times[-1] - times[0] <= end)


def since(clock_s: float, times: Array) -> Array:
    """Return times in s since another, each the nearest double to the difference of the decimals."""
    start = Fraction(repr(clock_s))
    return np.array([float(Fraction(repr(float(time))) - start) for time in times])
