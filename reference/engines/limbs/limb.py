"""Numbers as limbs of radix 2**22, each an integer in a double: sums and products stay below 2**53, so are exact.

A number is 2 Σ d[q] 2**(-22 (q + 1)) with integer limbs |d[q]| <= 2**21, so with `limb_count` limbs
it is an integer over 2**(22 limb_count - 1). A product of two limbs is below 2**43, so a sum of a
thousand of them is an exact double, in any order, fused or not. Only carrying to the last limb
rounds. Floating-point expansions need error-free transformations instead; here nothing depends on
how a compiler arranges additions.

Eight numbers lie side by side: limb q of all of them is one row of eight doubles.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from ...numbers.precision import Array, to_fraction
from ...numbers.taylor_step import whole
from ..simd.lanes import LANES, compiled, get_row, inlined, nearest, plus_product, set_row, spread
from .size import LIMB_BITS, fraction_bits

RADIX = 2.0**LIMB_BITS
INVERSE = 2.0**-LIMB_BITS
UNIT = 2.0 ** (LIMB_BITS - 1)  # the first limb of 1
DOUBLED = 2.0  # the product of limbs p and q of two numbers counts twice in limb p + q + 1
LARGEST = 2.0 ** (LIMB_BITS + 1)  # a first limb above this (the number 4) might spoil exactness


def split(values: Any, limb_count: int) -> Array:
    """Return the limbs of integers over 2**fraction_bits(limb_count), highest first, shape (..., limb_count)."""
    remainder = np.asarray(values, dtype=object)
    half = 1 << (LIMB_BITS - 1)
    limbs = np.empty((*remainder.shape, limb_count))
    for q in range(limb_count - 1, 0, -1):
        limb = ((remainder + half) & (2 * half - 1)) - half
        limbs[..., q] = limb
        remainder = (remainder - limb) >> LIMB_BITS
    limbs[..., 0] = remainder
    return limbs


def nearest_whole(value: Any, bits: int) -> int:
    """Return an mpf or a rational times 2**bits, rounded to the nearest integer."""
    exact = value if isinstance(value, int | Fraction) else to_fraction(value)
    return round(exact * Fraction(2) ** bits)


def rows_of(numbers: Sequence[Any], limb_count: int) -> Array:
    """Return up to eight mpf or rationals side by side, shape (limb_count * 8,)."""
    bits = fraction_bits(limb_count)
    wholes = [nearest_whole(x, bits) for x in numbers]
    rows = np.zeros((limb_count, LANES))
    rows[:, : len(numbers)] = split(wholes, limb_count).T
    return rows.ravel()


def joined(limbs: Array) -> Any:
    """Return limbs of shape (..., limb_count) as integers over 2**fraction_bits(limb_count): objects, shape (...)."""
    return whole(np.moveaxis(limbs, -1, 0).astype(np.int64))


@inlined
def carry(rows: Array, first: int, last: int) -> None:
    """Bring the rows below `first` into the range of limbs, from the last upwards; exact."""
    radix = spread(RADIX)
    inverse = spread(INVERSE)
    limb = get_row(rows, last)
    for r in range(last, first, -1):
        over = nearest(limb * inverse)
        set_row(rows, r, limb - over * radix)
        limb = get_row(rows, r - 1) + over
    set_row(rows, first, limb)


@inlined
def divide(rows: Array, first: int, last: int, divisor: float) -> None:
    """Divide by an integer below 2**20, from row `first` downwards, and carry.

    The remainder at `last` is dropped.
    """
    radix = spread(RADIX)
    by = spread(divisor)
    inverse = spread(1.0 / divisor)
    remainder = spread(0.0)
    for r in range(first, last + 1):
        limb = plus_product(get_row(rows, r), remainder, radix)
        quotient = nearest(limb * inverse)
        remainder = limb - quotient * by
        set_row(rows, r, quotient)
    carry(rows, max(first - 1, 0), last)


@compiled
def carry_scalar(limbs: Array, last: int) -> None:
    """Bring one number's limbs below the first into range, from the last upwards."""
    for r in range(last, 0, -1):
        over = np.rint(limbs[r] * INVERSE)
        limbs[r] -= over * RADIX
        limbs[r - 1] += over


@compiled
def add_product(to: Array, a: Array, b: Array, start: int, limb_count: int) -> None:
    """Add a b in each lane to rows 0 … limb_count of `to`.

    `a` comes doubled. Limbs of b before `start` are zero.
    """
    for r in range(start + 1, limb_count + 1):
        total = get_row(to, r)
        for q in range(start, r):
            total = plus_product(total, get_row(a, r - 1 - q), get_row(b, q))
        set_row(to, r, total)


@compiled
def set_double(to: Array, value: float, limb_count: int) -> None:
    """Set a number's limbs to a double."""
    to[:] = 0.0
    add_double(to, value, limb_count)


@compiled
def add_double(to: Array, value: float, limb_count: int) -> None:
    """Add a double to a number's limbs."""
    remainder = value * UNIT
    for q in range(limb_count):
        limb = np.rint(remainder)
        to[q] += limb
        remainder = (remainder - limb) * RADIX
    carry_scalar(to, limb_count - 1)


@compiled
def double_of(limbs: Array, limb_count: int, first: int = 0, stride: int = 1) -> float:
    """Return the approximate double value, which has the exact sign, of carried limbs: those `first` + `stride` q."""
    value = 0.0
    for q in range(limb_count - 1, -1, -1):
        value = (value + limbs[first + stride * q]) * INVERSE
    return DOUBLED * value
