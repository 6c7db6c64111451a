"""TRUSTED. Interval arithmetic with FLINT's balls: vectors, norms, endpoints.

A ball contains the number that it stands for; every operation rounds outwards, to the bits of `ctx.prec`. What is
called a bound or a size is an upper bound, rounded upwards.

| name           | symbol                                           |
|----------------|--------------------------------------------------|
| `add`, `times` | a + b, factor times a                            |
| `cross`, `dot` | a × b, a·b                                       |
| `size(a)`      | |a|                                              |
| `total(f)`     | Σ|c_n|, which bounds |f| on |s| <= 1 (section 6) |
"""

from fractions import Fraction
from typing import Any

from flint import arb, arb_series, fmpq, fmpz

from .shapes import Interval

SHORT = 64  # bits for bounds, of which only the leading digits matter
HUGE = fmpz(1) << 64  # a larger bound says nothing about a sphere of radius 1
UNIT = arb(0, 1)  # contains all |s| <= 1
Vector = list[Any]  # three balls, or three integer polynomials


def demand(holds: bool, reason: str) -> None:
    """Raise ArithmeticError unless a condition holds on which the proof rests."""
    if not holds:
        raise ArithmeticError(reason)


def ball(q: Any) -> arb:
    """Return a ball that contains the fraction; a ball, or a series of balls, as it is."""
    if isinstance(q, arb | arb_series):
        return q  # type: ignore[return-value]
    return arb(fmpq(q.numerator, q.denominator))


def upper(x: arb) -> arb:
    """Return an upper bound; raise ArithmeticError if it is not finite or not below 2^64."""
    demand(x < HUGE, "a bound is not finite or has outgrown the sphere")
    return x.upper()


def interval(x: arb) -> Interval:
    """Return the exact endpoints of a ball; raise ArithmeticError if they are not finite or not below 2^128."""
    upper(abs(x) / HUGE)
    low = x.lower().fmpq()
    high = x.upper().fmpq()
    return Interval(Fraction(int(low.p), int(low.q)), Fraction(int(high.p), int(high.q)))


def fixed(values: Vector, bits: int) -> tuple[list[fmpz], arb]:
    """Return integers over 2^bits near the balls, and a bound of the sum of their distances."""
    unit = fmpz(1) << bits
    integers = list[fmpz]()
    distances = list[arb]()
    for x in values:
        n = (x * unit).mid().floor().unique_fmpz() or fmpz(0)
        integers.append(n)
        distances.append((x - arb(n) / unit).abs_upper())
    return integers, upper(sum(distances, arb(0)))


def add(*vectors: Vector) -> Vector:
    """Return the sum."""
    return [sum(x[1:], x[0]) for x in zip(*vectors, strict=True)]


def times(factor: Any, a: Vector) -> Vector:
    """Return the vector times a factor."""
    return [factor * x for x in a]


def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product."""
    return [a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def dot(a: Vector, b: Vector) -> Any:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def size(a: Vector) -> arb:
    """Return an upper bound of the length."""
    squares = upper(sum((x.abs_upper() ** 2 for x in a), arb(0)))
    return upper(squares.sqrt())


def total(f: Any, bits: int) -> arb:
    """Return Σ|c_n| of an integer polynomial over 2^bits, exactly: it bounds the polynomial on complex |s| <= 1."""
    return arb((sum(map(abs, f.coeffs()), fmpz(0)), fmpz(-bits)))
