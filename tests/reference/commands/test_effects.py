"""How far uncertain inputs move period and precession: estimates, against formulas for small swings."""

from __future__ import annotations

from math import cos, degrees, exp, expm1, radians, sin, sqrt

import pytest

from reference.commands.effects import effects_document, plus_minus, rounded_down, swing_effects
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
    return swing_effects(parse_scene(MUSEUM), WIDTHS)


def test_the_period_is_moved_as_much_as_formulas_say(effects):
    period_s = effects.own.period_s
    # by T/16 times the mean of the squared amplitude, which falls as exp(-drag t)
    decay = 0.0011552 * 3600
    mean_square = -expm1(-decay) / decay
    by_angle_s = period_s / 16 * (radians(5.5) ** 2 - radians(4.5) ** 2) / 2 * mean_square
    expected_s = {
        "pendulum.length": period_s / 2 * 0.005 / 12.3,
        "site.gravity": period_s / 2 * 0.001 / 9.812,
        "release.angle": by_angle_s,
    }
    assert exp(-decay / 2) == pytest.approx(1 / 8, rel=0.01)
    moved = effects.period.by_input
    for name, size_s in expected_s.items():
        assert moved[name].half_width == pytest.approx(size_s, rel=0.01)
    # so the length, not the angle, is to be measured better
    shares = effects.period.shares
    assert sorted(shares, key=shares.get, reverse=True)[:3] == list(expected_s)
    # the worst case: all effects added
    assert effects.period.half_width == pytest.approx(sum(expected_s.values()), rel=0.01)


def test_the_precession_is_moved_by_less_than_the_proof_of_it_is_wide(effects):
    moved = effects.precession.together
    # of the rotation of the site, 15.041 sin(latitude) degrees an hour
    by_latitude = 15.041 * cos(radians(51.48)) * radians(0.005)
    assert by_latitude < moved.high < 0.01
    assert by_latitude < -moved.low < 0.01


@pytest.mark.parametrize(("t_end", "by_page"), [("180", 0.94), ("3600", 0.25)])
def test_a_sideways_speed_turns_the_plane_as_airy_says(t_end, by_page):
    """The figures of docs/measured.md: 1.9 mm/s, of an ellipse that shrinks with the swing."""
    frequency = sqrt(9.812 / 12.3)
    length_m = 12.3 * sin(radians(5))
    width_m = 1.9e-3 / frequency
    decay = 0.0011552 * float(t_end)
    mean_area = length_m * width_m * -expm1(-decay) / decay
    airy = degrees(3 / 8 * frequency * mean_area / 12.3**2) * 3600
    rate = degrees(1.9e-3 / length_m)
    scene = parse_scene({**MUSEUM, "run": {"t_end": t_end}})
    moved = swing_effects(scene, {"release.azimuth_rate": f"{rate:.5f}"}).precession.together
    assert moved.half_width == pytest.approx(airy, rel=0.02)
    assert round(moved.half_width, 2) == by_page


def test_the_document_has_the_middle_and_half_the_width_of_each_range():
    document = effects_document(parse_scene(MUSEUM), WIDTHS)
    middles = document["first_order_plus_minus"]
    assert set(middles) == {"period_s", "precession_deg_per_h", "full_turn_h"}
    for name, (low, high) in document["first_order"].items():
        middle, half_width = map(float, middles[name])
        assert float(low) <= middle - 0.9 * half_width < middle + 0.9 * half_width <= float(high)
    # a turn of 360 degrees
    rate, rate_half = map(float, middles["precession_deg_per_h"])
    turn, turn_half = map(float, middles["full_turn_h"])
    assert turn == pytest.approx(360 / abs(rate), rel=1e-4)
    assert turn_half == pytest.approx(turn * rate_half / abs(rate), rel=0.05)


def test_a_pendulum_without_a_period_has_no_estimates_but_a_reason():
    creeping = {**MUSEUM, "pendulum": {"length": "12.3", "drag": "20"}}
    document = effects_document(parse_scene(creeping), WIDTHS)
    assert document["first_order"] == {}
    assert set(document["limits"]) == set(WIDTHS)
    assert document["limits"]["release.angle"]["share"] is None
    # drag above 2 sqrt(g/l): more digits would not help
    assert "creeps back to rest" in document["no_estimate"]


@pytest.mark.parametrize(
    ("low", "high", "text"),
    [
        (174.129, 174.2474, ["174.188", "0.059"]),
        (0.9002, 1.0998, ["1.00", "0.10"]),
        (-11.742, -11.728, ["-11.7350", "0.0070"]),
        (100, 300, ["200", "100"]),
    ],
)
def test_half_a_width_has_two_digits_and_the_middle_as_many_places(low, high, text):
    assert plus_minus(low, high) == text


@pytest.mark.parametrize(
    ("number", "digits", "text"),
    [(0.003699, 2, "0.0036"), (90.22, 3, "90.2"), (3599.9, 3, "3590"), (70.0, 3, "70")],
)
def test_a_number_is_rounded_down_to_so_many_digits(number, digits, text):
    assert rounded_down(number, digits) == text
