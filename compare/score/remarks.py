"""Remarks with a verdict: that another unit of length fits, or that a bob at rest would agree too."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from reference import Scene, UnreachableError
from reference.model.constants import constants_in_double
from reference.model.start import Start
from reference.numbers.columns import POSITION
from reference.numbers.precision import DOUBLE_BITS, GUARD_BITS, Array

from ..candidates.candidate import Candidate, Deviation
from ..candidates.names import LENGTHS, LONG_NAMES
from ..observed.swing_plane import rest_in_metres
from .verdict import Score

_BEYOND = 1.01  # times the cord: farther out, no rounding and no stretching puts the bob
_SAME = 1e-3  # relative difference of ratios that count as one scale


def scale_beyond_the_cord(candidate: Candidate, scene: Scene, truth: Array) -> Deviation | None:
    """Return an explanation of positions out of the cord's reach, such as another unit of length or pixels, or None.

    A unit is named if the rows, in metres then, differ from the truth by less than its size: those
    of another pendulum do not.

    Args:
        candidate: rows of positions.
        scene: the problem.
        truth: x and y in m at the candidate's times, shape (rows, 2).
    """
    x = candidate.columns["x"]
    y = candidate.columns["y"]
    reach = float(np.hypot(x, y).max())
    if reach <= _BEYOND * float(scene.exact.length):
        return None
    far = f"x and y reach {reach:.4g} and the cord is {scene.pendulum.length} m long"

    scale = _scale_of_the_release(candidate, scene)
    if scale is None:
        question = "pixels, another unit, or another pendulum? Metres are wanted"
        return Deviation("beyond_the_cord", f"{far}: {question}")

    times = f"the first row is {scale:.6g} times the release"
    unit = _unit_of(scale)
    if unit is None:
        question = (
            f"is it another pendulum, or are {scale:.6g} pixels, or of another unit, a metre? "
            "Divide by it"
        )
        return Deviation("scale", f"{far}: {times}; {question}")

    difference = np.linalg.norm(np.column_stack([x, y]) / scale - truth)
    if difference < np.linalg.norm(truth):
        guess = f", so they are {LONG_NAMES[unit]};"
    else:
        guess = f"; is it another pendulum, or {LONG_NAMES[unit]}?"
    return Deviation("scale", f"{far}: {times}{guess} --units {unit} reads them so")


def _scale_of_the_release(candidate: Candidate, scene: Scene) -> float | None:
    """Return how many times farther the first row is than the release.

    None if it is no multiple of it.
    """
    x, y, _ = Start.of(scene.exact, DOUBLE_BITS + GUARD_BITS).position
    release = complex(float(x), float(y))
    if not release or candidate.t[0] != 0:
        return None
    ratio = complex(candidate.columns["x"][0], candidate.columns["y"][0]) / release
    scale = abs(ratio)
    return scale if abs(ratio - scale) < _SAME * scale else None


def _unit_of(scale: float) -> str | None:
    """Return the unit of which so many are a metre, or None."""
    for unit, size_m in LENGTHS.items():
        if size_m != 1 and abs(scale * float(size_m) - 1) < _SAME:
            return unit
    return None


def warning_of_a_resting_bob(score: Score) -> tuple[str, ...]:
    """Return a warning if a bob that does not move would agree too, so that agreement means little.

    It may stay at its release, as in a program that never steps, or at its rest position, as in one
    without a swing.
    """
    if not (score.agrees and score.candidate.positions and score.transits is None):
        return ()
    start = Start.of(score.scene.exact, DOUBLE_BITS + GUARD_BITS)
    places = {"where it is released": np.array([float(q) for q in start.position])}
    with suppress(UnreachableError):
        places["at its rest position"] = rest_in_metres(score.scene)

    indices = [i for i, name in enumerate(POSITION) if name in score.candidate.columns]
    truth = score.errors.truth.states[:, indices]
    farthest_m = {}
    for word, place in places.items():
        farthest_m[word] = float(np.linalg.norm(truth - place[indices], axis=1).max())

    word = min(farthest_m, key=lambda word: farthest_m[word])
    if farthest_m[word] > score.allowed_m:
        return ()
    moves = f"the true one is never more than {farthest_m[word]:.2g} m from there"
    is_resolved = farthest_m[word] > score.errors.bound_m
    advice = ": set a tolerance far below that" if is_resolved else ""
    return (f"a bob that stays {word} would agree as well, as {moves}{advice}",)


def warning_of_a_flung_bob(scene: Scene) -> tuple[str, ...]:
    """Return a warning if the centrifugal force at the suspension is larger than gravity."""
    k = constants_in_double(scene.exact)
    outward_m_s2 = float(k.rate) ** 2 * float(k.axis_distance) * k.length
    gravity_m_s2 = float(k.gravity) * k.length
    if outward_m_s2 <= gravity_m_s2:
        return ()
    force = f"the centrifugal force at the suspension, {outward_m_s2:.3g} m/s², is larger than g"
    return (f"{force}: with site.gravity_is=effective g contains that force",)
