"""Arithmetic with 60 decimal digits, in which the papers are judged: mpmath context, functions, vectors, text."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from reference.numbers.precision import bits_of, context

DIGITS = 60  # decimal digits in which every comparison is made
SHOWN_DIGITS = 18  # decimal digits of every recomputed value on the page
GUARD_DIGITS = 20  # more than cancellations at the random points cost
AGREE_DIGITS = 45  # two formulas that agree to this many digits at every point are the same formula

MP = context(bits_of(DIGITS + GUARD_DIGITS))
ZERO_BELOW = MP.mpf(10) ** -AGREE_DIGITS

Vector = Any  # an array of numbers, with NumPy's +, -, * and /
Value = Any  # a number, a vector, or a tuple of numbers

cross, dot = np.cross, np.dot
sin, cos, tan, sqrt, asin, acos, atan2 = MP.sin, MP.cos, MP.tan, MP.sqrt, MP.asin, MP.acos, MP.atan2
pi, j = MP.pi, MP.mpc(0, 1)
degrees, radians, norm = MP.degrees, MP.radians, MP.norm  # the norm is the length of a vector
mpf = MP.mpmathify  # a decimal string, an integer or a fraction as a number of this context


def parts(value: Value) -> tuple[Any, ...]:
    """Return a value as the tuple of its components."""
    return tuple(value) if isinstance(value, tuple | np.ndarray) else (value,)


def distance(value: Value, other: Value) -> Any:
    """Return the largest difference of two values' components."""
    return max(abs(p - q) for p, q in zip(parts(value), parts(other), strict=True))


def size(value: Value) -> Any:
    """Return the largest component, in absolute value."""
    return max(abs(part) for part in parts(value))


def vanishes(value: Value) -> bool:
    """Return whether every component is zero to all digits compared."""
    return bool(size(value) < ZERO_BELOW)


def shown(value: Value, digits: int = SHOWN_DIGITS) -> str:
    """Return a value as text: a number, or components in brackets.

    "0" if it is zero to all digits compared.
    """
    numbers = map(MP.mpmathify, parts(value))
    texts = ["0" if abs(x) < ZERO_BELOW else MP.nstr(x, digits).removesuffix(".0") for x in numbers]
    return texts[0] if len(texts) == 1 else f"({', '.join(texts)})"


def derivative(function: Callable[[Any], Any], at: Any = 0, order: int = 1) -> Any:
    """Return a function's or vector's derivative, to all digits: mpmath raises the precision of its differences."""
    return MP.diff(function, MP.mpf(at), order)


def vector(*components: Any) -> Vector:
    """Return a vector."""
    return np.array(components, dtype=object)


def unit(a: Vector) -> Vector:
    """Return the vector's direction."""
    return a / norm(a)
