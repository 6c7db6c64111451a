"""The exponent p of error ∝ t^p, fitted to the largest error so far."""

from __future__ import annotations

import numpy as np

from reference.precision import Array

FEWEST = 3  # points that a fit needs


def power_of_time(t: Array, error: Array, parts: int) -> float | None:
    """Return the exponent p of error ∝ t^p; None if there are fewer than three points to fit.

    Args:
        t: times in s, above zero, increasing, shape (rows,).
        error: above zero, at these times; the largest error so far is fitted.
        parts: number of fitted points, equally far apart in log t, so that late times do not weigh more.
    """
    largest = np.maximum.accumulate(error)
    at = np.unique(np.searchsorted(t, np.geomspace(t[0], t[-1], parts), side="right") - 1)
    at = at[at >= 0]
    return float(np.polyfit(np.log(t[at]), np.log(largest[at]), 1)[0]) if len(at) >= FEWEST else None
