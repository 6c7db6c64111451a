"""Mathar (47): the rest position as a series in Ω², as printed and as derived."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from ..digits import MP, Vector, cos, scale, sin, sqrt
from ..first_principles import rest_angle
from ..points import Point, points


def series(p: Point) -> Vector:
    """Return the coefficients of Ω², Ω⁴, Ω⁶ in (47), for λ = -90°."""
    far, length, g, double = p.N + p.altitude, p.length, p.gravity, 2 * p.phi
    c2, c4 = cos(double), cos(2 * double)
    bracket = far**2 * (c4 + 3 * c2 + 2)
    bracket -= far * length * (MP.mpf(37) / 8 * c4 + MP.mpf(11) / 8 + 6 * c2)
    bracket += length**2 * (MP.mpf(35) / 8 * c4 + MP.mpf(13) / 8)
    terms = (1 / (2 * g), (far * (1 + c2) / 2 - length * c2) / (2 * g**2), bracket / (12 * g**3))
    return scale(sin(double) * (far - length), terms)


@cache
def _derived_series(index: int) -> Vector:
    """Return the same coefficients from the reference's rest position: its Taylor series in Ω²."""
    p = points()[index]

    def angle(square: Any) -> Any:
        return rest_angle(p.but(rate=sqrt(square))) if square else MP.zero

    return tuple(_taylor(angle, order) for order in (1, 2, 3))


def _taylor(function: Callable[[Any], Any], order: int) -> Any:
    """Return one Taylor coefficient at 0 from one-sided differences: the square of Ω is not negative.

    The differences cancel, so they are taken at four times the working precision, in this block only.
    """
    working = MP.prec
    step = MP.ldexp(1, -working // 2)
    terms = 4
    with MP.workprec(4 * working):
        values = [function(step * k) for k in range(order + terms + 1)]
        nodes = list(range(len(values)))
        return _newton(nodes, values)[order] / step**order


def _newton(nodes: list[int], values: list[Any]) -> list[Any]:
    """Return the coefficients of the interpolating polynomial, in powers of the node variable."""
    table = list(values)
    for depth in range(1, len(nodes)):
        for i in range(len(nodes) - 1, depth - 1, -1):
            table[i] = (table[i] - table[i - 1]) / (nodes[i] - nodes[i - depth])
    polynomial = [MP.zero]
    for k in range(len(nodes) - 1, -1, -1):
        shifted = [MP.zero, *polynomial]
        polynomial = [a - nodes[k] * b for a, b in zip(shifted, [*polynomial, MP.zero], strict=True)]
        polynomial[0] += table[k]
    return polynomial


def series_term(i: int) -> tuple[Callable[[Point], Any], Callable[[Point], Any]]:
    """Return a coefficient as printed, and as derived."""
    places = {p: index for index, p in enumerate(points())}
    return lambda p: series(p)[i], lambda p: _derived_series(places[p])[i]
