"""Five numbers that the papers print, recomputed."""

import pytest

from compare.papers.digits import degrees
from compare.papers.first_principles import rest
from compare.papers.mathar.paris import first_period_frequency
from compare.papers.points import paris, transits


def test_the_numbers_of_the_pendulum_in_paris():
    p = paris()

    # Mathar's R: 6378 km times cos 48.846° = 0.658, and a little more for the flattening
    assert float(p.R) == pytest.approx(4.205e6, rel=1e-3)
    # his release: -sqrt(67² - 0.3² - 0.4²); he prints -66.98
    assert float(p.z) == pytest.approx(-66.998134, abs=1e-6)
    # the bob hangs 11.5 cm south of the vertical, which are 0.0985 degrees of 67 m
    assert float(rest(p)[1]) == pytest.approx(-0.1152, abs=1e-4)
    assert float(degrees(p.case.rest_angle)) == pytest.approx(0.0985, abs=1e-4)
    # two transits a swing: the second ends the first period of 16.44 s, which is 0.0608 Hz
    assert float(transits("t")[1]) == pytest.approx(16.44, abs=0.01)
    assert float(first_period_frequency()) == pytest.approx(1 / 16.4356, rel=1e-4)
