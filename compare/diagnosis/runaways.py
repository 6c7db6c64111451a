"""A bob that falls, or swings ever wider: what rows show of a force or a cord that is badly wrong."""

from __future__ import annotations

import math

import numpy as np

from .case import FileRows
from .programs import Program
from .thresholds import RIVAL

_PARTS = 4  # of the rows


def falls(rows: FileRows, right: Program) -> str:
    """Return a sentence on the coordinate that falls far below the cord; empty if none does."""
    time = rows.times[1:] - rows.times[0]
    displacements = rows.plane[1:] - rows.plane[0]
    for name, displacement in zip("xy", displacements.T, strict=True):
        pulls = np.abs(2 * displacement / time**2) / right.g
        distance = float(abs(displacement[-1:]).sum())
        falls_freely = ((pulls > 1 / RIVAL) & (pulls < RIVAL)).all()
        if falls_freely and distance > RIVAL * right.length:
            fell = f"Its {name} falls by {distance:.3g} m in {time[-1]:.3g} s"
            guess = f"perhaps {name} is its vertical, and its cord pulls too little"
            return f"{fell}, as a body does that no cord holds: {guess}."
    return ""


def growth(rows: FileRows) -> str:
    """Return a sentence on how fast a motion grows throughout the rows; empty if it does not."""
    if len(rows.times) < 2 * _PARTS:
        return ""
    parts = np.array_split(np.arange(len(rows.times)), _PARTS)
    reach = np.array([float(np.hypot(*rows.plane[part].T).max()) for part in parts])
    always_grows = (reach[1:] > reach[:-1]).all()
    growth = float(reach[-1] / reach[0]) if reach[0] else math.inf
    if not always_grows or not RIVAL < growth < math.inf:
        return ""
    first, *_, last = (float(rows.times[part].mean()) for part in parts)
    fold = (last - first) / math.log(growth)
    grows = f"Its motion grows by a factor of e in {fold:.2g} s"
    return f"{grows}: a force does work, the cord does not hold, or the steps are too long."
