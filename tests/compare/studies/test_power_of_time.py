"""The exponent of time of errors whose exponent is known."""

from __future__ import annotations

import numpy as np
import pytest

from compare.studies.power_of_time import power_of_time


@pytest.mark.parametrize("power", [0.0, 0.5, 1.0, 1.5, 2.0, 7.0])
@pytest.mark.parametrize("times", [np.linspace(1, 1e4, 5000), np.geomspace(1e-3, 1e9, 300)])
def test_a_power_comes_back_whatever_the_times(power, times):
    assert power_of_time(times, 1e-12 * times**power, 24) == pytest.approx(power, abs=0.01)


def test_an_error_that_swings_grows_as_its_envelope_does():
    t = np.linspace(500, 50000, 400000)  # from sixty half swings on: the first ones have reached no envelope yet
    assert power_of_time(t, 1e-15 * t**1.5 * np.abs(np.sin(0.38 * t)) + 1e-30, 30) == pytest.approx(1.5, abs=0.05)


def test_late_times_count_no_more_than_early_ones():
    t = np.arange(1.0, 10001.0)
    kinked = np.where(t < 100, t, 100.0)  # half of the decades grow, a hundredth of the rows
    assert power_of_time(t, kinked, 40) == pytest.approx(0.5, abs=0.15)


def test_fewer_than_three_points_have_no_power():
    assert power_of_time(np.array([1.0, 10.0]), np.array([1.0, 10.0]), 40) is None
