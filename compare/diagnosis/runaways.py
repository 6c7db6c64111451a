"""A bob that falls, or swings ever wider: what rows show of a force or a cord that is badly wrong."""

from __future__ import annotations

import math

import numpy as np

from reference.numbers.precision import Array

from .case import FileRows
from .programs import Program

_PARTS = 4  # of the rows


def falls(rows: FileRows, right: Program) -> str:
    """Return a sentence on the coordinate that falls farther than the cord reaches; empty if none does."""
    times = rows.times[1:] - rows.times[0]
    displacements = rows.plane[1:] - rows.plane[0]
    for name, displacement in zip("xy", np.abs(displacements).T, strict=True):
        distance = float(displacement[-1])
        if distance > 2 * right.length and _grow_quadratically(times, displacement):
            fell = f"Its {name} falls by {distance:.3g} m in {times[-1]:.3g} s"
            pull = f"{2 * distance / times[-1] ** 2:.3g} m/s²"
            guess = f"perhaps {name} is its vertical, and its cord pulls too little"
            return f"{fell}, at {pull}, as a body does that no cord holds: {guess}."
    return ""


def _grow_quadratically(times: Array, distances: Array) -> bool:
    """Return whether distances grow like the square of the time."""
    middle = len(times) // 2
    if len(times) < 2 or not distances[middle - 1]:
        return False
    growth = math.log(distances[-1] / distances[middle - 1])
    exponent = growth / math.log(times[-1] / times[middle - 1])
    return round(exponent) == 2


def growth(rows: FileRows) -> str:
    """Return a sentence on how fast a motion grows throughout the rows; empty if not by a factor of e."""
    if len(rows.times) < 2 * _PARTS:
        return ""
    parts = np.array_split(np.arange(len(rows.times)), _PARTS)
    reach = np.array([float(np.hypot(*rows.plane[part].T).max()) for part in parts])
    always_grows = (reach[1:] > reach[:-1]).all()
    growth = float(reach[-1] / reach[0]) if reach[0] else math.inf
    if not always_grows or not math.e < growth < math.inf:
        return ""
    first, *_, last = (float(rows.times[part].mean()) for part in parts)
    fold = (last - first) / math.log(growth)
    grows = f"Its motion grows by a factor of e in {fold:.2g} s"
    return f"{grows}: a force does work, the cord does not hold, or the steps are too long."
