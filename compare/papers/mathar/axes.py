"""Mathar, section II: the suspension and the axes at the site, (1)-(6)."""

from __future__ import annotations

from typing import Any

from reference.model.earth import axis_distance

from ..checks import Check, Finding, Identity, Statement
from ..digits import MP, Vector, add, cos, cross, dot, norm, scale, shown, sin, sqrt, unit, vector_derivative
from ..first_principles import suspension, turned_to_site
from ..points import Point, points

II = "Mathar II"
AXES = ((MP.one, MP.zero, MP.zero), (MP.zero, MP.one, MP.zero), (MP.zero, MP.zero, MP.one))  # east, north, up


def printed_suspension(p: Point, t: Any) -> Vector:
    """Return the place of the suspension by (1)."""
    turn, flat = p.rate * t, (p.N + p.altitude) * cos(p.phi)
    return (flat * cos(turn), flat * sin(turn), (p.N * (1 - p.e2) + p.altitude) * sin(p.phi))


def east(p: Point, t: Any) -> Vector:
    """Return the unit vector e_E by (4)."""
    return (-sin(p.rate * t), cos(p.rate * t), MP.zero)


def up(p: Point, t: Any) -> Vector:
    """Return the unit vector e_U by (5)."""
    return (cos(p.phi) * cos(p.rate * t), cos(p.phi) * sin(p.rate * t), sin(p.phi))


def north(p: Point, t: Any) -> Vector:
    """Return the unit vector e_N by (6)."""
    return (-sin(p.phi) * cos(p.rate * t), -sin(p.phi) * sin(p.rate * t), cos(p.phi))


def _along_meridian(p: Point) -> Vector:
    """Return dX_s/dϕ from the ellipsoid's geometry."""
    return vector_derivative(lambda phi: suspension(p, p.rate * p.t, phi=phi), p.phi)


def _meridian_radius(p: Point) -> Any:
    return p.radius * (1 - p.e2) / (1 - p.e2 * sin(p.phi) ** 2) ** MP.mpf("1.5")


def _not_the_north_direction() -> Finding:
    p = points()[0]
    gap = norm(cross(unit(_along_meridian(p)), north(p, p.t)))
    return Finding(gap > MP.mpf("1e-45"), f"sine of the angle between them: {shown(gap)}")


def _is_the_north_direction() -> bool:
    return all(
        norm(add(_along_meridian(p), scale(-(_meridian_radius(p) + p.altitude), north(p, p.t)))) < MP.mpf("1e-45")
        for p in points()
    )


def _distance_of_suspension(p: Point) -> Any:
    x, y, _ = suspension(p, MP.one)
    return sqrt(x * x + y * y)


def _east_from_latitude() -> Finding:
    p = points()[0]
    return Finding(
        norm(cross(unit(_along_meridian(p)), east(p, p.t))) < MP.mpf("1e-45"),
        f"cosine of the angle between dX_s/dϕ and e_E: {shown(dot(unit(_along_meridian(p)), east(p, p.t)))}",
    )


def _east_from_longitude() -> bool:
    def gap(p: Point) -> Any:
        along = vector_derivative(lambda turn: suspension(p, turn), p.rate * p.t)
        return norm(cross(along, east(p, p.t)))

    return all(gap(p) < MP.mpf("1e-45") for p in points())


def checks() -> list[Check]:
    """Return the rows of section II up to (6)."""

    def site(i: int) -> Any:
        return lambda p: turned_to_site(p, AXES[i], p.rate * p.t)

    return [
        Identity(
            "mathar_1",
            f"{II} (1)",
            "X_s = ((N+h) cosϕ cosΩt, (N+h) cosϕ sinΩt, [N(1-e²)+h] sinϕ)",
            lambda p: printed_suspension(p, p.t),
            lambda p: suspension(p, p.rate * p.t),
            remark="truth: h along the normal of the ellipsoid",
        ),
        Identity(
            "mathar_2",
            f"{II} (2)",
            "N = ρ_e / sqrt(1 - e² sin²ϕ)",
            lambda p: p.radius / sqrt(1 - p.e2 * sin(p.phi) ** 2),
            lambda p: _distance_of_suspension(p.but(altitude=MP.zero)) / cos(p.phi),
            remark="truth: length of the normal from the ellipsoid to the axis",
        ),
        Identity(
            "mathar_3",
            f"{II} (3)",
            "R = (N+h) cosϕ",
            lambda p: (p.N + p.altitude) * cos(p.phi),
            lambda p: axis_distance(p.radius, p.flattening, p.altitude, sin(p.phi), cos(p.phi), MP.sqrt),
            remark="truth: reference.model.earth",
        ),
        Statement(
            "mathar_4_text",
            f"{II}, before (4)",
            "east: differentiate (1) with respect to the geodetic latitude Ωt",
            _east_from_latitude,
            "Ωt is the longitude: e_E is the direction of dX_s/d(Ωt)",
            _east_from_longitude,
        ),
        Identity("mathar_4", f"{II} (4)", "e_E = (-sinΩt, cosΩt, 0), e_E² = 1", lambda p: east(p, p.t), site(0)),
        Identity("mathar_5", f"{II} (5)", "e_U = (cosϕ cosΩt, cosϕ sinΩt, sinϕ)", lambda p: up(p, p.t), site(2)),
        Identity(
            "mathar_5_h",
            f"{II}, before (5)",
            "e_U by differentiating (1) with respect to h",
            lambda p: up(p, p.t),
            lambda p: vector_derivative(lambda h: suspension(p, p.rate * p.t, h), p.altitude),
        ),
        Identity("mathar_6", f"{II} (6)", "e_N = e_U × e_E", lambda p: cross(up(p, p.t), east(p, p.t)), site(1)),
        Identity(
            "mathar_6_b",
            f"{II} (6)",
            "e_N = (-sinϕ cosΩt, -sinϕ sinΩt, cosϕ)",
            lambda p: north(p, p.t),
            lambda p: unit(cross(up(p, p.t), east(p, p.t))),
        ),
        Statement(
            "mathar_6_text",
            f"{II}, remark after (6)",
            "e_N is not exactly the normalized derivative of (1) with respect to ϕ",
            _not_the_north_direction,
            "it is exactly: dX_s/dϕ = (M+h) e_N, M = a(1-e²)/(1-e² sin²ϕ)^(3/2)",
            _is_the_north_direction,
        ),
    ]
