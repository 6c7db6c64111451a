"""The digits in which the documents are judged: a context of our own, its functions, and how a value is shown."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from reference.precision import bits_of, context

DIGITS = 60  # of every comparison
SHOWN = 18  # of every recomputed value
GUARD_DIGITS = 20  # lost in cancellations at generic points, and more
AGREE_DIGITS = 45  # two formulas that agree to so many digits at every point are the same formula

MP = context(bits_of(DIGITS + GUARD_DIGITS))

Vector = tuple[Any, ...]
Value = Any  # an mpf, an mpc, or a tuple of them

sin, cos, tan, sqrt, asin, acos, atan2 = MP.sin, MP.cos, MP.tan, MP.sqrt, MP.asin, MP.acos, MP.atan2
pi, j = MP.pi, MP.mpc(0, 1)


def mpf(text: Any) -> Any:
    """A decimal string, an integer or a fraction as a number."""
    if hasattr(text, "numerator"):
        return MP.mpf(text.numerator) / text.denominator
    return MP.mpf(text)


def degrees(angle: Any) -> Any:
    """Radians to degrees."""
    return angle * 180 / pi


def radians(angle: Any) -> Any:
    """Degrees to radians."""
    return mpf(angle) * pi / 180


def parts(value: Value) -> Vector:
    """A value as the tuple of its components."""
    return tuple(value) if isinstance(value, tuple) else (value,)


def distance(one: Value, other: Value) -> Any:
    """Largest difference of two values' components."""
    return max(abs(p - q) for p, q in zip(parts(one), parts(other), strict=True))


def size(value: Value) -> Any:
    """Largest component."""
    return max(abs(part) for part in parts(value))


def shown(value: Value, digits: int = SHOWN) -> str:
    """A value as text: a number, or components in brackets; what is zero to all digits compared is "0"."""
    texts = [_shown(MP.mpmathify(part), digits) for part in parts(value)]
    return texts[0] if len(texts) == 1 else f"({', '.join(texts)})"


def _shown(part: Any, digits: int) -> str:
    return "0" if abs(part) < MP.mpf(10) ** -AGREE_DIGITS else str(MP.nstr(part, digits)).removesuffix(".0")


def derivative(function: Callable[[Any], Any], at: Any = 0, order: int = 1) -> Any:
    """A function's derivative of a given order, to all digits: differences at a precision raised enough."""
    return MP.diff(function, MP.mpf(at), order)


def vector_derivative(function: Callable[[Any], Vector], at: Any = 0, order: int = 1) -> Vector:
    """The derivative of a vector."""

    def component(i: int) -> Callable[[Any], Any]:
        return lambda s: function(s)[i]

    return tuple(derivative(component(i), at, order) for i in range(len(function(MP.mpf(at)))))


def dot(a: Vector, b: Vector) -> Any:
    """Scalar product."""
    return sum(p * q for p, q in zip(a, b, strict=True))


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def norm(a: Vector) -> Any:
    """Length of a vector."""
    return sqrt(dot(a, a))


def scale(k: Any, a: Sequence[Any]) -> Vector:
    """The vector k a."""
    return tuple(k * part for part in a)


def add(*vectors: Sequence[Any]) -> Vector:
    """Sum of vectors."""
    return tuple(sum(column) for column in zip(*vectors, strict=True))


def unit(a: Vector) -> Vector:
    """The vector's direction."""
    return scale(1 / norm(a), a)
