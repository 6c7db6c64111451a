"""Numbers as digits of radix 2**22, each digit an integer in a double: arithmetic that is exact by size alone.

A number is 2 Σ d[q] 2**(-22 (q + 1)) with whole digits |d[q]| <= 2**21, so of `limbs` digits it is an integer over
2**(22 limbs - 1). A product of two digits is below 2**43, so a sum of a thousand of them is an exact double, in any
order, fused or not. Only carrying to the last digit rounds. That replaces the error-free transformations of
floating-point expansions: nothing hangs on how a compiler arranges additions.

Eight numbers lie side by side: digit q of all of them is one row of eight doubles.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from ...precision import to_fraction
from .lanes import LANES, compiled, inlined, load, nearest, plus_product, spread, store

Array = npt.NDArray[np.float64]

DIGIT_BITS = 22
RADIX = 2.0**DIGIT_BITS
INVERSE = 2.0**-DIGIT_BITS
UNIT = 2.0 ** (DIGIT_BITS - 1)  # the first digit of 1
DOUBLED = 2.0  # of two numbers' digits p and q the product belongs to digit p + q + 1, twice
LARGEST = 2.0 ** (DIGIT_BITS + 1)  # a first digit above this (the number 4) might spoil exactness
MOST_LIMBS = 18  # with more, and the order that goes with them, sums could pass 2**53


def fraction_bits(limbs: int) -> int:
    """A number of so many digits is an integer over two to this power."""
    return DIGIT_BITS * limbs - 1


def split(value: int, limbs: int) -> list[float]:
    """The digits of an integer over 2**fraction_bits(limbs), first the highest."""
    half, digits = 1 << (DIGIT_BITS - 1), []
    for _ in range(limbs - 1):
        digit = ((value + half) & (2 * half - 1)) - half
        digits.append(float(digit))
        value = (value - digit) >> DIGIT_BITS
    return [float(value), *digits[::-1]]


def nearest_whole(value: Any, bits: int) -> int:
    """An mpf or a rational times 2**bits, to the nearest integer."""
    exact = value if isinstance(value, int | Fraction) else to_fraction(value)
    return round(exact * Fraction(2) ** bits)


def rows_of(numbers: Sequence[Any], limbs: int) -> Array:
    """Up to eight mpf or rationals side by side, shape (limbs * 8,)."""
    made = np.zeros((limbs, LANES))
    for lane, number in enumerate(numbers):
        made[:, lane] = split(nearest_whole(number, fraction_bits(limbs)), limbs)
    return made.ravel()


def joined(digits: Array) -> Any:
    """Digits of shape (..., limbs) as integers over 2**fraction_bits(limbs), an object array of shape (...)."""
    limbs = digits.shape[-1]
    whole = digits.astype(np.int64)
    if limbs % 2:
        whole = np.concatenate([np.zeros_like(whole[..., :1]), whole], axis=-1)
    pairs = ((whole[..., ::2] << DIGIT_BITS) + whole[..., 1::2]).astype(object)
    total = pairs[..., 0]
    for place in range(1, pairs.shape[-1]):
        total = (total << (2 * DIGIT_BITS)) + pairs[..., place]
    return total


@compiled
def clear(rows: Array, count: int) -> None:
    """Set `count` rows to zero."""
    for r in range(count):
        store(rows, LANES * r, spread(0.0))


@inlined
def carry(rows: Array, first: int, last: int) -> None:
    """Bring the rows below `first` to digits, from the last upwards; exact."""
    radix, inverse = spread(RADIX), spread(INVERSE)
    digit = load(rows, LANES * last)
    for r in range(last, first, -1):
        over = nearest(digit * inverse)
        store(rows, LANES * r, digit - over * radix)
        digit = load(rows, LANES * (r - 1)) + over
    store(rows, LANES * first, digit)


@inlined
def divide(rows: Array, first: int, last: int, divisor: float) -> None:
    """Divide by a whole number below 2**20, from `first` downwards; what is left at `last` is dropped."""
    radix, by, inverse = spread(RADIX), spread(divisor), spread(1.0 / divisor)
    rest = spread(0.0)
    for r in range(first, last + 1):
        digit = plus_product(load(rows, LANES * r), rest, radix)
        quotient = nearest(digit * inverse)
        rest = digit - quotient * by
        store(rows, LANES * r, quotient)


@compiled
def carry_scalar(digits: Array, last: int) -> None:
    """Bring one number's digits below the first into range, from the last upwards."""
    for r in range(last, 0, -1):
        over = np.rint(digits[r] * INVERSE)
        digits[r] -= over * RADIX
        digits[r - 1] += over


@compiled
def add_product(to: Array, a: Array, b: Array, start: int, limbs: int) -> None:
    """Add a b lane by lane to rows 0 … limbs of `to`; digits of a are doubled, those of b before `start` are zero."""
    for r in range(start + 1, limbs + 1):
        total = load(to, LANES * r)
        for q in range(start, r):
            total = plus_product(total, load(a, LANES * (r - 1 - q)), load(b, LANES * q))
        store(to, LANES * r, total)


def aligned(count: int) -> Array:
    """Zeros that start on a cache line: a row is one."""
    made = np.zeros(count + LANES)
    begin = -made.ctypes.data // made.itemsize % LANES
    return made[begin : begin + count]
