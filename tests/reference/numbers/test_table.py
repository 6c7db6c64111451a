"""The fixed-point table against exact fractions: rounding, distance, decimals, decided digits; columns in formulas."""

from __future__ import annotations

import math
from decimal import ROUND_HALF_EVEN, Decimal, localcontext
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference.enclosure.trusted.shapes import Interval
from reference.numbers.columns import GRID, KINDS, RUN, TRANSITS, UNITS
from reference.numbers.table import FixedPoint, Table, decimals_of, integers, resolved

numbers = st.integers(min_value=-(2**80), max_value=2**80)


def table(rows, bits=8, errors=(), columns=("x", "y")):
    return Table(columns, bits, [tuple(row) for row in rows], [tuple(row) for row in errors])


@given(numbers, st.integers(min_value=0, max_value=40), st.integers(min_value=0, max_value=25))
def test_a_printed_number_is_the_decimal_nearest_to_it(value, bits, places):
    (text,) = table([(value,)], bits, columns=("x",)).printed({"x": places})[0]
    with localcontext() as context:
        context.prec = 200
        exact = Decimal(value) / Decimal(2**bits)
        assert Decimal(text) == exact.quantize(Decimal(1).scaleb(-places), ROUND_HALF_EVEN)
    assert len(text.partition(".")[2]) == places
    assert text.strip("-0.") or not text.startswith("-")


@given(
    st.lists(st.tuples(numbers, numbers), min_size=1, max_size=5),
    st.integers(0, 20),
    st.integers(0, 20),
)
def test_the_distance_of_two_tables_is_that_of_their_fractions(rows, bits, other_bits):
    one, other = table(rows, bits), table([(y, x) for x, y in rows], other_bits)
    gaps = one.distance(other)
    for name in one.columns:
        exact = [abs(a - b) for a, b in zip(one.exact(name), other.exact(name), strict=True)]
        assert gaps.exact(name) == exact
        assert gaps.largest()[name] == max(exact)


def test_a_column_is_given_as_doubles_in_two_ways():
    columns = table([(256, 1), (-128, 2)])
    assert columns["x"].tolist() == columns.array("x").tolist() == [1.0, -0.5]


def test_columns_are_taken_by_name_whatever_their_order():
    one = table([(1, 2), (3, 4)], errors=[(5, 6), (7, 8)])
    turned = one.only(("y", "x"))
    assert turned.exact("x") == one.exact("x") == [Fraction(1, 256), Fraction(3, 256)]
    assert turned.bound("y") == one.bound("y") == [Fraction(6, 256), Fraction(8, 256)]
    assert one["y"].tolist() == [2 / 256, 4 / 256]
    assert (one.whole("y", 8), one.whole("y", 11)) == ([2, 4], [16, 32])
    assert len(one) == 2
    assert one.largest_bounds() == {"x": Fraction(7, 256), "y": Fraction(8, 256)}
    with pytest.raises(KeyError, match="no column 'z'; the columns are x, y"):
        one.exact("z")


def test_a_table_without_rows_has_zeros_for_its_largest_numbers():
    assert table([]).largest() == {"x": 0, "y": 0}


@given(numbers, st.integers(min_value=0, max_value=2**40), st.integers(min_value=0, max_value=12))
def test_a_digit_is_decided_just_where_both_ends_of_the_interval_are_printed_alike(
    value, error, places
):
    one = table([(value,)], 30, [(error,)], columns=("x",))
    ends = [
        table([(value + side * error,)], 30, columns=("x",)).printed({"x": places})
        for side in (-1, 1)
    ]
    undecided = one.undecided({"x": places})
    assert (undecided is None) == (ends[0] == ends[1])
    if undecided:
        assert undecided == (
            Fraction(error * 10**places, 2**30),
            "x",
            one.printed({"x": places})[0][0],
        )


@given(st.fractions(), st.fractions(min_value=0))
def test_intervals_are_rounded_outwards(middle, radius):
    one = Table.of_intervals(("x",), [[Interval(middle - radius, middle + radius)]], 20)
    (value,), (error,) = one.exact("x"), one.bound("x")
    assert value - error <= middle - radius
    assert middle + radius <= value + error
    assert error <= radius + Fraction(3, 2**20)


def test_errors_are_rounded_up_for_all_rows():
    one = table([(1, 2), (3, 4)])
    third = {"x": Fraction(1, 3), "y": Fraction(1, 256)}
    assert one.with_errors(third).errors == [(86, 1), (86, 1)]


def test_a_column_of_rounding_noise_takes_the_digits_of_its_kind():
    sizes = resolved(
        {"x": Fraction(1), "y": Fraction(1, 10**9), "z": Fraction(60)},
        dict.fromkeys("xyz", Fraction(1, 10**9)),
    )
    assert sizes == {"x": 1, "y": 60, "z": 60}
    assert decimals_of(sizes, 10) == {"x": 9, "y": 8, "z": 8}


def test_every_column_has_a_kind_and_a_unit():
    for name in {*RUN, *GRID, *TRANSITS}:
        assert name in KINDS[name]
        assert UNITS[KINDS[name]]


BITS = 120
UNIT = Fraction(1, 1 << BITS)
FRACTIONS = st.fractions(-1000, 1000, max_denominator=10**30)


def column(*numbers):
    return FixedPoint(integers(math.floor(number / UNIT) for number in numbers), BITS)


@given(FRACTIONS, FRACTIONS)
def test_operations_round_down_to_the_unit(p, q):
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


def test_the_root_of_what_is_below_zero_is_zero():
    assert column(Fraction(-1), Fraction(4)).sqrt().fractions() == [0, 2]


def test_columns_come_from_any_unit_and_rows_can_be_chosen():
    whole = FixedPoint.column(integers([1, -2, 3 * 10**50]), 10**50, BITS)
    for exact, found in zip(
        (Fraction(1, 10**50), Fraction(-2, 10**50), Fraction(3)), whole.fractions(), strict=True
    ):
        assert 0 <= exact - found < UNIT
    assert whole[np.array([False, True, True])].fractions() == whole.fractions()[1:]


@pytest.mark.parametrize("number", [Fraction(1, 3), mpmath.mpf("0.1"), 0.1, 7])
def test_a_constant_may_be_of_any_type(number):
    assert abs(FixedPoint.of(number, BITS).values / 2**BITS - float(number)) < 1e-15
