"""The swing plane and the phase of a pendulum, and how far a candidate's are off.

Near the vertical the bob moves on an ellipse about its rest position. A candidate that is wrong by a small
turn δθ of the ellipse and a small delay δτ differs from the truth u = (x, y) - rest by

    δu = δθ (-u_y, u_x) - δτ (ẋ, ẏ),

two unknowns that least squares finds from a swing's worth of rows, velocities of the candidate not needed.
For a wider or a tall orbit the same fit gives the turn about the vertical and the delay that explain most.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.precision import Array

BLOCKS = 48  # parts of the run in which turn and delay are fitted
FEWEST = 3  # rows of a run: with fewer there is no fit, or nothing that checks it
ROWS = 12  # at least in a part: one row has as many equations as unknowns
MOST_ROWS = 240  # of a part that are looked at: more tell nothing new
TURNS = 4  # times the candidate is turned back and fitted again, so that a large turn is found too


@dataclass(frozen=True)
class EllipseErrors:
    """Turn of the swing plane in radians (east to north positive) and delay in s, per part of the run."""

    t: Array
    turn: Array
    delay: Array

    @property
    def largest_turn(self) -> float | None:
        """In radians; None if there were too few rows to fit."""
        return float(np.abs(self.turn).max()) if len(self.turn) else None

    @property
    def largest_delay(self) -> float | None:
        """In s; None if there were too few rows to fit."""
        return float(np.abs(self.delay).max()) if len(self.delay) else None


def ellipse_errors(t: Array, truth: Array, error: Array, rest: tuple[float, float]) -> EllipseErrors:
    """Fit turn and delay of a candidate, part by part.

    Args:
        t: times in s, shape (rows,).
        truth: x, y, z, vx, vy, vz in m and m/s, shape (rows, 6).
        error: candidate minus truth in x and y, shape (rows, 2), in m.
        rest: x and y of the rest position in m.
    """
    if len(t) < FEWEST:
        return EllipseErrors(np.empty(0), np.empty(0), np.empty(0))
    parts = np.array_split(np.arange(len(t)), max(1, min(BLOCKS, len(t) // ROWS)))
    looked_at = [part[:: -(-len(part) // MOST_ROWS)] for part in parts]
    found = [_fitted(truth[part], error[part], rest) for part in looked_at]
    middle = np.array([float(np.mean(t[part])) for part in parts])
    return EllipseErrors(middle, np.array([turn for turn, _ in found]), np.array([delay for _, delay in found]))


def _fitted(truth: Array, error: Array, rest: tuple[float, float]) -> tuple[float, float]:
    u = truth[:, :2] - np.array(rest)
    rate = truth[:, 3:5]
    turn = delay = 0.0
    for _ in range(TURNS):
        spin, cos = np.sin(turn), -2 * np.sin(turn / 2) ** 2  # cos(turn) - 1 without cancellation
        turned = np.column_stack([cos * u[:, 0] - spin * u[:, 1], spin * u[:, 0] + cos * u[:, 1]])
        here = u + turned
        columns = np.stack([np.column_stack([-here[:, 1], here[:, 0]]).ravel(), -rate.ravel()], axis=1)
        size = np.sqrt((columns**2).sum(axis=0))
        if not size.all():
            return 0.0, 0.0
        step = np.linalg.lstsq(columns / size, (error - turned).ravel(), rcond=1e-9)[0] / size
        turn, delay = turn + float(step[0]), float(step[1])
    return turn, delay
