"""Limbs: exact products and sums, whatever the compiler fuses or rearranges; a canary for its options."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("numba")

import numba

from reference.engines.limbs.limb import (
    add_product,
    carry,
    divide,
    joined,
    nearest_whole,
    rows_of,
    split,
)
from reference.engines.limbs.size import LIMB_BITS, fraction_bits
from reference.engines.simd.lanes import LANES, aligned
from reference.numbers.precision import context

LIMB_COUNT = 7


def compiled_with(**options):
    """A multiplication and a division of eight numbers at once, compiled under other options than the package's."""

    @numba.njit(error_model="numpy", **options)
    def multiply_and_divide(to, a, b, limb_count, divisor):
        add_product(to, a, b, 0, limb_count)
        carry(to, 0, limb_count)
        divide(to, 0, limb_count, divisor)

    return multiply_and_divide


usual = compiled_with()
careless = compiled_with(fastmath=True)


def product_over(a, b, divisor, run):
    rows_a, rows_b, to = (
        rows_of(a, LIMB_COUNT),
        rows_of(b, LIMB_COUNT),
        aligned(LANES * (LIMB_COUNT + 2)),
    )
    run(to, 2.0 * rows_a, rows_b, LIMB_COUNT, float(divisor))
    return joined(to[: LANES * LIMB_COUNT].reshape(LIMB_COUNT, LANES).T)


numbers = st.lists(
    st.fractions(min_value=-1, max_value=1, max_denominator=10**50), min_size=8, max_size=8
)


@given(
    st.integers(
        min_value=-(2 ** fraction_bits(LIMB_COUNT)), max_value=2 ** fraction_bits(LIMB_COUNT)
    )
)
def test_an_integer_comes_back_from_its_limbs(value):
    limbs = split(value, LIMB_COUNT)
    assert all(abs(d) <= 2 ** (LIMB_BITS - 1) for d in limbs)
    assert joined(np.array(limbs)) == value


def test_a_product_and_a_quotient_are_off_by_less_than_the_last_limbs(size):
    @settings(max_examples=size(25, 100))
    @given(numbers, numbers, st.integers(min_value=1, max_value=4096))
    def of_any_numbers(a, b, divisor):
        one = 2 ** fraction_bits(LIMB_COUNT)
        for got, x, y in zip(product_over(a, b, divisor, usual), a, b, strict=True):
            assert abs(got - Fraction(round(x * one) * round(y * one), divisor * one)) < 4

    of_any_numbers()


def test_canary_a_compiler_that_may_rearrange_and_fuse_gives_the_same_bits(size):
    @settings(max_examples=size(25, 100))
    @given(numbers, numbers, st.integers(min_value=1, max_value=4096))
    def of_any_numbers(a, b, divisor):
        assert (product_over(a, b, divisor, usual) == product_over(a, b, divisor, careless)).all()

    of_any_numbers()


def test_canary_the_largest_limbs_there_can_be_are_multiplied_exactly():
    limb_count, largest = 18, 2.0 ** (LIMB_BITS - 1)
    rows, to = np.full(LANES * limb_count, largest), aligned(LANES * (limb_count + 2))
    exact = numba.njit(error_model="numpy")(
        lambda to, a, b, limb_count: add_product(to, a, b, 0, limb_count)
    )
    for _ in range(56):  # as many orders as can meet where all limbs are used
        exact(to, 2.0 * rows, rows, limb_count)
    for r in range(1, limb_count + 1):
        assert int(to[LANES * r]) == 56 * r * 2 * int(largest) ** 2


def test_a_number_is_rounded_once_on_its_way_to_limbs():
    ctx = context(400)
    third = ctx.mpf(1) / 3
    assert nearest_whole(third, 100) == round(Fraction(2**100, 3))
    assert nearest_whole(-third, 100) == -round(Fraction(2**100, 3))
    assert nearest_whole(Fraction(1, 3), 10) == 341
