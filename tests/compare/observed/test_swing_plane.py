"""Swing plane, apsides, frequency and precession as they are read off a motion; a turn and a delay are found again."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from small_scenes import make_scene

from compare.approximations import APPROXIMATIONS
from compare.observed.swing_plane import (
    PER_SWING,
    Gauge,
    apsides,
    frequency,
    precession_period,
    rest_in_metres,
)
from compare.score.errors import swing_errors
from reference import UnreachableError, load_scene, parse_scene, trajectory
from reference.engines.trajectory import Variants

PARIS = load_scene("paris")


def rows_of(z, rate):
    still = np.zeros(len(z))
    return np.column_stack((z.real, z.imag, still - 1, rate.real, rate.imag, still))


@pytest.mark.parametrize("turn", [0.0, 0.3, -0.2])
@pytest.mark.parametrize("direction", [0.1, 1.4, -1.2])
def test_the_plane_of_a_turntable_ellipse_is_its_major_axis_at_every_phase(turn, direction):
    omega, t = 2.0, np.linspace(0.0, 9.0, 50)
    gauge = Gauge((0.0, 0.0, -1.0), omega, turn)
    ellipse = np.exp(1j * direction) * (np.cos(omega * t) + 0.2j * np.sin(omega * t))
    speed = np.exp(1j * direction) * omega * (0.2j * np.cos(omega * t) - np.sin(omega * t))
    frame = np.exp(-1j * turn * t)
    plane = gauge.swing_plane(rows_of(frame * ellipse, frame * (speed - 1j * turn * ellipse)))
    assert np.abs(np.sin(plane - direction + turn * t)) == pytest.approx(0, abs=1e-14)


def test_the_rest_position_in_metres_is_that_of_the_golden_page():
    assert rest_in_metres(PARIS) == pytest.approx([0, -0.115205163344595, -66.9999009534367])


def test_a_circle_has_no_plane():
    t = np.linspace(0.0, 3.0, 7)
    circle = np.exp(2j * t)
    assert np.isnan(
        Gauge((0.0, 0.0, -1.0), 2.0, 0.0).swing_plane(rows_of(circle, 2j * circle))
    ).all()


def test_the_plane_of_the_reference_turns_evenly_by_the_sine_of_the_apparent_latitude():
    gauge = Gauge.of(PARIS)
    times = np.linspace(0.0, 3600.0, 3601)
    plane = np.unwrap(2 * gauge.swing_plane(trajectory(PARIS, times))) / 2
    line = np.polyfit(times, plane, 1)
    rate = -7.292115e-5 * math.sin(math.radians(48.846111) + 0.00171948)
    assert line[0] == pytest.approx(rate, rel=1e-4)
    # seconds of arc
    assert np.max(np.abs(plane - np.polyval(line, times))) < math.radians(1 / 3600) * 2


def test_apsides_of_an_ellipse_are_found_to_rounding():
    omega, minor, start = 0.7, 0.1, 0.4
    gauge = Gauge((0.0, 0.0, -1.0), omega, 0.0)
    t = np.arange(600) * (gauge.period / PER_SWING)
    phase = omega * t - start
    rows = rows_of(
        np.cos(phase) + 1j * minor * np.sin(phase),
        omega * (1j * minor * np.cos(phase) - np.sin(phase)),
    )
    times, azimuths = apsides(gauge, t, rows)
    expected = (start + np.pi * np.arange(len(times) + 1)) / omega
    expected = expected[expected > times[0] - 1][: len(times)]
    assert len(times) > 15
    assert times == pytest.approx(expected, abs=1e-10)
    assert np.sin(azimuths) == pytest.approx(0, abs=1e-10)


@pytest.mark.parametrize("amplitude", ["1", "30", "85", "150"])
def test_the_frequency_without_rotation_is_that_of_the_complete_elliptic_integral(amplitude):
    scene = parse_scene(
        {
            "id": "plane",
            "site": {"rotation_rate": "0"},
            "release": {"angle": amplitude, "azimuth": "20"},
        }
    )
    quarter = mpmath.ellipk(mpmath.sin(mpmath.radians(int(amplitude)) / 2) ** 2)
    assert frequency(scene, 20) == pytest.approx(
        float(mpmath.sqrt(mpmath.mpf("9.80665") / 67) / (4 * quarter)), rel=1e-9
    )


def test_at_the_pole_the_plane_comes_round_in_a_sidereal_day_and_the_drift():
    scene = load_scene("pole")
    day = 2 * math.pi / 7.292115e-5
    assert precession_period(scene) == pytest.approx(day * (1 + 3 / 8 * (0.5 / 67) ** 2), rel=1e-8)


def test_what_does_not_swing_or_turn_is_refused():
    with pytest.raises(UnreachableError, match="does not turn"):
        precession_period(load_scene("equator"))
    with pytest.raises(UnreachableError, match="rest position"):
        Gauge.of(PARIS.with_values(["site.gravity=0", "site.rotation_rate=0"]))
    fast = PARIS.with_values(
        ["site.latitude=90", "site.rotation_rate=3", "release.x=0", "release.y=0"]
    )
    with pytest.raises(UnreachableError):
        frequency(fast)


def test_an_approximation_swings_about_its_own_point_of_rest():
    motion = APPROXIMATIONS["linear_g"]
    gauge = Gauge.of(PARIS, motion.rest(PARIS))
    plane = gauge.swing_plane(motion.trajectory(PARIS, np.linspace(0.0, 20.0, 41)))
    assert plane[0] == pytest.approx(math.atan2(0.4, 0.3), abs=1e-6)
    assert np.ptp(plane) < 2e-3  # turned by 20 s of 11 degrees an hour


TIMES = np.linspace(0.0, 3600.0, 1801)
REST = (0.0, -0.115)


@pytest.fixture(scope="module")
def model():
    return Variants()


@pytest.fixture(scope="module")
def scene():
    return make_scene(release={"x": "0.3", "y": "0.4", "vx": "0.02", "vy": "-0.01"})


def late(model, scene, delay):
    """The truth at t, and what a program that is late by `delay` seconds has there."""
    times = TIMES + 10.0
    both = model.states(scene.exact, np.unique(np.concatenate([[0.0], times, times - delay])))
    grid = np.unique(np.concatenate([[0.0], times, times - delay]))
    return both[np.searchsorted(grid, times)], both[np.searchsorted(grid, times - delay)]


def turned(u, turn):
    """The vectors x, y, shape (rows, 2), turned from east to north by an angle in radians."""
    return u @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])


@pytest.mark.parametrize("turn", [1e-9, 1e-3, 0.4, -1.2])
def test_a_turn_is_found(model, scene, turn):
    truth = model.states(scene.exact, TIMES)
    u = truth[:, :2] - REST
    found = swing_errors(truth, turned(u, turn) - u, REST)
    assert np.allclose(found.turn, turn, rtol=1e-6, atol=1e-15)
    assert found.largest_turn == pytest.approx(abs(turn), rel=1e-6)
    assert found.largest_delay < 1e-6 * max(1.0, abs(turn)) + 1e-12


@pytest.mark.parametrize("delay", [1e-4, -1e-3])
def test_a_delay_is_found(model, scene, delay):
    truth, behind = late(model, scene, delay)
    found = swing_errors(truth, (behind - truth)[:, :2], REST)
    assert np.allclose(found.delay, delay, rtol=1e-3)
    assert found.largest_turn < 1e-6


def test_a_turn_that_grows_shows_in_its_parts(model, scene):
    truth = model.states(scene.exact, TIMES)
    u, rate = truth[:, :2] - REST, 1e-6
    error = rate * TIMES[:, None] * np.column_stack([-u[:, 1], u[:, 0]])
    found = swing_errors(truth, error, REST)
    middle = [part.mean() for part in np.array_split(TIMES, 48)]
    assert np.allclose(found.turn, rate * np.array(middle), rtol=0.02, atol=1e-8)


def test_a_bob_at_rest_has_neither():
    still = np.zeros((30, 6))
    found = swing_errors(still, np.full((30, 2), 1e-3), (0.0, 0.0))
    assert (found.largest_turn, found.largest_delay) == (0.0, 0.0)


@pytest.mark.parametrize("rows", [1, 2])
def test_too_few_rows_are_not_fitted(rows):
    found = swing_errors(np.ones((rows, 6)), np.ones((rows, 2)), REST)
    assert found.largest_turn is None
    assert found.largest_delay is None


def test_of_many_rows_a_few_show_the_same_turn(model, scene):
    truth = model.states(scene.exact, np.linspace(0.0, 3600.0, 36001))
    u = truth[:, :2] - REST
    error = 1e-3 * np.column_stack([-u[:, 1], u[:, 0]])
    few = swing_errors(truth[::20], error[::20], REST)
    assert np.allclose(swing_errors(truth, error, REST).turn, few.turn, rtol=1e-6)


@pytest.mark.parametrize("turn", [1e-5, 0.3])
def test_a_turn_is_the_difference_of_two_swing_planes(model, turn):
    pole = make_scene(site={"latitude": "90"}, release={"x": "0.3", "y": "0.4"})
    truth, gauge = model.states(pole.exact, TIMES), Gauge.of(pole)
    other = truth.copy()
    for i in (0, 3):  # position and velocity
        other[:, i : i + 2] = turned(truth[:, i : i + 2], turn)
    fitted = swing_errors(truth, (other - truth)[:, :2], (0.0, 0.0)).turn
    assert fitted == pytest.approx(turn, rel=1e-9)
    assert gauge.swing_plane(other) - gauge.swing_plane(truth) == pytest.approx(turn, rel=1e-9)
