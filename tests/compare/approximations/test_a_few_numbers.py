"""Five numbers that the papers' approximations give for the Paris pendulum, and a pocket calculator as well."""

import pytest

from compare.approximations import APPROXIMATIONS
from reference import load_scene


def test_paris_by_a_pocket_calculator():
    paris = load_scene("paris")

    def value(word):
        return float(APPROXIMATIONS[word].value(paris))

    # sqrt(9.80665 / 67) / 2π
    assert value("frequency_harmonic") == pytest.approx(0.060890, abs=1e-6)
    # a swing of 0.5 m on a cord of 67 m is slower by 1 part in 16 (67 / 0.5)² = 287,000: 2e-7 Hz
    assert value("frequency_harmonic") - value("frequency_planar") == pytest.approx(
        2.1e-7, rel=0.02
    )
    # a sidereal day over sin 48.846°: 23.934 h / 0.75294 = 31.79 h
    assert value("precession_sine") / 3600 == pytest.approx(31.79, abs=0.01)
    # g less Ω² R cos φ = 0.0147 m/s², where R = 4.2e6 m
    assert value("apparent_gravity") == pytest.approx(9.80665 - 0.0147, abs=1e-4)
    # the tilt of the plumb line, Ω² R sin φ / g = 0.0168 / 9.79 rad, to the south
    assert abs(value("rest_equation")) == pytest.approx(0.00172, abs=1e-5)
