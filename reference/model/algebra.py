"""Arithmetic for numbers of any type (mpf, binary64, heyoka expression) that leaves exact zeros out.

An exact zero is the int 0. It drops out of every sum and product here, so the equations of a scene
hold only the terms that the scene has.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from functools import reduce
from typing import Any, Protocol

from .constants import Vector, is_zero

State = Sequence[Any]


class Functions(Protocol):
    """Elementary functions of a number type: an mpmath context, or the module heyoka."""

    def sqrt(self, x: Any, /) -> Any:
        """Return the square root."""

    def sin(self, x: Any, /) -> Any:
        """Return the sine."""

    def cos(self, x: Any, /) -> Any:
        """Return the cosine."""


def product(*factors: Any) -> Any:
    """Return the product, or the int 0 if any factor is exactly zero."""
    return 0 if any(map(is_zero, factors)) else reduce(operator.mul, factors)


def plus(*terms: Any) -> Any:
    """Return the sum of the terms that are not exactly zero."""
    left = [term for term in terms if not is_zero(term)]
    return reduce(operator.add, left) if left else 0


def minus(a: Any, b: Any) -> Any:
    """Return the difference, leaving out an exact zero."""
    return a if is_zero(b) else (-b if is_zero(a) else a - b)


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return (
        minus(product(a[1], b[2]), product(a[2], b[1])),
        minus(product(a[2], b[0]), product(a[0], b[2])),
        minus(product(a[0], b[1]), product(a[1], b[0])),
    )


def dot(a: Vector, b: Vector) -> Any:
    """Return the scalar product."""
    return plus(*(product(p, q) for p, q in zip(a, b, strict=True)))


def scale(k: Any, a: Vector) -> Vector:
    """Return the vector k a."""
    return (product(k, a[0]), product(k, a[1]), product(k, a[2]))


def add(a: Vector, b: Vector) -> Vector:
    """Return the vector a + b."""
    return (plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2]))


def subtract(a: Vector, b: Vector) -> Vector:
    """Return the vector a - b."""
    return (minus(a[0], b[0]), minus(a[1], b[1]), minus(a[2], b[2]))
