"""The numbers behind the figures."""

from __future__ import annotations

import numpy as np
import pytest

from compare.papers import figure_runs, runs
from reference import load, load_scene


def test_a_window_shows_the_golden_states() -> None:
    golden = load("paris")
    times, states = figure_runs.window(12000, 1)
    row = list(golden.t).index(12000.0)
    assert times[0] == 12000.0
    assert states[0, :2] == pytest.approx([golden.x[row], golden.y[row]], abs=1e-13)


def test_frequencies_are_lowest_at_the_equator_and_follow_the_estimate_within_a_nanohertz() -> None:
    frequencies = figure_runs.frequencies()
    assert min(frequencies, key=lambda latitude: frequencies[latitude]) == 0
    for latitude, hertz in frequencies.items():
        assert abs(hertz - figure_runs.estimate_at(latitude)) < 2e-9
    assert frequencies[48.846111] == pytest.approx(0.0608436335, abs=1e-10)


def test_a_higher_order_is_nearer_to_the_truth_after_12000_s() -> None:
    pytest.importorskip("numba")
    _, truth = figure_runs.window(12000, 20, step=0.5)
    states = figure_runs.orders_at(12000, 20, 0.5)
    worst = [float(np.abs(states[name][:, :3] - truth[:, :3]).max()) for name in ("rk4", "rkng56", "rkng67")]
    assert worst[0] > 100 * worst[1] > 1e4 * worst[2] / 100


def test_the_swing_s_direction_of_a_known_ellipse_comes_out() -> None:
    turn, rate = 0.7, 2.0
    t = np.linspace(0, 3, 50)
    along, across = np.cos(rate * t), 0.1 * np.sin(rate * t)
    speed, drift = -rate * np.sin(rate * t), 0.1 * rate * np.cos(rate * t)
    c, s = np.cos(turn), np.sin(turn)
    states = np.array([
        c * along - s * across, s * along + c * across, 0 * t, c * speed - s * drift, s * speed + c * drift, 0 * t,
    ]).T  # fmt: skip
    assert runs.swing_direction(states, np.zeros(3), rate) == pytest.approx(np.full(50, turn), abs=1e-12)


def test_the_rest_position_in_metres_is_that_of_the_golden_page() -> None:
    assert runs.rest_in_metres(load_scene("paris")) == pytest.approx([0, -0.115205163344595, -66.9999009534367])
