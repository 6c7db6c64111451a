"""Five numbers of the Paris pendulum, as the commands print them."""

import math
import re

import pytest
from lines import unwrapped


def test_paris_as_show_and_generate_print_it(foucault, tmp_path):
    shown = foucault("show", "paris")[1]
    number = {
        name: float(value)
        for name, value in re.findall(r"^  (\w[\w ]*?) {2,}(-?[0-9.]+) ", shown, re.MULTILINE)
    }

    # a small swing takes 2π sqrt(l/g), with g = 9.7919 m/s² in Paris
    assert number["small swing"] == pytest.approx(2 * math.pi * math.sqrt(67 / 9.79195), abs=1e-5)
    # this one is 0.6 m wide about its rest position: θ²/16 of it is 8.1e-5 s
    assert number["period"] - number["small swing"] == pytest.approx(8.13e-5, rel=1e-2)
    # the Earth turns by 15.041 degrees an hour; times sin φ = 0.75296, that is 11.325, and the ellipse adds 0.15 %
    assert number["precession"] == pytest.approx(-11.325, rel=2e-3)
    # a full turn takes 360 / 11.342 hours
    assert number["full turn"] == pytest.approx(31.74, abs=0.01)
    # in a minute xdot is zero 7 times: every 8.2178 s
    made = foucault(
        "generate",
        "paris",
        "--t-end",
        "60",
        "--digits",
        "9",
        "--level",
        "computed",
        "--out",
        tmp_path / "p",
    )
    assert "grid 2 rows transits 7 digits 9 level computed" in unwrapped(made[1])
