"""What a printed number says beyond the double next to it.

More than 17 digits do not mean more than a double: C prints as many as it is asked for. A number has more to
say only if it is not its double, rounded to the digits that were printed.
"""

from __future__ import annotations

import math
from decimal import Context, Decimal

DOUBLE_DIGITS = 17  # a double printed with so many is known
SURE_DIGITS = 15  # any decimal of so many survives a double: more precise programs mean the decimal itself
_EXACT = Context(prec=40)


def significant_digits(text: str) -> int:
    """Significant digits of a printed number."""
    return sum(map(str.isdigit, text.lower().partition("e")[0].strip().lstrip("+-0.")))


def lacking(text: str, near: float) -> float:
    """The printed number minus `near`, the double next to it; 0 if nothing shows that it is another number."""
    if significant_digits(text) <= DOUBLE_DIGITS:
        return 0.0
    printed, difference = _difference(text, near)
    half_a_unit = Decimal((0, (5,), int(printed.as_tuple().exponent) - 1))
    return 0.0 if abs(difference) <= half_a_unit else float(difference)


def lacking_of_time(text: str, near: float) -> float:
    """The same for a time beside numbers of more digits than a double: there 0.1 is the decimal, not its double."""
    if significant_digits(text) <= SURE_DIGITS:
        return float(_difference(text, near)[1])
    return lacking(text, near)


def _difference(text: str, near: float) -> tuple[Decimal, Decimal]:
    if near == 0 or not math.isfinite(near):  # what a double takes for 0 is below every scale here
        return Decimal(0), Decimal(0)
    printed = Decimal(text.strip())
    return printed, _EXACT.subtract(printed, Decimal(near))
