"""Fit how far one motion's swing plane is turned, and its phase delayed, against another's.

`swing_plane` reads the azimuth off each state by itself, and so needs velocities. Here two motions are compared, a
candidate and the truth, and positions alone will do; a small turn is the difference of the two azimuths.

Near the vertical the bob moves on an ellipse about its rest position. A candidate whose ellipse is turned by a
small angle δθ and that is late by a small delay δτ differs from the truth u = (x, y) - rest by

    δu = δθ (-u_y, u_x) - δτ (ẋ, ẏ),

two unknowns that least squares finds from the rows of about one swing; the candidate's velocities are not needed.
For wide swings the same fit gives the turn about the vertical and the delay that explain most of the error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from reference.numbers.precision import Array

from .least_squares import gauss_newton

BLOCKS = 48  # parts of the run at most, in each of which turn and delay are fitted
FEWEST = 3  # rows of a run at least: one row has as many equations as unknowns, so that nothing checks the fit
ROWS = 12  # rows of a part at least
MOST_ROWS = 240  # rows of a part that are used at most: more add nothing new
TURNS = 4  # Gauss-Newton steps: the turn found so far is applied exactly and the fit repeated, for large turns


@dataclass(frozen=True, repr=False)
class SwingErrors:
    """Turn of the swing plane in radians (positive from east to north) and delay in s, for each part of the run."""

    t: Array
    turn: Array
    delay: Array

    def __repr__(self) -> str:
        return f"SwingErrors(largest_turn={self.largest_turn}, largest_delay={self.largest_delay})"

    @property
    def largest_turn(self) -> float | None:
        """Largest turn in radians; None if there were too few rows to fit."""
        return float(np.abs(self.turn).max()) if len(self.turn) else None

    @property
    def largest_delay(self) -> float | None:
        """Largest delay in s; None if there were too few rows to fit."""
        return float(np.abs(self.delay).max()) if len(self.delay) else None


def swing_errors(t: Array, truth: Array, error: Array, rest: tuple[float, float]) -> SwingErrors:
    """Fit turn and delay of a candidate, part by part.

    Args:
        t: times in s, shape (rows,).
        truth: x, y, z, vx, vy, vz in m and m/s, shape (rows, 6).
        error: candidate minus truth in x and y, shape (rows, 2), in m.
        rest: x and y of the rest position in m.
    """
    if len(t) < FEWEST:
        return SwingErrors(np.empty(0), np.empty(0), np.empty(0))
    parts = np.array_split(np.arange(len(t)), max(1, min(BLOCKS, len(t) // ROWS)))
    samples = [part[:: -(-len(part) // MOST_ROWS)] for part in parts]
    fits = [_fit(truth[part], error[part], rest) for part in samples]
    middle = np.array([float(np.mean(t[part])) for part in parts])
    return SwingErrors(middle, np.array([turn for turn, _ in fits]), np.array([delay for _, delay in fits]))


def _fit(truth: Array, error: Array, rest: tuple[float, float]) -> tuple[float, float]:
    """Return turn and delay of one part."""
    u = truth[:, :2] - np.array(rest)
    rate = truth[:, 3:5]

    def left(numbers: Array) -> tuple[Array, Callable[[], Array]]:
        turn, delay = numbers.tolist()
        sin, cos_minus_1 = np.sin(turn), -2 * np.sin(turn / 2) ** 2  # written so that nothing cancels
        change = np.column_stack([cos_minus_1 * u[:, 0] - sin * u[:, 1], sin * u[:, 0] + cos_minus_1 * u[:, 1]])
        turned = u + change
        slopes = np.stack([np.column_stack([-turned[:, 1], turned[:, 0]]).ravel(), -rate.ravel()], axis=1)
        return (error - change + delay * rate).ravel(), lambda: slopes

    (turn, delay), _ = gauss_newton(left, np.zeros(2), steps=TURNS, gain=1.0)
    return float(turn), float(delay)
