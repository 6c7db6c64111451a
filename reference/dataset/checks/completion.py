"""Take z and vz of a state from x, y, vx and vy, where they follow well."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

STEEP = 4  # where |z| is below l/4, z does not follow well enough from x and y


def deep(z: Any, length: Any) -> Any:
    """Return whether z and vz follow well from the others."""
    return abs(z) * STEEP > length


def depth(x: Any, y: Any, length: Any, side: Any, sqrt: Callable[[Any], Any]) -> Any:
    """Return z on the side of the pivot, -1 or 1, where it is."""
    return sqrt(length * length - x * x - y * y) * side


def vertical_velocity(x: Any, y: Any, z: Any, vx: Any, vy: Any) -> Any:
    """Return vz, which keeps the velocity along the sphere."""
    return -(x * vx + y * vy) / z
