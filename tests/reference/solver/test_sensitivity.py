"""The response to inputs: against finite differences, and against two golden datasets that differ by rounding."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from small_scenes import make_scene

from reference import load
from reference.engines.trajectory import Variants
from reference.solver.sensitivity import Sensitivity, with_value

TIMES = np.linspace(0.0, 600.0, 31)
SCENES = {
    "paris": make_scene(
        pendulum={"drag": "1e-4"}, release={"x": "0.3", "y": "0.4", "vx": "0.01", "vy": "-0.02"}
    ),
    "wide": make_scene(
        pendulum={"length": "2"},
        release={"angle": "70", "azimuth": "20", "angle_rate": "3", "azimuth_rate": "-4"},
        site={"latitude": "-12", "altitude": "800"},
    ),
}
NUDGES = {
    "site.rotation_rate": "1e-9",
    "site.equatorial_radius": "10",
    "site.altitude": "10",
    "site.inverse_flattening": "0.1",
    "site.latitude": "1e-4",
    "pendulum.drag": "1e-8",
}


@cache
def response_of(scene):
    return Sensitivity(SCENES[scene], TIMES)


@cache
def model():
    """Another formulation, compiled once for all inputs."""
    return Variants()


@pytest.mark.parametrize(
    ("scene", "name"), [(s, n) for s in SCENES for n in sorted(SCENES[s].exact.by_name)]
)
def test_a_derivative_is_the_limit_of_differences(scene, name):
    response = response_of(scene)
    value, nudge = SCENES[scene].exact.by_name[name], Fraction(NUDGES.get(name, "1e-6"))
    ahead, behind = (
        model().states(with_value(SCENES[scene].exact, name, value + side * nudge), TIMES)
        for side in (1, -1)
    )
    expected = (ahead - behind) / (2 * float(nudge))
    derivative = response.derivative(name)
    # rounding of the states over the nudge, and a third-order term, are what differences lose
    noise = np.abs(ahead).max(axis=0) * 2.0**-52 / float(nudge)
    assert np.all(
        np.abs(derivative - expected).max(axis=0) <= 1e-5 * np.abs(expected).max() + noise
    )


def test_the_rounding_of_the_inputs_is_the_difference_of_the_two_golden_datasets():
    decimal, binary = load("paris"), load("paris.binary64")
    rows = range(0, 1441, 60)
    times = decimal.t[::60]
    moved = Sensitivity(decimal.scene, times).rounding()
    for i, name in enumerate(("x", "y", "z", "vx", "vy", "vz")):
        pairs = zip(binary.exact(name), decimal.exact(name), strict=True)
        differences = [float(b - a) for a, b in ((d, n) for n, d in pairs)]
        expected = np.array([differences[k] for k in rows])
        scale = np.abs(moved[:, :3] if i < 3 else moved[:, 3:]).max()
        assert np.abs(moved[:, i] - expected).max() < 1e-5 * scale
    # rounding the inputs of Paris moves the bob by 5e-13 m in a day
    assert 1e-13 < np.abs(moved[:, :3]).max() < 1e-12


def test_inputs_that_are_doubles_already_move_nothing():
    scene = load("paris.binary64").scene
    assert not Sensitivity(scene, TIMES).rounding().any()


def test_on_a_sphere_there_is_no_flattening_to_vary():
    scene = make_scene(site={"inverse_flattening": "inf"})
    assert "site.inverse_flattening" not in scene.exact.by_name


def test_a_release_answers_to_its_own_coordinates_at_once():
    first = Sensitivity(SCENES["paris"], TIMES).derivative("release.x")[0]
    assert first[:2].tolist() == [1.0, 0.0]
    assert first[2] == pytest.approx(0.3 / 66.998134301, rel=1e-9)  # z = -sqrt(l² - x² - y²)
