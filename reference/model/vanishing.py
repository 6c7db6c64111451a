"""What vanishes exactly in a scene: xdot at all times, or at the release only."""

from __future__ import annotations

from .algebra import cross
from .constants import Constants, Vector
from .force import force


def xdot_vanishes(n: Vector, v: Vector, k: Constants) -> bool:
    """True if xdot is zero at all times, decided from exact zeros only (lemma in enclosure/THEOREM.md).

    Without rotation: release in the plane x = 0 with vx = 0. Always: a bob let go at rest where the
    force has no part along the sphere (pole and equator straight down, or no force at all).
    """
    at_rest = not any(v)
    if at_rest and not any(cross(n, force(n, (0, 0, 0), k))):
        return True
    return not k.rate and n[0] == 0 and v[0] == 0


def zero_at_release(n: Vector, v: Vector) -> int:
    """How many times over xdot vanishes at t = 0 by the exact inputs: 0, 1, or 2 (at rest in the meridian)."""
    if v[0] != 0:
        return 0
    return 2 if n[0] == 0 and not any(v) else 1
