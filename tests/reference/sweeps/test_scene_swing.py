"""`reference.swing`: period and precession of a scene, against proven intervals and closed forms."""

from __future__ import annotations

import math

import pytest
from small_scenes import make_scene

import reference


def test_the_swing_of_paris_lies_within_its_errors_of_what_is_proved():
    swing = reference.swing(reference.load_scene("paris", ["run.t_end=3600"]))
    proved = reference.solve(
        "paris", t_end="3600", digits=15, level="enclosed", sections="highest"
    ).swing
    (low, high), (least, most) = proved.period, proved.precession
    assert float(low) - swing.period_error_s <= swing.period_s <= float(high) + swing.period_error_s
    error = swing.precession_error_deg_per_h
    assert float(least) - error <= swing.precession_deg_per_h <= float(most) + error
    assert swing.full_turn_h == pytest.approx(360 / abs(swing.precession_deg_per_h))
    assert 0 < swing.period_error_s < 1e-9 and 0 < error < 1e-4


def test_without_rotation_a_small_swing_has_the_period_of_the_textbook_and_its_plane_may_stand_still():
    scene = make_scene(
        site={"rotation_rate": "0"}, release={"x": "0.01", "y": "0"}, run={"t_end": "600"}
    )
    swing = reference.swing(scene)
    amplitude = 0.01 / 67
    assert swing.period_s == pytest.approx(
        2 * math.pi * math.sqrt(67 / 9.80665) * (1 + amplitude**2 / 16), rel=1e-12
    )
    assert swing.may_stand_still and swing.full_turn_h is None


@pytest.mark.parametrize(
    ("scene", "reason"),
    [
        ("conical", "fewer than two highest points"),
        ("weightless", "fewer than two highest points"),
        ("inverted_rest", "more digits"),
    ],
)
def test_a_bob_that_does_not_swing_has_no_swing_and_the_reason_is_told(scene, reason):
    with pytest.raises(reference.UnreachableError, match=reason):
        reference.swing(scene)


def test_a_field_that_is_wrong_is_told():
    with pytest.raises(reference.InputError, match=r"pendulum\.length"):
        reference.swing(
            {"id": "mine", "pendulum": {"length": "-1"}, "release": {"x": "1", "y": "0"}}
        )
