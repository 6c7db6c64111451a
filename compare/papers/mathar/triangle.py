"""Mathar, section V: the triangle of gravity and centrifugal force, (48)-(50)."""

from __future__ import annotations

from typing import Any

from ..checks import Approximate, Check, Identity
from ..digits import MP, asin, cos, sin, sqrt
from ..first_principles import rest_angle
from ..points import Point, paris
from .rest import V, pull_at_rest


def triangle_angle(p: Point) -> Any:
    """Return φ by (50)."""
    return asin(p.R * p.rate**2 * sin(p.phi) / p.case.apparent_gravity)


def _shorter(s: Any) -> Point:
    """Return Paris with a cord s times as long."""
    base = paris()
    return base.but(length=base.length * s)


def _slower(s: Any) -> Point:
    """Return Paris with RΩ² s times as large, and a cord of negligible length."""
    base = paris()
    return base.but(rate=base.rate * sqrt(s), length=MP.mpf("1e-50"))


def _two_terms(p: Point) -> Any:
    out, s, c, g = p.R * p.rate**2, sin(p.phi), cos(p.phi), p.gravity
    return s / g * out + c * s / g**2 * out**2


def _one_term(p: Point) -> Any:
    return sin(2 * p.phi) / p.gravity * (p.N + p.altitude) * p.rate**2 / 2


def checks() -> list[Check]:
    """Return the rows of section V from (48) on."""
    return [
        Approximate(
            "mathar_48",
            f"{V} (48)",
            "g' = sqrt(g² + (RΩ²)² - 2 g RΩ² cosϕ)",
            lambda s: (_shorter(s).case.apparent_gravity, pull_at_rest(_shorter(s))),
            1,
            "l",
            "m/s²",
            "N+h stands for the distance of the bob, N+h-l",
        ),
        Identity(
            "mathar_49",
            f"{V} (49)",
            "RΩ² / sinφ = g' / sinϕ",
            lambda p: p.R * p.rate**2 / sin(p.case.tilt),
            lambda p: p.case.apparent_gravity / sin(p.phi),
            remark="the sine rule of the triangle of (48), its angle by atan2",
        ),
        Approximate(
            "mathar_50",
            f"{V} (50)",
            "sinφ = RΩ² sinϕ / sqrt(g² + (RΩ²)² - 2gRΩ² cosϕ)",
            lambda s: (triangle_angle(_shorter(s)), rest_angle(_shorter(s))),
            1,
            "l",
            "rad",
        ),
        Approximate(
            "mathar_50_two",
            f"{V}, after (50)",
            "sinφ ≈ (sinϕ/g) RΩ² + (cosϕ sinϕ/g²) (RΩ²)² + O((RΩ²)³)",
            lambda s: (_two_terms(_slower(s)), sin(triangle_angle(_slower(s)))),
            3,
            "RΩ²",
            "rad",
        ),
        Approximate(
            "mathar_50_one",
            f"{V}, after (50)",
            "sinφ ≈ (1/2) (sin2ϕ/g) (N+h) Ω² + O((RΩ²)²)",
            lambda s: (_one_term(_slower(s)), sin(triangle_angle(_slower(s)))),
            2,
            "RΩ²",
            "rad",
        ),
    ]
