"""The position error in every number type: exact numbers, doubles with low parts, plain doubles."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from compare.observed.position_error import difference, distance

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
