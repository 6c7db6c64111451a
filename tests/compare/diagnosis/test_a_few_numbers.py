"""Five mistakes in the Paris pendulum, and how far each moves the bob within ten minutes: checked by eye."""

import numpy as np
import pytest

import compare
import reference

TIMES = np.arange(0.0, 601.0, 10.0)


def explained(*mistake, unit=1.0):
    """Judge the motion of a program that makes a mistake, over ten minutes."""
    scene = reference.load_scene("paris", ["inputs=binary64", *mistake])
    x, y, z = unit * reference.trajectory(scene, TIMES)[:, :3].T
    return compare.judge({"t": TIMES, "x": x, "y": y, "z": z}, "paris").explanation


@pytest.mark.parametrize(
    ("mistake", "name", "moves_m"),
    [
        # the period is shorter by half of 0.00335/9.8: at t = 600 s the bob is 0.1 s early, times up to 0.2 m/s
        ("site.gravity=9.81", "gravity_9.81", 0.0218),
        # the period is longer by half of 1/67: 4.4 s in 600 s, a quarter of a swing and more; the bob is 1.3 m farther
        ("pendulum.length=68", "pendulum.length", 1.33),
        # a rate 0.27 % too low turns the plane by 0.005° less in 600 s: 0.05 mm; and the plumb line, which is
        # off by 0.1152 m, leans 0.6 mm less: of a swing about it the bob is off by up to twice that
        ("site.rotation_rate=7.2722e-5", "rounded_rate", 0.00135),
        # the plumb line leans the other way, by twice 0.115 m: the bob is off by up to twice that
        ("site.latitude=-48.846111", "hemisphere", 0.455),
    ],
)
def test_a_mistake_moves_the_bob_as_far_as_a_sketch_says_and_nothing_else_is_left(
    mistake, name, moves_m
):
    explanation = explained(mistake)
    (cause,) = explanation.causes
    assert cause.id == name
    assert cause.size_m == pytest.approx(moves_m, rel=5e-3)
    assert explanation.corrected_m < 1e-12


def test_a_file_in_millimetres_is_told_by_the_first_row():
    (convention,) = explained(unit=1000.0).conventions
    assert convention.id == "unit_of_length"
    # the release is 500 mm from the vertical; read as metres it is a thousand times as far
    assert convention.size_m == pytest.approx(695.3, rel=1e-3)
