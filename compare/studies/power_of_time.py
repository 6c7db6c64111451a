"""The power of time that an error grows like."""

from __future__ import annotations

import numpy as np

from reference.precision import Array

FEWEST = 3  # points of a fit


def power_of_time(t: Array, error: Array, parts: int) -> float | None:
    """The exponent p of error ∝ t^p; None where fewer than three points make the curve.

    Args:
        t: times in s, above zero, increasing, shape (rows,).
        error: above zero, at these times; what is fitted is the largest so far.
        parts: into which log t is divided: at the end of each lies a point, so that late times count no more.
    """
    largest = np.maximum.accumulate(error)
    at = np.unique(np.searchsorted(t, np.geomspace(t[0], t[-1], parts), side="right") - 1)
    at = at[at >= 0]
    return float(np.polyfit(np.log(t[at]), np.log(largest[at]), 1)[0]) if len(at) >= FEWEST else None
