"""The position error in every number type; power laws beside SciPy's, and the exponent of errors that is known."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.stats import linregress

from compare.observed.position_error import difference, distance, power_law, power_of_time
from reference import InputError

THIRD = Fraction(1, 3)


def test_exact_numbers_keep_a_difference_of_any_size():
    tiny = Fraction(1, 10**60)
    assert difference([THIRD + tiny, THIRD], [THIRD, THIRD + 2 * tiny]) == pytest.approx([1e-60, -2e-60], rel=1e-15)


def test_a_double_is_taken_as_it_stands_beside_an_exact_number():
    doubles = np.array([float(THIRD)])
    off = float(Fraction(float(THIRD)) - THIRD)  # 1.9e-17, which a subtraction of doubles would lose
    assert off != 0
    assert difference(doubles, [THIRD]) == [off]
    assert difference([THIRD], doubles) == [-off]


def test_low_parts_count_where_doubles_agree():
    near, wave = np.linspace(1.0, 60.0, 50), 1e-25 * np.arange(1, 51)
    assert np.array_equal(difference(near, near, wave), wave)
    assert difference(near + 1e-3, near, wave) == pytest.approx(1e-3, rel=1e-11)


def test_columns_of_unlike_length_are_no_trajectories_at_the_same_times():
    with pytest.raises(ValueError, match="zip"):
        difference([THIRD], [THIRD, THIRD])


def test_the_distance_is_that_of_the_components_there_are():
    columns = [np.array([3.0, 0.0]), np.array([4.0, 0.0]), np.array([12.0, 2.0])]
    assert distance(columns).tolist() == [13.0, 2.0]
    assert distance(columns[:2]).tolist() == [5.0, 0.0]


def test_the_power_law_and_its_standard_error_are_those_of_scipy():
    x = [10.0, 19.0, 31.0, 45.0, 74.0]
    y = [0.9, 2.1, 6.3, 11.0, 37.0]
    law, truth = power_law(x, y), linregress([math.log(v) for v in x], [math.log(v) for v in y])
    assert law.exponent == pytest.approx(truth.slope, rel=1e-12)
    assert law.standard_error == pytest.approx(truth.stderr, rel=1e-12)
    assert law.factor == pytest.approx(math.exp(truth.intercept), rel=1e-12)
    assert (law.points, law.low, law.high) == (5, pytest.approx(10), pytest.approx(74))


@pytest.mark.parametrize("x", [[], [1.0, 2.0], [3.0, 3.0, 3.0], [-1.0, 0.0, 2.0]])
def test_a_power_law_needs_three_points_at_different_places(x):
    with pytest.raises(InputError):
        power_law(x, [1.0] * len(x))


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
