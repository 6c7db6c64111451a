"""TRUSTED. Balls, vectors and norms; a name of a size stands for an upper bound."""

from fractions import Fraction
from typing import Any

from flint import arb, arb_poly, fmpq, fmpz

from .shapes import Interval

SHORT = 64  # bits for bounds, where only the leading digits count
HUGE = fmpz(1) << 64  # nothing that is larger says anything about a sphere of radius 1
UNIT = arb(0, 1)  # all |s| <= 1
Vector = list[Any]  # three balls, or three integer polynomials


def ball(q: Fraction) -> arb:
    """A ball that contains the fraction."""
    return arb(fmpq(q.numerator, q.denominator))


def upper(x: arb) -> arb:
    """An upper bound; refuses what is not finite, or useless."""
    if not x < HUGE:
        raise ArithmeticError("a bound is not finite or has outgrown the sphere")
    return x.upper()


def interval(x: arb) -> Interval:
    """The exact ends of a ball."""
    upper(abs(x) / HUGE)
    ends = ((int(n), int(e)) for n, e in (x.lower().man_exp(), x.upper().man_exp()))
    return Interval(*(Fraction(n << max(e, 0), 1 << max(-e, 0)) for n, e in ends))


def integer(x: arb, bits: int) -> fmpz:
    """An integer near x 2^bits."""
    return (x * (fmpz(1) << bits)).mid().floor().unique_fmpz() or fmpz(0)


def fixed(values: Vector, bits: int) -> tuple[list[fmpz], arb]:
    """Integers over 2^bits, and the distance of the balls from them."""
    whole = [integer(x, bits) for x in values]
    off = [(x - arb(n) / (fmpz(1) << bits)).abs_upper() for x, n in zip(values, whole, strict=True)]
    return whole, upper(sum(off, arb(0)))


def add(*vectors: Vector) -> Vector:
    """The sum."""
    return [sum(x[1:], x[0]) for x in zip(*vectors, strict=True)]


def times(factor: Any, a: Vector) -> Vector:
    """The vector, stretched."""
    return [factor * x for x in a]


def cross(a: Vector, b: Vector) -> Vector:
    """The cross product."""
    return [a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def dot(a: Vector, b: Vector) -> Any:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def size(a: Vector) -> arb:
    """The length."""
    return upper(upper(sum((x.abs_upper() ** 2 for x in a), arb(0))).sqrt())


def norm(f: Vector, bits: int) -> arb:
    """Sup norm on |s| <= 1 of integer polynomials over 2^bits, as a vector."""
    return size([arb_poly(x)(UNIT) / (fmpz(1) << bits) for x in f])
