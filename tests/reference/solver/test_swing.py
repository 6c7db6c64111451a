"""A swing is told from highest points where these are its ends, and its turn where they tell which way it went."""

import math

import pytest

import reference


def swing_of(name, t_end):
    return reference.solve(name, t_end=t_end, level="enclosed", digits=15, sections="highest").swing


def test_a_swing_smaller_than_the_rest_position_is_off_the_plumb_line_is_not_told():
    """Its highest points along this line are the southern ends alone: half the frequency, without a turn."""
    assert swing_of("nanometre_paris", "60") is None
    assert swing_of("paris", "60").precession is not None


def test_a_site_that_turns_faster_than_the_bob_swings_leaves_the_turn_open():
    # 10 rad/s: eleven radians from one highest point to the next
    swing = swing_of("fast_pole", "10")
    assert swing.precession is None
    # what the engine of sweeps counts
    assert float(swing.period[0]) == pytest.approx(2.3008, rel=1e-3)


def test_the_rest_of_a_damped_swing_has_none():
    damped = reference.parse_scene(
        {
            "id": "a",
            "pendulum": {"length": "2", "drag": "1"},
            "release": {"angle": "10", "azimuth": "30"},
            "run": {"t_end": "45", "grid_step": "45"},
        }
    )
    assert swing_of(damped, "45") is None
    assert swing_of(damped, "8").hz[0] == pytest.approx(
        math.sqrt(9.78 / 2 - 1 / 4) / 2 / math.pi, rel=1e-2
    )
