"""Gastebois, section 4.2: apparent gravity, with the centrifugal force."""

from __future__ import annotations

from typing import Any

from ..checks import Check, Identity, PrintedNumber
from ..digits import MP, Vector, add, atan2, cos, degrees, dot, norm, pi, sin, sqrt
from ..points import Point, paris
from .frames import turning
from .numbers import EARTH_RADIUS, GRAVITY, PANTHEON_LATITUDE, G


def _sphere(p: Point) -> tuple[Vector, Vector]:
    """Return g towards the centre and Ω² R away from the axis, on east, north, up of a sphere of radius R_p."""
    out = p.rate**2 * p.radius * cos(p.phi)
    return (MP.zero, MP.zero, -p.gravity), (MP.zero, -out * sin(p.phi), out * cos(p.phi))


def apparent(p: Point) -> Vector:
    """Return g_a = g + a_e."""
    return add(*_sphere(p))


def outward(p: Point) -> Any:
    """Return a_e = Ω² R_p cosλ."""
    return p.rate**2 * p.radius * cos(p.phi)


def tilt(p: Point) -> Any:
    """Return α from the vectors."""
    _, north, up = apparent(p)
    return atan2(-north, -up)


def _vertical_rate(p: Point) -> Any:
    """Return the part of Ω along -g_a, over Ω."""
    pull = apparent(p)
    return -dot(turning(p), pull) / norm(pull) / p.rate


def pantheon_on_sphere(s: Any) -> Point:
    """Return the Pantheon on a sphere, Ω² s times the Earth's."""
    base = paris()
    return base.but(radius=EARTH_RADIUS, latitude=PANTHEON_LATITUDE, gravity=GRAVITY, rate=base.rate * sqrt(s))


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    return [
        Identity(
            "gastebois_4_2_cosines",
            f"{G} 4.2",
            "g_a² = g² + a_e² - 2 g a_e cosλ",
            lambda p: p.gravity**2 + outward(p) ** 2 - 2 * p.gravity * outward(p) * cos(p.phi),
            lambda p: dot(apparent(p), apparent(p)),
        ),
        Identity(
            "gastebois_4_2_ga",
            f"{G} 4.2",
            "g_a² = g² + Ω² R_p cosλ - 2 g Ω² R_p cos²λ",
            lambda p: p.gravity**2 + outward(p) - 2 * p.gravity * p.rate**2 * p.radius * cos(p.phi) ** 2,
            lambda p: dot(apparent(p), apparent(p)),
            "g_a² = g² + Ω⁴ R_p² cos²λ - 2 g Ω² R_p cos²λ",
            lambda p: (
                p.gravity**2
                + p.rate**4 * p.radius**2 * cos(p.phi) ** 2
                - 2 * p.gravity * p.rate**2 * p.radius * cos(p.phi) ** 2
            ),
        ),
        Identity(
            "gastebois_4_2_alpha",
            f"{G} 4.2",
            "tanα = a_e sinλ / (g - a_e cosλ) = Ω² R_p cosλ sinλ / (g - Ω² R_p cos²λ)",
            lambda p: (
                outward(p) * sin(p.phi) / (p.gravity - outward(p) * cos(p.phi)),
                p.rate**2 * p.radius * cos(p.phi) * sin(p.phi) / (p.gravity - p.rate**2 * p.radius * cos(p.phi) ** 2),
            ),
            lambda p: (MP.tan(tilt(p)), MP.tan(tilt(p))),
        ),
        Identity(
            "gastebois_4_2_lambda",
            f"{G} 4.2",
            "λ_a = λ + α",
            lambda p: sin(p.phi + tilt(p)),
            _vertical_rate,
            remark="sine of the angle between the axis of the Earth and the plumb line's horizon",
        ),
        Identity(
            "gastebois_4_2_tf",
            f"{G} 4.2",
            "T_f = T_p / sinλ_a",
            lambda p: 2 * pi / p.rate / sin(p.phi + tilt(p)),
            lambda p: 2 * pi / (p.rate * _vertical_rate(p)),
        ),
        PrintedNumber(
            "gastebois_6_3_lambda",
            f"{G} 6.3",
            "λ_a = 48,97°",
            "48.97",
            lambda: PANTHEON_LATITUDE + degrees(tilt(pantheon_on_sphere(MP.one))),
        ),
    ]
