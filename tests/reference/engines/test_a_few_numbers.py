"""Five numbers of an hour of the Paris pendulum, as heyoka computes it."""

import math
from fractions import Fraction

import pytest

from reference import load_scene
from reference.engines.registry import engines, run

REST_Y = -0.1152  # m: the plumb line, south of the vertical by Ω² R sin φ/g of the length


def azimuth(x, y):
    """Degrees from east to north about the plumb line."""
    return math.degrees(math.atan2(y - REST_Y, x))


def test_an_hour_of_paris():
    plan = engines()["heyoka"].plan(
        load_scene("paris").exact, 64, (Fraction(0), Fraction(3600)), ("xdot",)
    )
    hour = run(plan)
    t, x, y = (hour.transits[name] for name in ("t", "x", "y"))

    # sqrt(67² - 0.5²)
    assert hour.grid["z"][0] == pytest.approx(-66.998134, abs=1e-6)
    # half a period: π sqrt(67/9.792)
    assert t[0] == pytest.approx(8.2178, abs=1e-4)
    # the mirror image about the plumb line: -(0.4 + 2 · 0.1152)
    assert y[0] == pytest.approx(-0.630, abs=1e-3)
    # 3600/8.2178 = 438.07, to the west and to the east in turn
    assert hour.directions == [1, -1] * 219
    # 15.041 degrees an hour times sin 48.85° = 0.753 is 11.33, clockwise
    assert azimuth(x[-1], y[-1]) - azimuth(0.3, 0.4) == pytest.approx(-11.33, abs=0.05)
