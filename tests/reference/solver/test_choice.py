"""The radius that late transits of a damped pendulum need, against the solution of the damped oscillator."""

from __future__ import annotations

from fractions import Fraction

import pytest
from mpmath import mp, mpf

import reference
from reference.solver.proving import MOST_DIED, late_radius


@pytest.mark.parametrize(
    ("drag", "t_end"),
    [("0", 1000), ("0.5", 100), ("2", 50), ("9.8", 20), ("30", 30), ("1000", 500)],
)
def test_the_radius_shrinks_as_the_slowest_motion_of_a_damped_oscillator(drag, t_end):
    inputs = reference.load_scene(
        "paris",
        [
            "pendulum.length=1",
            "site.gravity=9.81",
            f"pendulum.drag={drag}",
            f"run.t_end={t_end}",
            "run.grid_step=1",
        ],
    ).exact
    with mp.workdps(30):
        half = mpf(drag) / 2
        slowest = mp.sqrt(half**2 - mpf("9.81")) - half
        left = mp.exp(mp.re(slowest) * t_end)
        assert (
            left / 2
            <= mpf(late_radius(Fraction(1), inputs).denominator) ** -1
            <= left * (1 + mpf(10) ** -9)
        )


def test_a_swing_that_has_died_long_ago_asks_for_no_endless_number():
    inputs = reference.load_scene(
        "paris", ["pendulum.drag=0.5", "run.t_end=1e9", "run.grid_step=1e8"]
    ).exact
    assert late_radius(Fraction(1), inputs) == Fraction(1, 2**MOST_DIED)
