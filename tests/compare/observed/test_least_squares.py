"""Gauss-Newton: known numbers come back, and a search that leads nowhere keeps what it had. Power laws."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from compare.observed.least_squares import (
    Numbers,
    best_change,
    by_differences,
    gauss_newton,
    power_law,
    power_of_time,
    solved,
)
from reference import InputError

TIMES = np.linspace(0.0, 3.0, 40)


def decay(rows: Numbers) -> Callable[[Numbers], tuple[Numbers, Callable[[], Numbers]]]:
    """Return the model a exp(-k t) of a and k."""

    def model(numbers: Numbers) -> tuple[Numbers, Callable[[], Numbers]]:
        a, k = numbers
        shape = np.exp(-k * TIMES)
        return rows - a * shape, lambda: np.column_stack([shape, -a * TIMES * shape])

    return model


@pytest.mark.parametrize("numbers", [(2.0, 0.7), (1e-9, 0.7), (2.0, 0.7 + 3j)])
def test_the_numbers_of_exact_rows_come_back(numbers: tuple[complex, complex]) -> None:
    a, k = numbers
    start = np.array([1.3 * a, k + 0.1])
    found, norm = gauss_newton(decay(a * np.exp(-k * TIMES)), start, steps=12, gain=0.9)
    assert found == pytest.approx(np.array(numbers), rel=1e-12)
    assert norm < 1e-13 * abs(a)


def test_a_linear_model_needs_one_step() -> None:
    slopes = np.column_stack([np.ones_like(TIMES), 1e9 * TIMES])
    rows = slopes @ [3.0, -2e-9]
    found, _ = gauss_newton(
        lambda numbers: (rows - slopes @ numbers, lambda: slopes), np.zeros(2), steps=1, gain=1.0
    )
    assert found == pytest.approx(np.array([3.0, -2e-9]), rel=1e-12)


def test_a_number_that_changes_nothing_is_left_alone() -> None:
    change = best_change(np.column_stack([TIMES, np.zeros_like(TIMES)]), 2.0 * TIMES)
    assert change == pytest.approx(np.array([2.0, 0.0]))


def test_damping_holds_back_what_rows_hardly_tell_apart() -> None:
    slopes = np.column_stack([TIMES, TIMES + 1e-9 * TIMES**2])
    residuals = TIMES**2
    free = best_change(slopes, residuals)
    held = best_change(slopes, residuals, damping=1e-3)
    assert np.abs(free).max() > 1e8 > 10 > np.abs(held).max()


def test_a_step_that_gains_too_little_is_not_taken() -> None:
    start = np.array([2.0, 0.7])
    rows = 2.0 * np.exp(-0.7 * TIMES) + np.cos(40 * TIMES)
    found, norm = gauss_newton(decay(rows), start, steps=12, gain=0.5)
    assert found is start and norm == pytest.approx(float(np.linalg.norm(np.cos(40 * TIMES))))


def test_if_the_first_residual_is_not_finite_its_norm_is_infinite() -> None:
    found, norm = gauss_newton(decay(np.full_like(TIMES, np.nan)), np.ones(2), steps=3, gain=0.9)
    assert found.tolist() == [1.0, 1.0] and math.isinf(norm)


def test_slopes_by_differences_find_the_same_numbers() -> None:
    model = by_differences(
        lambda n: n[0] * np.exp(-n[1] * TIMES), 2.0 * np.exp(-0.7 * TIMES), np.array([1e-6, 1e-6])
    )
    found, _ = gauss_newton(model, np.array([1.5, 0.9]), steps=12, gain=0.9)
    assert found == pytest.approx(np.array([2.0, 0.7]), rel=1e-12)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_refused_and_lapack_prints_nothing(bad, capfd):
    matrix, right = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 7.0]]), np.array([1.0, 2.0, 3.0])
    assert solved(matrix, matrix @ [2.0, -1.0]) == pytest.approx([2.0, -1.0])
    for place in (matrix[1, 1:], right[2:]):
        kept = place[0]
        place[0] = bad
        with pytest.raises(np.linalg.LinAlgError):
            solved(matrix, right)
        place[0] = kept
    assert capfd.readouterr() == ("", "")


def test_the_power_law_and_its_standard_error_are_those_of_scipy():
    from scipy.stats import linregress  # whose import takes more than a second

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
    # from sixty half swings on: the first ones have reached no envelope yet
    t = np.linspace(500, 50000, 400000)
    assert power_of_time(t, 1e-15 * t**1.5 * np.abs(np.sin(0.38 * t)) + 1e-30, 30) == pytest.approx(
        1.5, abs=0.05
    )


def test_late_times_count_no_more_than_early_ones():
    t = np.arange(1.0, 10001.0)
    kinked = np.where(t < 100, t, 100.0)  # half of the decades grow, a hundredth of the rows
    assert power_of_time(t, kinked, 40) == pytest.approx(0.5, abs=0.15)


def test_fewer_than_three_points_have_no_power():
    assert power_of_time(np.array([1.0, 10.0]), np.array([1.0, 10.0]), 40) is None
