"""Number types and conversions: they lose nothing, or no more than they say."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference.engines.heyoka.numbers import Numbers
from reference.precision import (
    DOUBLE,
    LONG_DOUBLE,
    cheapest_type,
    context,
    decimals_for,
    fixed_decimal,
    magnitude,
    real,
    rounded_up,
    to_fraction,
    to_mpf,
)

fractions = st.fractions(min_value=-(10**9), max_value=10**9, max_denominator=10**30)
positive = st.fractions(min_value=Fraction(1, 10**40), max_value=10**12, max_denominator=10**45)


def test_the_global_mpmath_context_is_never_touched():
    before = mpmath.mp.prec
    assert context(500).prec == 500
    assert mpmath.mp.prec == before


@given(fractions)
def test_an_mpf_and_back_is_within_half_a_unit(value):
    ctx = context(200)
    back = to_fraction(to_mpf(value, ctx))
    assert abs(back - value) <= abs(value) * Fraction(1, 2**200)


def test_infinity_is_no_fraction():
    with pytest.raises(ValueError, match="not finite"):
        to_fraction(mpmath.mpf("inf"))


@given(fractions, st.integers(0, 50))
def test_a_printed_number_is_within_half_of_its_last_digit(value, decimals):
    text = fixed_decimal(value, decimals)
    assert abs(Fraction(text) - value) <= Fraction(1, 2 * 10**decimals)
    assert len(text.partition(".")[2]) == decimals
    assert not (text.startswith("-") and Fraction(text) == 0)


@given(positive)
def test_magnitude_is_the_power_of_ten_of_the_leading_digit(value):
    power = magnitude(value)
    assert Fraction(10) ** power <= value < Fraction(10) ** (power + 1)


@given(positive, st.integers(1, 60))
def test_the_largest_number_of_a_column_gets_the_digits_asked(value, digits):
    decimals = decimals_for(value, digits)
    if decimals > 0:
        assert decimals + magnitude(value) + 1 == digits
    else:
        assert decimals == 0
        assert value >= Fraction(10) ** (digits - 1)


@given(positive)
def test_a_bound_is_rounded_up_to_two_digits(value):
    text = rounded_up(value)
    assert value <= Fraction(text) <= value * Fraction(11, 10)
    assert len(text.partition("e")[0]) == 3


def test_a_bound_of_nothing_is_zero():
    assert rounded_up(Fraction(0)) == "0"


@pytest.mark.parametrize(("prec", "name"), [(40, "double"), (53, "double"), (54, "long_double"), (65, "real")])
def test_the_cheapest_type_that_serves_is_taken(prec, name):
    assert cheapest_type(prec).name == name


@pytest.mark.parametrize("number", [DOUBLE, LONG_DOUBLE, real(113), real(300)], ids=str)
@given(value=fractions)
def test_constants_enter_every_type_rounded_once(number, value):
    numbers = Numbers(number)
    array = np.array([numbers.of(value)], dtype=numbers.dtype)
    exact = Fraction(numbers.fixed(array, 600)[0], 2**600) if value else 0
    assert abs(exact - value) <= abs(value) * Fraction(1, 2**number.prec)


def test_a_decimal_reaches_real_as_itself_and_not_through_a_double():
    numbers = Numbers(real(200))
    tenth = np.array([numbers.of(Fraction(1, 10))], dtype=numbers.dtype)
    error = Fraction(numbers.fixed(tenth, 400)[0], 2**400) - Fraction(1, 10)
    assert abs(error) < Fraction(1, 2**203)
    assert abs(Fraction(0.1) - Fraction(1, 10)) > Fraction(1, 2**60)
