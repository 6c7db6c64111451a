"""Number types (double, long double, MPFR), bits, decimal digits, exact conversions, rounding.

Precision is always an argument: each has an mpmath context of its own, and the global one is never
touched.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from numbers import Integral
from typing import Any

import mpmath
import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# Bits beyond a run's precision, with which its constants and conversions are computed before they
# are rounded
GUARD_BITS = 64
DOUBLE_BITS = 53
LONG_DOUBLE_BITS = 64


@dataclass(frozen=True)
class NumberType:
    """A number type: its name, its precision in bits, and whether the processor computes in it."""

    name: str
    prec: int
    hardware: bool = False

    def __str__(self) -> str:
        return self.name if self.hardware else f"{self.name}({self.prec})"


DOUBLE = NumberType("double", DOUBLE_BITS, hardware=True)
LONG_DOUBLE = NumberType("long_double", LONG_DOUBLE_BITS, hardware=True)


def real(prec: int) -> NumberType:
    """Return the type of binary floating-point numbers (MPFR) with `prec` bits."""
    return NumberType("real", prec)


def cheapest_type(prec: int) -> NumberType:
    """Return the fastest type with at least `prec` bits."""
    if prec <= DOUBLE_BITS:
        return DOUBLE
    return LONG_DOUBLE if prec <= LONG_DOUBLE_BITS else real(prec)


def double_below(q: Fraction) -> float:
    """Return the largest double that is not above a fraction."""
    near = q.numerator / q.denominator
    return near if Fraction(near) <= q else math.nextafter(near, -math.inf)


@lru_cache(maxsize=64)
def context(prec: int) -> Any:
    """Return the shared mpmath context of `prec` bits, which must not be changed; creating one takes 3 ms."""
    ctx = mpmath.mp.clone()
    ctx.prec = prec
    return ctx


def to_mpf(value: Fraction, ctx: Any) -> Any:
    """Return `value` in the context's precision of p bits, with a relative error below 2**(1 - p).

    The numerator is rounded, then the quotient: a numerator of at most p bits is exact, and then
    the error is at most 2**-p.
    """
    return ctx.mpf(value.numerator) / value.denominator


def to_fraction(value: Any) -> Fraction:
    """Return an mpf, or a finite number of Python's or numpy's types, as the exact fraction."""
    if isinstance(value, Integral):
        return Fraction(int(value))
    if not hasattr(value, "_mpf_"):
        return Fraction(*value.as_integer_ratio())
    sign, mantissa, exponent, _ = value._mpf_
    if not mantissa and exponent:
        raise ValueError(f"{value} is not finite")
    signed = -int(mantissa) if sign else int(mantissa)
    return Fraction(signed * 2**exponent) if exponent >= 0 else Fraction(signed, 2**-exponent)


def bits_of(digits: float) -> int:
    """Return the number of bits that hold `digits` decimal digits."""
    return math.ceil(digits * log2(10))


def log2(value: float) -> float:
    """Return the logarithm to base 2, the same on every machine.

    That of libm may differ in its last bit.
    """
    return float(context(DOUBLE_BITS + GUARD_BITS).log(value, 2))


def rounded(numerator: int, denominator: int) -> int:
    """Return the integer nearest to a quotient, ties to even; the denominator is above zero."""
    whole, remainder = divmod(numerator, denominator)
    twice = 2 * remainder
    if twice > denominator or (twice == denominator and whole & 1):
        return whole + 1
    return whole


def fixed_decimal(value: Fraction, decimals: int) -> str:
    """Return a number as text with `decimals` digits after the point, ties to even; never "-0"."""
    whole = rounded(value.numerator * 10**decimals, value.denominator)
    return with_decimal_point(whole, decimals)


def with_decimal_point(whole: int, decimals: int) -> str:
    """Return an integer as text with a decimal point before its last digits; never "-0"."""
    sign = "-" if whole < 0 else ""
    if not decimals:
        return f"{sign}{abs(whole)}"
    digits = str(abs(whole)).rjust(decimals + 1, "0")
    return f"{sign}{digits[:-decimals]}.{digits[-decimals:]}"


def endpoint_text(value: Fraction, side: int, decimals: int = 20) -> str:
    """Return the end of an interval as text, rounded down (side -1) or up (side 1)."""
    scaled = value * 10**decimals
    whole = math.floor(scaled) if side < 0 else math.ceil(scaled)
    return with_decimal_point(whole, decimals)


def decimals_for(largest: Fraction, digits: int) -> int:
    """Return how many decimals show a column's largest number with `digits` significant digits."""
    return max(0, digits - 1 - magnitude(largest)) if largest else digits


def magnitude(value: Fraction) -> int:
    """Return floor(log10(value)) of a positive number exactly: its leading digit's power of ten."""
    bits = value.numerator.bit_length() - value.denominator.bit_length()
    # the value is below 2**(bits + 1); texts of integers are limited
    guess = math.floor((bits + 1) * math.log10(2))
    while value < Fraction(10) ** guess:
        guess -= 1
    return guess


def rounded_up(value: Fraction) -> str:
    """Return a bound as text with two significant digits, rounded up, such as "1.3e-45"."""
    if value <= 0:
        return "0"
    power = magnitude(value)
    digits = math.ceil(value / Fraction(10) ** (power - 1))
    if digits == 100:
        digits = 10
        power += 1
    return f"{digits // 10}.{digits % 10}e{power:+03d}"


def digits_that_hold(value: float, error: float) -> str:
    """Return a number with the digits that its error leaves, or ± the error if that is larger.

    Without an error it has all digits of its double; a dash stands for an unknown number or error.
    """
    if not math.isfinite(value) or math.isnan(error):
        return "–"
    if error == 0:
        return repr(float(value))
    if error >= abs(value):
        return f"± {error:.1e}"
    first = math.floor(math.log10(abs(value)))
    last = math.ceil(math.log10(error))
    return f"{value:.{first - last + 1}g}"
