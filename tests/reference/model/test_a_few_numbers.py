"""Five numbers of the Paris pendulum that a pocket calculator gives, and a centrifugal force in whole numbers."""

import math

import pytest

from reference import load_scene
from reference.model.algebra import cross, scale
from reference.model.constants import Constants, centrifugal_products
from reference.model.force import force
from reference.model.start import Start

SIN = math.sin(math.radians(48.846111))
COS = math.cos(math.radians(48.846111))


def test_paris_by_a_pocket_calculator():
    start = Start.of(load_scene("paris").exact, 64)
    length = 67.0
    axis_m = float(start.k.axis_distance) * length
    pull = [float(part) * length for part in start.k.pull]  # m/s²
    gravity = math.hypot(*pull)

    # the distance from the Earth's axis: a cos φ / sqrt(1 - e² sin² φ)
    assert axis_m == pytest.approx(6378137 * COS / math.sqrt(1 - 0.00669438 * SIN**2), rel=1e-8)
    # g less the vertical part of the centrifugal force, Ω² R cos φ = 0.0147 m/s²
    assert gravity == pytest.approx(9.80665 - 7.292115e-5**2 * axis_m * COS, abs=2e-5)
    # the period of a small swing, 2π sqrt(l/g)
    assert 2 * math.pi * math.sqrt(length / gravity) == pytest.approx(16.4355, abs=1e-4)
    # the bob hangs 0.1152 m south of the vertical: the tilt is Ω² R sin φ / g = 0.00172
    assert float(start.rest[1]) * length == pytest.approx(-0.1152, abs=1e-4)
    # the plane turns by Ω sin φ = 11.33 degrees an hour
    assert math.degrees(7.292115e-5 * SIN) * 3600 == pytest.approx(11.325, abs=1e-3)


def test_the_centrifugal_force_in_whole_numbers():
    """|Ω|² - Ω Ωᵀ of Ω = (0, 3, 4), whose size is 5; as a force it is -Ω × (Ω × n)."""
    products = centrifugal_products(5, 3, 4)
    assert products == (25, 16, -12, 9)

    n = (2, 7, -1)
    turn = (0, 3, 4)
    at_rest = force(n, (0, 0, 0), Constants(centrifugal=products))
    assert at_rest == scale(-1, cross(turn, cross(turn, n))) == (50, 124, -93)
