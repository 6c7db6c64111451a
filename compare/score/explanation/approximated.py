"""The source papers' approximations, each held against rows that no family of models explains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference import Scene
from reference.numbers.precision import Array

from ...approximations import APPROXIMATIONS, Motion
from .findings import Model, SizedCause
from .rows import Rows

LOW = 0.25  # of the cord: a bob that comes nearer to the suspension's height makes no small swings
SHARE = 0.01  # of the error that may be left


@dataclass(frozen=True)
class Approximated:
    """An approximation that the rows follow.

    Attributes:
        cause: it, with the distance by which it moves the bob.
        model: it, as a model that the rows are exact within.
        left: what it leaves of each row in m, shape (rows, 2 or 3).
    """

    cause: SizedCause
    model: Model
    left: Array


def approximated(scene: Scene, rows: Rows, truth: Array) -> Approximated | None:
    """Return the approximation that leaves least, if that is next to nothing; of equal ones the first.

    Args:
        scene: the scene.
        rows: those of the file, conventions put right.
        truth: the positions of the full model at their times in m, shape (rows, 2 or 3).
    """
    count = rows.positions.shape[1]
    if count == 3 and not float(truth[:, 2].max()) < -LOW * float(scene.exact.length):
        return None
    error = float(np.linalg.norm(rows.positions - truth))
    best: Approximated | None = None
    least = max(SHARE * error, rows.noise * len(rows.times) ** 0.5)
    for word, motion in APPROXIMATIONS.items():
        if not isinstance(motion, Motion) or motion.refuses(scene) is not None:
            continue
        positions = motion.trajectory(scene, rows.times)[:, :count]
        left = rows.positions - positions
        rest = float(np.linalg.norm(left))
        if not rest < (least if best is None else least / 2):
            continue
        least = rest
        exact, costs = (float(np.linalg.norm(part, axis=1).max()) for part in (left, positions - truth))
        text = f"solves {motion.title} ({motion.where}) instead of the full equations"
        cause = SizedCause(word, text, costs, "model")
        best = Approximated(cause, Model(word, motion.title, exact, costs), left)
    return best
