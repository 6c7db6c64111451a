"""An approximation as a candidate for the oracle: its motion at a scene's grid times."""

from __future__ import annotations

import numpy as np

from reference import InputError, Scene

from ..candidates.candidate import COLUMNS, Candidate
from . import Motion, approximation, motions


def candidate_of(word: str, scene: Scene) -> Candidate:
    """The motion that an approximation gives, at the scene's grid times.

    Raises:
        InputError: no approximation of the motion has that id, or the scene is outside its domain.
    """
    made = approximation(word)
    if not isinstance(made, Motion):
        raise InputError("--approximation", word, f"one of {', '.join(motions())}", "It gives a number, not a motion.")
    times = np.array([float(t) for t in scene.exact.grid])
    rows = made.trajectory(scene, times)
    return Candidate.of(word, times, {name: np.ascontiguousarray(rows[:, i]) for i, name in enumerate(COLUMNS)})
