"""Exact zeros of xdot, known from the inputs alone: at all times, or at the release only."""

from __future__ import annotations

from .algebra import cross
from .force import force
from .start import Start


def xdot_vanishes(start: Start) -> bool:
    """Return whether xdot is zero at all times, decided from exact zeros only (lemma in enclosure/THEOREM.md).

    It is where the bob is released at rest and the force has no component along the sphere (straight up or down at a
    pole or on the equator, or no force at all), and without rotation also where it is released in the plane x = 0 with
    vx = 0.
    """
    n, v = start.n, start.v
    if not any(v) and not any(cross(n, force(n, (0, 0, 0), start.k))):
        return True
    return not start.k.rate and n[0] == 0 and v[0] == 0


def zero_at_release(start: Start) -> int:
    """Return the multiplicity of xdot's zero at t = 0 by the exact inputs: 0, 1, or 2 (at rest in the meridian)."""
    if start.v[0] != 0:
        return 0
    return 2 if start.n[0] == 0 and not any(start.v) else 1
