"""Normal gravity: the strength of effective gravity that the ellipsoid of GRS 80 has at a latitude."""

from __future__ import annotations

import math
from fractions import Fraction

from ..scenes.inputs import Inputs

_RATE = Fraction("7.292115e-5")  # rad/s
_EQUATOR = 9.7803267715  # m/s²
_POLE_EXCESS = 0.001931851353
_ECCENTRICITY_SQUARED = 0.00669438002290


def normal_gravity(latitude_deg: float) -> float:
    """Return the normal gravity on the ellipsoid in m/s², which contains the centrifugal force.

    Somigliana's closed form with the constants of H. Moritz, Geodetic Reference System 1980. The
    gravity of a place differs from it by the local anomaly, and is lower by 3.1e-6 m/s² for each
    metre of altitude.
    """
    sine_squared = math.sin(math.radians(latitude_deg)) ** 2
    excess = 1 + _POLE_EXCESS * sine_squared
    return _EQUATOR * excess / math.sqrt(1 - _ECCENTRICITY_SQUARED * sine_squared)


def is_on_earth(inputs: Inputs) -> bool:
    """Return whether there is gravity, and an ellipsoid about as large as the Earth that turns about as fast."""
    numbers = inputs.by_name
    if not numbers["site.gravity"]:
        return False
    # exactly, since numbers may be too large for a double
    radius = numbers["site.equatorial_radius"] / 6_378_137
    rate = numbers["site.rotation_rate"] / _RATE
    return abs(radius - 1) < 0.01 and abs(rate - 1) < 0.01
