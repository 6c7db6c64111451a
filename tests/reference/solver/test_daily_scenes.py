"""A laboratory's pendulum and a museum's: g, drag and the turn of the plane are what their files say they are."""

from __future__ import annotations

import math

import pytest

from reference import load_scene, solve

SCENES = ("laboratory", "museum")
DAY = 86164.0905  # s, sidereal


def normal_gravity(latitude: float) -> float:
    """Return g on the ellipsoid of GRS 80 in m/s², by Somigliana's formula (H. Moritz, Geodetic Reference System)."""
    sin2 = math.sin(math.radians(latitude)) ** 2
    return 9.7803267715 * (1 + 0.001931851353 * sin2) / math.sqrt(1 - 0.00669438002290 * sin2)


@pytest.fixture(scope="module", params=SCENES)
def solved(request):
    return solve(load_scene(request.param), level="computed", digits=9)


def test_its_g_is_the_measured_one_at_its_latitude(solved):
    site = solved.scene.site
    assert site.gravity_is == "effective"
    assert float(site.gravity) == pytest.approx(normal_gravity(float(site.latitude)), abs=5e-6)


def test_its_plane_turns_clockwise_as_its_title_says(solved):
    scene, turning = solved.scene, solved.transits
    turned = math.atan2(turning["y"][-1], turning["x"][-1]) - math.atan2(
        float(scene.release.y), float(scene.release.x)
    )
    # the last turning point may lie on either side
    degrees = abs((math.degrees(turned) + 90) % 180 - 90)
    rate = 360 / DAY * math.sin(math.radians(float(scene.site.latitude)))
    # the narrow ellipse of a release from rest precesses by itself, by 3/8 of (amplitude/length)² of the turn at most
    length, amplitude = (
        float(scene.pendulum.length),
        math.hypot(float(scene.release.x), float(scene.release.y)),
    )
    width = rate / math.sqrt(float(scene.site.gravity) / length)
    own = 3 / 8 * (amplitude / length) ** 2 * degrees
    assert degrees == pytest.approx(rate * turning["t"][-1], abs=own + width)
    assert f"turns by {rate * float(scene.run.t_end):.1f} degrees" in scene.title


def test_drag_halves_the_swing_in_ten_minutes(solved):
    scene, turning = solved.scene, solved.transits
    ends = math.hypot(turning["x"][-1], turning["y"][-1]) / math.hypot(
        float(scene.release.x), float(scene.release.y)
    )
    expected = math.exp(-float(scene.pendulum.drag) * turning["t"][-1] / 2)
    assert ends == pytest.approx(expected, rel=2e-3)
    assert scene.id == "museum" or expected == pytest.approx(0.5, rel=0.01)
