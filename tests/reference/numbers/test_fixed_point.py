"""Columns of integers over a power of two, against exact fractions."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference.numbers.table import FixedPoint, integers

BITS = 120
UNIT = Fraction(1, 1 << BITS)
NUMBERS = st.fractions(-1000, 1000, max_denominator=10**30)


def column(*numbers: Fraction) -> FixedPoint:
    return FixedPoint(integers(math.floor(number / UNIT) for number in numbers), BITS)


@given(NUMBERS, NUMBERS)
def test_operations_round_down_to_the_unit(p: Fraction, q: Fraction) -> None:
    a, b = column(p, q), FixedPoint.of(q, BITS)
    (x, _), (y,) = a.fractions(), column(q).fractions()
    assert (a + b).fractions()[0] == x + y
    assert (a - b).fractions()[0] == x - y
    assert (-a).fractions()[0] == -x
    assert (3 * a).fractions()[0] == 3 * x
    assert 0 <= x * y - (a * b).fractions()[0] < UNIT
    assert 0 <= x / 2 - (a / 2).fractions()[0] < UNIT
    if y:
        assert 0 <= x / y - (a / b).fractions()[0] < UNIT
    (root,) = column(abs(p)).sqrt().fractions()
    assert root * root <= abs(p) < (root + UNIT) ** 2 + UNIT


def test_the_root_of_what_is_below_zero_is_zero() -> None:
    assert column(Fraction(-1), Fraction(4)).sqrt().fractions() == [0, 2]


def test_columns_come_from_any_unit_and_rows_can_be_chosen() -> None:
    whole = FixedPoint.column(integers([1, -2, 3 * 10**50]), 10**50, BITS)
    for exact, found in zip((Fraction(1, 10**50), Fraction(-2, 10**50), Fraction(3)), whole.fractions(), strict=True):
        assert 0 <= exact - found < UNIT
    assert whole[np.array([False, True, True])].fractions() == whole.fractions()[1:]


@pytest.mark.parametrize("number", [Fraction(1, 3), mpmath.mpf("0.1"), 0.1, 7])
def test_a_constant_may_be_of_any_type(number: object) -> None:
    assert abs(FixedPoint.of(number, BITS).values / 2**BITS - float(number)) < 1e-15  # type: ignore[arg-type]
