"""Mathar (47): the rest position as a series in Ω², as printed and as derived."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from ..digits import MP, Vector, cos, derivative, scale, sin
from ..first_principles import rest_angle
from ..points import Point


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
def _derived_series(p: Point) -> Vector:
    """Return the same coefficients from the reference's rest position, an even function of Ω."""

    def angle(rate: Any) -> Any:
        return rest_angle(p.but(rate=rate))

    return tuple(derivative(angle, order=power) / MP.factorial(power) for power in (2, 4, 6))


def series_term(i: int) -> tuple[Callable[[Point], Any], Callable[[Point], Any]]:
    """Return a coefficient as printed, and as derived."""
    return lambda p: series(p)[i], lambda p: _derived_series(p)[i]
