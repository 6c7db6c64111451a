"""The rows of a file as the stages change them, and whether row 0 is the release."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from reference.numbers.precision import Array

from ...candidates.candidate import Convention

NEAR = 2e-5  # of the distance from the vertical: a row 0 nearer than this to the release is the release


@dataclass(frozen=True)
class Rows:
    """The rows of a file, made right: times in s, positions in m (x, y and perhaps z), half a unit of its last digit.

    Attributes:
        times: increasing, in s, shape (rows,).
        positions: x, y and perhaps z in m, shape (rows, 2 or 3).
        noise: rounding of the numbers, in m.
        conventions: what was changed.
        starts: whether row 0 is the release.
        cord: mean distance from the suspension in m, where the rows do not keep it; else None.
    """

    times: Array
    positions: Array
    noise: float
    conventions: tuple[Convention, ...] = ()
    starts: bool = True
    cord: float | None = None


def is_release(row: Array, release: Array, noise: float) -> bool:
    """Return whether a row is the release but for its rounding."""
    size = max(float(np.hypot(release[0], release[1])), 1e-6 * float(np.abs(release).max()))
    return bool(np.abs(row[:2] - release[:2]).max() <= NEAR * size + 2 * noise)


def largest(difference: Array) -> float:
    """Return the largest distance in m that differences of rows make."""
    return float(np.linalg.norm(difference, axis=1).max())


def rms(difference: Array) -> float:
    """Return the root mean square distance in m that they make."""
    return float(np.linalg.norm(difference)) / math.sqrt(len(difference))
