"""How far uncertain inputs move period and precession: estimates, against formulas for small swings."""

from __future__ import annotations

from math import cos, exp, expm1, radians

import pytest

from reference.commands.effects import effects_document, estimated_effects
from reference.scenes.scene import parse_scene

# a museum's pendulum over an hour, in which its swing falls to an eighth
MUSEUM = {
    "id": "museum",
    "pendulum": {"length": "12.3", "drag": "0.0011552"},
    "site": {"latitude": "51.48", "gravity": "9.812", "gravity_is": "effective"},
    "release": {"angle": "5", "azimuth": "-135"},
    "run": {"t_end": "3600"},
}
WIDTHS = {
    "pendulum.length": "0.005",
    "site.gravity": "0.001",
    "site.latitude": "0.005",
    "release.angle": "0.5",
}


@pytest.fixture(scope="module")
def effects():
    return estimated_effects(parse_scene(MUSEUM), WIDTHS)


def test_the_period_is_moved_as_much_as_formulas_say(effects):
    period_s = effects.own.period_s
    # by T/16 times the mean of the squared amplitude, which falls as exp(-drag t)
    decay = 0.0011552 * 3600
    mean_square = -expm1(-decay) / decay
    by_angle_s = period_s / 16 * (radians(5.5) ** 2 - radians(5) ** 2) * mean_square
    expected_s = {
        "pendulum.length": period_s / 2 * 0.005 / 12.3,
        "site.gravity": period_s / 2 * 0.001 / 9.812,
        "release.angle": by_angle_s,
    }
    assert exp(-decay / 2) == pytest.approx(1 / 8, rel=0.01)
    for name, size_s in expected_s.items():
        assert effects.of_period(name).size == pytest.approx(size_s, rel=0.01)
    # so the length, not the angle, is to be measured better
    shares = effects.shares()
    assert sorted(shares, key=shares.get, reverse=True)[:3] == list(expected_s)


def test_the_precession_is_moved_by_less_than_the_proof_of_it_is_wide(effects):
    moved = effects.precession_range()
    # of the rotation of the site, 15.041 sin(latitude) degrees an hour
    by_latitude = 15.041 * cos(radians(51.48)) * radians(0.005)
    assert by_latitude < moved.high < 0.01
    assert by_latitude < -moved.low < 0.01


def test_a_pendulum_without_a_period_has_no_estimates_but_a_reason():
    creeping = {**MUSEUM, "pendulum": {"length": "12.3", "drag": "20"}}
    document = effects_document(parse_scene(creeping), WIDTHS)
    assert document["first_order"] == {}
    assert set(document["limits"]) == set(WIDTHS)
    assert document["limits"]["release.angle"]["share"] is None
    # drag above 2 sqrt(g/l): more digits would not help
    assert "creeps back to rest" in document["no_estimate"]
