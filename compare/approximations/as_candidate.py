"""An approximation as a candidate to be scored: its motion at a scene's grid times."""

from __future__ import annotations

import numpy as np

from reference import InputError, Scene

from ..candidates.candidate import COLUMNS, Candidate
from . import Motion, approximation, motions


def candidate_of(word: str, scene: Scene) -> Candidate:
    """Return the motion of an approximation at the scene's grid times, as a candidate.

    Raises:
        InputError: no approximation of the motion has this id, or the scene is outside its domain.
    """
    motion = approximation(word)
    if not isinstance(motion, Motion):
        raise InputError("--approximation", word, f"one of {', '.join(motions())}", "It gives a number, not a motion.")
    times = np.array([float(t) for t in scene.exact.grid])
    rows = motion.trajectory(scene, times)
    return Candidate.of(word, times, {name: np.ascontiguousarray(rows[:, i]) for i, name in enumerate(COLUMNS)})
