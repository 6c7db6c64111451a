"""Number types and conversions: they lose nothing, or no more than they say."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference.engines.heyoka.conversions import Numbers
from reference.numbers.precision import (
    DOUBLE,
    LONG_DOUBLE,
    bits_of,
    cheapest_type,
    context,
    decimals_for,
    digits_that_hold,
    double_below,
    endpoint_text,
    fixed_decimal,
    magnitude,
    real,
    rounded,
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


@given(st.integers(1, 10**30), st.integers(1, 10**30))
def test_a_long_numerator_costs_one_more_rounding(numerator, denominator):
    value = Fraction(numerator, denominator)
    relative = abs(to_fraction(to_mpf(value, context(53))) / value - 1)
    assert relative < Fraction(1, 2**52)
    if value.numerator < 2**53:
        assert relative <= Fraction(1, 2**53)


def test_infinity_is_no_fraction():
    with pytest.raises(ValueError, match="not finite"):
        to_fraction(mpmath.mpf("inf"))


@given(fractions, st.integers(0, 50))
def test_a_printed_number_is_within_half_of_its_last_digit(value, decimals):
    text = fixed_decimal(value, decimals)
    assert abs(Fraction(text) - value) <= Fraction(1, 2 * 10**decimals)
    assert len(text.partition(".")[2]) == decimals
    assert not (text.startswith("-") and Fraction(text) == 0)


@pytest.mark.parametrize("denominator", range(1, 9))
def test_a_quotient_is_rounded_to_the_nearest_integer_and_ties_to_even(denominator):
    for numerator in range(-40, 41):
        assert rounded(numerator, denominator) == round(Fraction(numerator, denominator))


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
    assert rounded_up(Fraction(0)) == rounded_up(Fraction(-1)) == "0"


@pytest.mark.parametrize(
    ("value", "text"),
    [("0.99", "9.9e-01"), ("0.991", "1.0e+00"), ("99", "9.9e+01"), ("99.1", "1.0e+02"), ("1", "1.0e+00"),
     ("1.01", "1.1e+00"), ("1e-45", "1.0e-45"), ("1.21e120", "1.3e+120")],
)  # fmt: skip
def test_bounds_at_the_powers_of_ten(value, text):
    assert rounded_up(Fraction(value)) == text


@given(fractions)
def test_the_double_below_a_fraction_is_the_largest_that_is_not_above_it(value):
    below = double_below(value)
    assert Fraction(below) <= value < Fraction(math.nextafter(below, math.inf))
    assert double_below(Fraction(below)) == below


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [(12.3456, 0.01, "12.35"), (12.3456, 0.02, "12.3"), (-0.0123456, 1e-5, "-0.01235"), (99.9, 1.0, "1e+02"),
     (0.7, 0.6, "0.7"), (0.5, 0.5, "± 5.0e-01"), (-0.5, 0.5, "± 5.0e-01"), (-0.1, 0.25, "± 2.5e-01")],
)  # fmt: skip
def test_a_number_is_shown_with_the_digits_that_its_error_leaves(value, error, text):
    assert digits_that_hold(value, error) == text


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [(0.1, 0.0, "0.1"), (0.0, 0.0, "0.0"), (0.0, 0.5, "± 5.0e-01"), (0.1, math.inf, "± inf"),
     (0.1, math.nan, "–"), (math.nan, 0.1, "–"), (math.inf, 0.1, "–"), (0, 0, "0.0")],
)  # fmt: skip
def test_a_number_without_an_error_is_shown_in_full_and_an_unknown_one_as_a_dash(
    value, error, text
):
    assert digits_that_hold(value, error) == text


@given(st.integers(1, 2000))
def test_so_many_bits_hold_the_digits_and_one_less_do_not(digits):
    assert 2 ** bits_of(digits) >= 10**digits > 2 ** (bits_of(digits) - 1)


def test_the_ends_of_an_interval_are_rounded_outwards():
    third = Fraction(1, 3)
    assert (endpoint_text(third, -1), endpoint_text(third, 1)) == (
        f"0.{'3' * 20}",
        f"0.{'3' * 19}4",
    )
    assert (endpoint_text(-third, -1, 2), endpoint_text(-third, 1, 2)) == ("-0.34", "-0.33")
    assert endpoint_text(Fraction(1, 4), -1, 2) == endpoint_text(Fraction(1, 4), 1, 2) == "0.25"


def test_a_column_of_zeros_and_one_of_large_numbers_have_their_decimals():
    assert decimals_for(Fraction(0), 12) == 12
    # a number has no fewer digits than it takes to write
    assert decimals_for(Fraction(12345), 3) == 0


@pytest.mark.parametrize("value", [0, 1, -3, 2**80, -(2**80), 0.1, -0.375, 3 * 2**70])
def test_any_number_is_its_own_fraction(value):
    assert to_fraction(value) == Fraction(value) == to_fraction(context(100).mpf(value))


@pytest.mark.parametrize(
    ("prec", "name"),
    [(40, "double"), (53, "double"), (54, "long_double"), (64, "long_double"), (65, "real")],
)
def test_the_cheapest_type_that_serves_is_taken(prec, name):
    assert cheapest_type(prec).name == name


@pytest.mark.parametrize("number", [DOUBLE, LONG_DOUBLE, real(300)], ids=str)
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
