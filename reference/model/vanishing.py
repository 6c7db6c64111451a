"""Exact zeros of xdot, known from the inputs alone: at all times, or at the release only."""

from __future__ import annotations

from .algebra import cross
from .constants import Constants, Vector
from .force import force


def xdot_vanishes(n: Vector, v: Vector, k: Constants) -> bool:
    """Return whether xdot is zero at all times, decided from exact zeros only (lemma in enclosure/THEOREM.md).

    It is where the bob is released at rest and the force has no component along the sphere (straight up or down at a
    pole or on the equator, or no force at all), and without rotation also where it is released in the plane x = 0 with
    vx = 0.
    """
    at_rest = not any(v)
    if at_rest and not any(cross(n, force(n, (0, 0, 0), k))):
        return True
    return not k.rate and n[0] == 0 and v[0] == 0


def zero_at_release(n: Vector, v: Vector) -> int:
    """Return the multiplicity of xdot's zero at t = 0 by the exact inputs: 0, 1, or 2 (at rest in the meridian)."""
    if v[0] != 0:
        return 0
    return 2 if n[0] == 0 and not any(v) else 1
