"""The source papers' own numbers follow from their formulas; printed and right forms differ where they must."""

from __future__ import annotations

import math

import pytest

from compare.approximations import APPROXIMATIONS
from compare.approximations.case import PaperCase
from compare.approximations.gastebois import small_angles
from compare.observed.swing_plane import frequency, precession_period
from reference import load_scene, parse_scene

PARIS = load_scene("paris")
HOUR = 3600


def gastebois(sidereal_hours="23.93", latitude="48.87"):
    """His Panthéon: r0 = 6.5 m, sphere of 6370 km, 23.92 h for the Earth's turn (23.93 h gives his periods)."""
    return parse_scene(
        {
            "id": "gastebois",
            "site": {
                "latitude": latitude,
                "equatorial_radius": "6370000",
                "inverse_flattening": "inf",
                "rotation_rate": repr(2 * math.pi / (float(sidereal_hours) * HOUR)),
                "gravity": "9.81",
            },
            "release": {"x": "6.5", "y": "0"},
        }
    )


# Mathar, sections V and VII; `foucault paper` judges the numbers printed there ------------------------------------
def test_the_frequency_of_the_reference_is_the_papers_cut_off_after_nine_decimals():
    hertz = frequency(PARIS, 1000)
    assert math.floor(hertz * 1e9) == 60843633
    assert float(APPROXIMATIONS["frequency_anharmonic"].value(PARIS)) == pytest.approx(
        hertz, rel=1e-8
    )


def test_the_series_47_comes_nearer_with_every_order():
    truth = APPROXIMATIONS["rest_equation"].value(PARIS)
    gaps = [abs(APPROXIMATIONS[f"rest_series_{i}"].value(PARIS) / truth - 1) for i in (1, 2, 3)]
    assert [f"{float(gap):.0e}" for gap in gaps] == ["1e-03", "1e-06", "1e-09"]
    assert float(APPROXIMATIONS["rest_triangle"].value(PARIS) / truth - 1) == pytest.approx(
        67 / 6390000, rel=0.02
    )


# Gastebois -----------------------------------------------------------------------------------------------------------
def test_the_periods_of_precession_of_4_1_and_6_3():
    def hours(kind, *place):
        return float(APPROXIMATIONS[f"precession_{kind}"].value(gastebois(*place))) / HOUR

    assert f"{hours('sine'):.2f}" == "31.77"
    assert hours("tilted", "23.9345") == pytest.approx(31.74, abs=0.02)
    assert f"{31.74 * hours('spherical') / hours('tilted'):.2f}" == "31.85"
    assert f"{hours('spherical'):.1f}" == "31.8"
    at_49 = hours("sine", "24", "49")
    assert (int(at_49), round(at_49 % 1 * 60)) == (31, 48)


def test_the_swing_plane_turns_by_11_3_degrees_an_hour_in_paris():
    assert f"{360 * HOUR / float(APPROXIMATIONS['precession_sine'].value(PARIS)):.1f}" == "11.3"
    assert f"{360 * HOUR / precession_period(PARIS):.1f}" == "11.3"


def test_the_apparent_latitude_and_the_ellipse_of_6_3():
    case = PaperCase.of_scene(gastebois())
    assert f"{float(case.ctx.degrees(case.apparent_latitude)):.2f}" == "48.97"
    omega, _ = small_angles(case)
    turn = float(case.turn)  # its 5.49e-5 rad/s is without the centrifugal force
    minor = 6.5 * turn / float(omega)
    assert f"{turn:.2e}" == "5.49e-05"
    assert f"{minor * 1e3:.2f}" == "0.93"
    assert 2 * math.pi * minor * 1e3 == pytest.approx(5.88, abs=0.02)
    assert 6.5 * turn * 1e3 == pytest.approx(0.357, abs=5e-4)


def test_the_offset_at_the_first_passage_and_after_one_swing_is_that_of_6_3():
    scene = gastebois().with_values(["site.equatorial_radius=0"])
    omega, turn = map(float, small_angles(PaperCase.of_scene(scene)))
    period = 2 * math.pi / omega
    rows = APPROXIMATIONS["gastebois_6_3"].trajectory(scene, [0.0, period / 4, period])
    assert rows[1, 1] * 1e3 == pytest.approx(0.93, abs=0.01)
    assert rows[2, 1] * 1e3 == pytest.approx(-5.88, abs=0.02)
    assert omega**2 - turn**2 == pytest.approx(9.81 / 67, rel=1e-12)


def test_the_spherical_drift_is_nearer_to_the_truth_at_the_pole_than_without():
    scene = load_scene("pantheon", ["site.latitude=90"])
    truth = precession_period(scene)
    gaps = {
        w: abs(float(APPROXIMATIONS[w].value(scene)) / truth - 1)
        for w in ("precession_tilted", "precession_spherical")
    }
    assert gaps["precession_tilted"] == pytest.approx(3 / 8 * (6.5 / 67) ** 2, rel=0.01)
    assert gaps["precession_spherical"] < 0.02 * gaps["precession_tilted"]


def test_the_printed_45_has_no_solution_in_paris():
    # y² = sqrt(l² - y²) (y - R s - 2 y c²) Ω²/g + c (R y + (l² - 2 y²) s) Ω²/g; the right one has y on the left.
    case = PaperCase.of_scene(PARIS)
    ctx, cord, s, c, R = case.ctx, case.length, case.k.sin, case.k.cos, case.axis_distance

    def right_side(y):
        inner = ctx.sqrt(cord**2 - y**2) * (y - R * s - 2 * y * c**2) + c * (
            R * y + (cord**2 - 2 * y**2) * s
        )
        return inner * case.k.rate**2 / case.gravity

    rest = -cord * ctx.sin(APPROXIMATIONS["rest_equation"].value(PARIS))
    assert abs(right_side(rest) - rest) < 1e-50
    assert all(right_side(y) < y**2 for y in ctx.linspace(-cord, cord, 401))
