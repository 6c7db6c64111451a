"""Programs whose motion more than one mistake makes: what is said as certain is true of each of them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from adaptive import Loose
from mistakes import Told, told

from reference import Scene, load_scene, trajectory

RATE = 7.292115e-5
TIMES = np.linspace(0, 600, 301)
EXACT = 1e-13  # relative tolerance of a solver that has no step error
EFFECTIVE = "site.gravity_is=effective"


def paris(*settings: str) -> Scene:
    return load_scene(
        "paris", ["run.t_end=700", "run.transits=false", "inputs=binary64", *settings]
    )


def explained(
    positions: np.ndarray, scene: Scene, times: np.ndarray = TIMES, allowed_m: float = 5e-7
) -> Told:
    """Return what is told of x and y in m, shape (rows, 2)."""
    columns = {"x": positions[:, 0].copy(), "y": positions[:, 1].copy()}
    return told(scene, times, columns, allowed_m)


def run(scene: Scene) -> np.ndarray:
    """Return x and y of a right program in m."""
    return trajectory(scene, TIMES)[:, :2]


def certain(found: Told) -> set[str]:
    """Return the ids of what is said of a program; nothing else is said."""
    causes = found.explanation.causes
    assert all(cause.stage not in ("as_if", "either") for cause in causes)
    return {cause.id for cause in causes}


@pytest.mark.parametrize(
    ("place", "typed"),
    [
        ((), "90"),
        (("site.latitude=-33",), "-90"),
        (("site.latitude=0",), "90"),
        ((EFFECTIVE,), "90"),
    ],
)
def test_a_latitude_of_90_degrees_is_one_cause(place: tuple[str, ...], typed: str) -> None:
    at_pole = paris(*place, f"site.latitude={typed}")
    found = explained(run(at_pole), paris(*place))
    assert certain(found) == {"pole"}
    (cause,) = found.explanation.causes
    assert f"latitude {typed}," in cause.text
    assert found.explanation.corrected_m < 1e-12


def test_the_other_pole_is_the_other_hemisphere_too() -> None:
    scene = paris("site.latitude=-33")
    found = explained(run(paris("site.latitude=90")), scene)
    ids = {cause.id for cause in found.explanation.causes}
    assert ids == {"pole", "hemisphere|coriolis_sign"}


def test_beside_a_latitude_of_90_degrees_another_mistake_has_its_name() -> None:
    found = explained(run(paris("site.latitude=90", "site.gravity=9.81")), paris())
    assert certain(found) == {"pole", "gravity_9.81"}


def test_a_plane_turned_by_hand_with_all_of_omega_is_the_motion_at_the_pole() -> None:
    """No sine of the latitude: what is said of the pole is true of it as well."""
    swing = math.sqrt(9.80665 / 67)
    plane = (0.3 + 0.4j) * np.cos(swing * TIMES) * np.exp(-1j * RATE * TIMES)
    found = explained(np.column_stack([plane.real, plane.imag]), paris())
    assert certain(found) == {"linear_g", "pole", "inertial_rest"}
    (text,) = [cause.text for cause in found.explanation.causes if cause.id == "pole"]
    assert "no sine of the latitude" in text


def test_of_few_digits_all_of_omega_is_told_and_not_more() -> None:
    """Five decimals: beside an effective g the pole differs from no sine of the latitude by less."""
    square = 9.80665 / 67 + RATE**2
    swing = math.sqrt(square)
    turned = np.cos(swing * TIMES) + 1j * RATE / swing * np.sin(swing * TIMES)
    plane = (0.3 + 0.4j) * np.exp(-1j * RATE * TIMES) * turned
    rows = np.column_stack([plane.real, plane.imag]).round(5)
    assert "no_sine" in explained(rows, paris(EFFECTIVE)).words


@pytest.mark.parametrize(
    ("length", "changes", "ids"),
    [
        (67.0, False, {"no_lift"}),
        (10000.0, False, {"no_lift", "uniform_gravity"}),
        (10000.0, True, {"no_lift"}),
    ],
)
def test_without_the_vertical_centrifugal_force_no_other_g_is_told(
    length: float, changes: bool, ids: set[str]
) -> None:
    """Its motion is nearly that of a larger g of many digits, or of a step error."""
    start = (0.03 * length, 0.04 * length)
    times = np.linspace(0, 36 * math.sqrt(length), 201)
    scene = paris(
        f"pendulum.length={length}",
        f"release.x={start[0]}",
        f"release.y={start[1]}",
        f"run.t_end={times[-1] + 1}",
    )
    latitude = float(scene.exact.latitude)
    made = Loose(scene, times, length, 9.80665, latitude, RATE, start, "DOP853", EXACT)
    made.lift = 0.0
    made.changes = changes
    found = told(scene, times, made.rows(), 5e-8 * length)
    assert certain(found) == ids


@pytest.mark.parametrize(
    ("factors", "word"),
    [
        ((0.0, 1.0), "no_tilt"),
        ((1.0, 0.0), "no_lift"),
        ((-1.0, 1.0), "tilt_sign"),
        ((2.0, 1.0), "tilt_double"),
        ((1.0, -1.0), "lift_sign"),
        ((1.0, 2.0), "lift_double"),
        ((-1.0, -1.0), "centrifugal_sign"),
        ((2.0, 2.0), "centrifugal_double"),
    ],
)
def test_a_part_of_the_centrifugal_force_is_told_and_no_other_g(
    factors: tuple[float, float], word: str
) -> None:
    """Each motion is also that of another g, with or without the force at the suspension."""
    scene = paris()
    latitude = float(scene.exact.latitude)
    x, y = (float(value) for value in scene.exact.position[:2])
    made = Loose(scene, TIMES, 67.0, 9.80665, latitude, RATE, (x, y), "DOP853", EXACT)
    made.suspension = factors
    made.coriolis = 0.5
    assert certain(told(scene, TIMES, made.rows(), 7e-7)) == {word, "coriolis_half"}


def test_a_sign_of_the_coriolis_force_may_be_that_of_the_rate() -> None:
    """Both are one motion, and are said as one."""
    other_rate = explained(run(paris(f"site.rotation_rate={-RATE}")), paris())
    latitude = float(paris().exact.latitude)
    made: Any = Loose(
        paris(), TIMES, 67.0, 9.80665, latitude, RATE, (0.3, 0.4), "DOP853", EXACT, coriolis=-1.0
    )
    other_force = told(paris(), TIMES, made.rows(), 5e-7)
    assert certain(other_rate) == certain(other_force) == {"coriolis_sign"}
    (cause,) = other_rate.explanation.causes
    assert "Coriolis force" in cause.text and "Earth" in cause.text


@pytest.mark.parametrize(
    ("factor", "said"),
    [
        (1 + 1 / 300, "too fast by one part in 300"),
        (1 - 1 / 301, "too slow by one part in 301"),
        (1.01, "too fast by one part in 100"),
    ],
)
def test_a_clock_that_may_be_a_linspace_s_is_too_fast_or_too_slow(factor: float, said: str) -> None:
    """The printed times are those of the motion times a factor, as from a `linspace`, or from anything else."""
    count = 101 if factor == 1.01 else 301
    found = explained(run(paris())[:count], paris(), factor * TIMES[:count])
    assert certain(found) == {"linspace_clock"}
    (cause,) = found.explanation.causes
    assert said in cause.text and ", as from a linspace" in cause.text
