"""The Earth's ellipsoid: how far the suspension is from the axis of rotation."""

from __future__ import annotations

from typing import Any


def axis_distance(equatorial_radius: Any, flattening: Any, altitude: Any, sin: Any, cos: Any, sqrt: Any) -> Any:
    """Return the distance R = (N + h) cos(latitude) of the suspension from the axis, in m: Mathar (2), (3).

    Args:
        equatorial_radius: semi-major axis in m.
        flattening: f, 0 for a sphere; the squared eccentricity is f (2 - f).
        altitude: h above the ellipsoid in m.
        sin: sine of the geodetic latitude.
        cos: cosine of the geodetic latitude.
        sqrt: square root of the number type of the other arguments.
    """
    normal = equatorial_radius / sqrt(1 - flattening * (2 - flattening) * sin * sin)
    return (normal + altitude) * cos
