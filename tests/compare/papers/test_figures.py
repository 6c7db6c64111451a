"""The numbers behind the figures."""

from __future__ import annotations

import numpy as np
import pytest

from compare.papers import figures, points
from reference import load


def test_a_window_shows_the_golden_states() -> None:
    golden = load("paris")
    times, states = points.window(12000, 1)
    row = list(golden.t).index(12000.0)
    assert times[0] == 12000.0
    assert states[0, :2] == pytest.approx([golden.x[row], golden.y[row]], abs=1e-13)


def test_frequencies_are_lowest_at_the_equator_and_follow_the_estimate_within_a_nanohertz() -> None:
    frequencies = points.frequencies()
    assert min(frequencies, key=lambda latitude: frequencies[latitude]) == 0
    for latitude, hertz in frequencies.items():
        assert abs(hertz - figures.estimate_at(latitude)) < 2e-9
    assert frequencies[48.846111] == pytest.approx(0.0608436335, abs=1e-10)


def test_a_higher_order_is_nearer_to_the_truth_after_12000_s() -> None:
    pytest.importorskip("numba")
    _, truth = points.window(12000, 20, step=0.5)
    states = figures.orders_at(12000, 20, 0.5)
    worst = [float(np.abs(states[name][:, :3] - truth[:, :3]).max()) for name in ("rk4", "rkng56", "rkng67")]
    assert worst[0] > 100 * worst[1] > 1e4 * worst[2] / 100
