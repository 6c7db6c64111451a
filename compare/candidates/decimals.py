"""The difference between a printed decimal and its nearest double.

More than 17 digits need not mean a number more precise than a double: C prints as many digits as it is told to. A
number is more precise only if it differs from its nearest double, rounded to the printed digits.
"""

from __future__ import annotations

import math
from decimal import Context, Decimal

DOUBLE_DIGITS = 17  # decimal digits that identify a double
SURE_DIGITS = 15  # decimals of up to this many digits survive a double, so a precise program means the decimal itself
_EXACT = Context(prec=40)  # rounds a difference to 40 digits, far more than a low part holds


def significant_digits(text: str) -> int:
    """Count the significant digits of a printed number."""
    return sum(map(str.isdigit, text.lower().partition("e")[0].strip().lstrip("+-0.")))


def low_part(text: str, near: float) -> float:
    """Return the printed number minus `near`, its nearest double; 0 if it may be just that double, printed."""
    if significant_digits(text) <= DOUBLE_DIGITS:
        return 0.0
    printed, difference = _difference(text, near)
    half_a_unit = Decimal((0, (5,), int(printed.as_tuple().exponent) - 1))
    return 0.0 if abs(difference) <= half_a_unit else float(difference)


def low_part_of_time(text: str, near: float) -> float:
    """Return the same for a time beside numbers more precise than doubles: there 0.1 is the decimal itself."""
    if significant_digits(text) <= SURE_DIGITS:
        return float(_difference(text, near)[1])
    return low_part(text, near)


def _difference(text: str, near: float) -> tuple[Decimal, Decimal]:
    if near == 0 or not math.isfinite(near):  # a number that underflows to 0 is below every scale here
        return Decimal(0), Decimal(0)
    printed = Decimal(text.strip())
    return printed, _EXACT.subtract(printed, Decimal(near))
