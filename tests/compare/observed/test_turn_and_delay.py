"""Swing plane and phase: the turn and the delay that a candidate was given are found again."""

from __future__ import annotations

import numpy as np
import pytest
from small_scenes import make_scene

from compare.observed.swing_plane import Gauge
from compare.observed.turn_and_delay import swing_errors
from reference.engines.trajectory import Variants

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


@pytest.mark.parametrize("turn", [1e-9, 1e-3, 0.4, -1.2])
def test_a_turn_is_found(model, scene, turn):
    truth = model.states(scene.exact, TIMES)
    u = truth[:, :2] - REST
    turned = np.column_stack(
        [np.cos(turn) * u[:, 0] - np.sin(turn) * u[:, 1], np.sin(turn) * u[:, 0] + np.cos(turn) * u[:, 1]]
    )
    found = swing_errors(TIMES, truth, turned - u, REST)
    assert np.allclose(found.turn, turn, rtol=1e-6, atol=1e-15)
    assert found.largest_turn == pytest.approx(abs(turn), rel=1e-6)
    assert found.largest_delay < 1e-6 * max(1.0, abs(turn)) + 1e-12


@pytest.mark.parametrize("delay", [1e-4, -1e-3])
def test_a_delay_is_found(model, scene, delay):
    truth, behind = late(model, scene, delay)
    found = swing_errors(TIMES, truth, (behind - truth)[:, :2], REST)
    assert np.allclose(found.delay, delay, rtol=1e-3)
    assert found.largest_turn < 1e-6


def test_a_turn_that_grows_shows_in_its_parts(model, scene):
    truth = model.states(scene.exact, TIMES)
    u, rate = truth[:, :2] - REST, 1e-6
    error = rate * TIMES[:, None] * np.column_stack([-u[:, 1], u[:, 0]])
    found = swing_errors(TIMES, truth, error, REST)
    assert len(found.t) == 48
    assert np.allclose(found.turn, rate * found.t, rtol=0.02, atol=1e-8)


def test_a_bob_at_rest_has_neither():
    still = np.zeros((30, 6))
    found = swing_errors(np.arange(30.0), still, np.full((30, 2), 1e-3), (0.0, 0.0))
    assert (found.largest_turn, found.largest_delay) == (0.0, 0.0)


@pytest.mark.parametrize("rows", [1, 2])
def test_too_few_rows_are_not_fitted(rows):
    found = swing_errors(np.arange(float(rows)), np.ones((rows, 6)), np.ones((rows, 2)), REST)
    assert found.largest_turn is None
    assert found.largest_delay is None


def test_thinning_a_part_changes_nothing(model, scene, monkeypatch):
    truth = model.states(scene.exact, TIMES)
    u = truth[:, :2] - REST
    error = 1e-3 * np.column_stack([-u[:, 1], u[:, 0]])
    whole = swing_errors(TIMES, truth, error, REST)
    monkeypatch.setattr("compare.observed.turn_and_delay.MOST_ROWS", 15)
    assert np.allclose(swing_errors(TIMES, truth, error, REST).turn, whole.turn, rtol=1e-6)


@pytest.mark.parametrize("turn", [1e-5, 0.3])
def test_a_turn_is_the_difference_of_two_swing_planes(model, turn):
    pole = make_scene(site={"latitude": "90"}, release={"x": "0.3", "y": "0.4"})
    truth, gauge = model.states(pole.exact, TIMES), Gauge.of(pole)
    turned = truth.copy()
    for i in (0, 3):  # position and velocity
        east, north = truth[:, i], truth[:, i + 1]
        turned[:, i], turned[:, i + 1] = (
            np.cos(turn) * east - np.sin(turn) * north,
            np.sin(turn) * east + np.cos(turn) * north,
        )
    fitted = swing_errors(TIMES, truth, (turned - truth)[:, :2], (0.0, 0.0)).turn
    assert fitted == pytest.approx(turn, rel=1e-9)
    assert gauge.swing_plane(turned) - gauge.swing_plane(truth) == pytest.approx(turn, rel=1e-9)
