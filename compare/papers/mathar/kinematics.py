"""Mathar, section II: the suspension and the axes at the site, the bob and its velocity, (1)-(19)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from reference.model.constants import axis_distance

from ..checks import Answer, Check, Identity, Statement, component, section
from ..digits import (
    MP,
    Vector,
    cos,
    cross,
    degrees,
    derivative,
    dot,
    norm,
    shown,
    sin,
    sqrt,
    unit,
    vanishes,
    vector,
)
from ..first_principles import (
    angle_state,
    by_angles,
    in_rate,
    moving_velocity,
    place,
    square_speed,
    suspension,
    turned_to_site,
)
from ..points import Point, points

AXES = MP.one * np.eye(3, dtype=int)  # east, north, up


def printed_suspension(p: Point) -> Vector:
    """Return the place of the suspension by (1)."""
    turn, flat = p.rate * p.t, (p.N + p.altitude) * cos(p.phi)
    return vector(flat * cos(turn), flat * sin(turn), (p.N * (1 - p.e2) + p.altitude) * sin(p.phi))


def east(p: Point) -> Vector:
    """Return the unit vector e_E by (4)."""
    return vector(-sin(p.rate * p.t), cos(p.rate * p.t), 0)


def up(p: Point) -> Vector:
    """Return the unit vector e_U by (5)."""
    return vector(cos(p.phi) * cos(p.rate * p.t), cos(p.phi) * sin(p.rate * p.t), sin(p.phi))


def north(p: Point) -> Vector:
    """Return the unit vector e_N by (6)."""
    return vector(-sin(p.phi) * cos(p.rate * p.t), -sin(p.phi) * sin(p.rate * p.t), cos(p.phi))


def _along_meridian(p: Point) -> Vector:
    """Return dX_s/dϕ from the ellipsoid's geometry."""
    return derivative(lambda phi: suspension(p.but(latitude=degrees(phi)), p.rate * p.t), p.phi)


def _meridian_radius(p: Point) -> Any:
    return p.radius * (1 - p.e2) / (1 - p.e2 * sin(p.phi) ** 2) ** MP.mpf("1.5")


def _not_the_north_direction() -> Answer:
    p = points()[0]
    between = cross(unit(_along_meridian(p)), north(p))
    return Answer(not vanishes(between), f"sine of the angle between them: {shown(norm(between))}")


def _is_the_north_direction() -> bool:
    return all(
        vanishes(_along_meridian(p) - (_meridian_radius(p) + p.altitude) * north(p))
        for p in points()
    )


def _east_from_latitude() -> Answer:
    p = points()[0]
    along, e_east = unit(_along_meridian(p)), east(p)
    cosine = shown(dot(along, e_east))
    return Answer(
        vanishes(cross(along, e_east)), f"cosine of the angle between dX_s/dϕ and e_E: {cosine}"
    )


def _east_from_longitude() -> bool:
    return all(
        vanishes(cross(derivative(partial(suspension, p), p.rate * p.t), east(p))) for p in points()
    )


def _site_axis(i: int) -> Callable[[Point], Vector]:
    """Return the i-th of east, north, up, from the rotations."""
    return lambda p: turned_to_site(p, AXES[i], p.rate * p.t)


def _rates_of(vector_at: Callable[[Point], Vector]) -> Callable[[Point], Vector]:
    """Return the derivative of a vector with respect to time."""
    return lambda p: derivative(lambda t: vector_at(p.but(t=t)), p.t)


def printed_velocity(p: Point) -> Vector:
    """Return the velocity by (10)."""
    sp, cp, sl, cl = p.angle_functions
    return vector(
        p.length * (p.cord_rate * cl * cp - p.azimuth_rate * sp * sl),
        p.length * (p.cord_rate * sl * cp + p.azimuth_rate * sp * cl),
        p.length * p.cord_rate * sp,
    )


def _up_cross_east(p: Point) -> Vector:
    return cross(up(p), east(p))


def _in_matrix(p: Point) -> Vector:
    st, ct, s, c = sin(p.rate * p.t), cos(p.rate * p.t), sin(p.phi), cos(p.phi)
    x, y, z = p.position
    turned = vector(
        -st * x - s * ct * y + c * ct * z, ct * x - s * st * y + c * st * z, c * y + s * z
    )
    return printed_suspension(p) + turned


def _by_chain_rule(p: Point) -> Vector:
    terms = [_rates_of(printed_suspension)(p)]
    for axis, length, speed in zip((east, north, up), p.position, p.velocity, strict=True):
        terms += [length * _rates_of(axis)(p), speed * axis(p)]
    return sum(terms)


def _alpha(power: int) -> Callable[[Point], Any]:
    """Return the coefficient of Ω**power in the squared velocity."""
    return lambda p: in_rate(
        lambda rate: square_speed(p.but(rate=rate), by_angles, *angle_state(p)[:2]), power
    )


def alphas(p: Point) -> Vector:
    """Return α0, α1, α2 by (17)-(19)."""
    (sp, cp, sl, cl), s, c = p.angle_functions, sin(p.phi), cos(p.phi)
    far = (p.N + p.altitude) * c
    first = 2 * far * p.length * (p.cord_rate * cp * cl - p.azimuth_rate * sp * sl)
    arm = far - p.length * (c * cp + s * sp * sl)
    return vector(
        p.length**2 * (p.cord_rate**2 + sp**2 * p.azimuth_rate**2),
        first
        + 2 * p.length**2 * (sp * p.azimuth_rate * (s * sp + c * cp * sl) - c * p.cord_rate * cl),
        arm**2 + p.length**2 * sp**2 * cl**2,
    )


def in_powers(p: Point, factors: Vector) -> Any:
    """Return the sum of factors, each times its power of Ω."""
    return sum(part * p.rate**i for i, part in enumerate(factors))


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    return section("mathar_", "Mathar II",
        Identity("1", "(1)", "X_s = ((N+h) cosϕ cosΩt, (N+h) cosϕ sinΩt, [N(1-e²)+h] sinϕ)",
            printed_suspension, lambda p: suspension(p, p.rate * p.t),
            remark="truth: h along the normal of the ellipsoid"),
        Identity("2", "(2)", "N = ρ_e / sqrt(1 - e² sin²ϕ)", lambda p: p.radius / sqrt(1 - p.e2 * sin(p.phi) ** 2),
            lambda p: norm(suspension(p.but(altitude=MP.zero), MP.one)[:2]) / cos(p.phi),
            remark="truth: length of the normal from the ellipsoid to the axis"),
        Identity("3", "(3)", "R = (N+h) cosϕ", lambda p: (p.N + p.altitude) * cos(p.phi),
            lambda p: axis_distance(p.radius, p.flattening, p.altitude, sin(p.phi), cos(p.phi), MP.sqrt),
            remark="truth: reference.model.earth"),
        Statement("4_text", ", before (4)", "east: differentiate (1) with respect to the geodetic latitude Ωt",
            _east_from_latitude, "Ωt is the longitude: e_E is the direction of dX_s/d(Ωt)", _east_from_longitude),
        Identity("4", "(4)", "e_E = (-sinΩt, cosΩt, 0), e_E² = 1", east, _site_axis(0)),
        Identity("5", "(5)", "e_U = (cosϕ cosΩt, cosϕ sinΩt, sinϕ)", up, _site_axis(2)),
        Identity("5_h", ", before (5)", "e_U by differentiating (1) with respect to h", up,
            lambda p: derivative(lambda h: suspension(p.but(altitude=h), p.rate * p.t), p.altitude)),
        Identity("6", "(6)", "e_N = e_U × e_E", _up_cross_east, _site_axis(1)),
        Identity("6_b", "(6)", "e_N = (-sinϕ cosΩt, -sinϕ sinΩt, cosϕ)",
            north, lambda p: unit(_up_cross_east(p))),
        Statement("6_text", ", remark after (6)",
            "e_N is not exactly the normalized derivative of (1) with respect to ϕ",
            _not_the_north_direction, "it is exactly: dX_s/dϕ = (M+h) e_N, M = a(1-e²)/(1-e² sin²ϕ)^(3/2)",
            _is_the_north_direction),
        Identity("7", "(7)", "x = l (sinφ cosλ, sinφ sinλ, -cosφ)",
            lambda p: p.length * vector(sin(p.cord) * cos(p.azimuth), sin(p.cord) * sin(p.azimuth), -cos(p.cord)),
            lambda p: by_angles(p, p.cord, p.azimuth),
            remark="truth: straight down, turned by φ towards λ"),
        Identity("8", "(8)", "X = X_s + e_E x + e_N y + e_U z",
            lambda p: printed_suspension(p) + p.x * east(p) + p.y * north(p) + p.z * up(p),
            lambda p: place(p, p.position, p.t)),
        Identity("9", "(9)", "X = X_s + matrix with the columns e_E, e_N, e_U · x",
            _in_matrix, lambda p: place(p, p.position, p.t)),
        Identity("10", "(10)", "xdot = l (φ' cosλ cosφ - λ' sinφ sinλ; φ' sinλ cosφ + λ' sinφ cosλ; φ' sinφ)",
            printed_velocity, moving_velocity),
        Identity("11", "(11)", "xdot² = l² (λ'² sin²φ + φ'²)",
            lambda p: p.length**2 * (p.azimuth_rate**2 * sin(p.cord) ** 2 + p.cord_rate**2),
            lambda p: dot(moving_velocity(p), moving_velocity(p))),
        Identity("12", "(12)", "x · xdot = 0",
            lambda p: 0, lambda p: dot(by_angles(p, p.cord, p.azimuth), moving_velocity(p))),
        Identity("13", "(13)", "Xdot_s = (N+h) Ω (-cosϕ sinΩt, cosϕ cosΩt, 0)",
            lambda p: (p.N + p.altitude) * p.rate * cos(p.phi) * vector(-sin(p.rate * p.t), cos(p.rate * p.t), 0),
            _rates_of(lambda p: suspension(p, p.rate * p.t))),
        Identity("14", "(14)", "Xdot = Xdot_s + e_E' x + e_E x' + e_N' y + e_N y' + e_U' z + e_U z'",
            _by_chain_rule, lambda p: derivative(lambda s: place(p, p.position + s * p.velocity, p.t + s))),
        Identity("15_e", "(15)", "e_E' = Ω (-cosΩt, -sinΩt, 0)",
            lambda p: p.rate * vector(-cos(p.rate * p.t), -sin(p.rate * p.t), 0),
            _rates_of(_site_axis(0))),
        Identity("15_n", "(15)", "e_N' = Ω (sinϕ sinΩt, -sinϕ cosΩt, 0)",
            lambda p: p.rate * sin(p.phi) * vector(sin(p.rate * p.t), -cos(p.rate * p.t), 0),
            _rates_of(_site_axis(1))),
        Identity("15_u", "(15)", "e_U' = Ω (-cosϕ sinΩt, cosϕ cosΩt, 0)",
            lambda p: p.rate * cos(p.phi) * vector(-sin(p.rate * p.t), cos(p.rate * p.t), 0),
            _rates_of(_site_axis(2))),
        Identity("16", "(16)", "Xdot² + Ydot² + Zdot² = α0 + α1 Ω + α2 Ω²",
            lambda p: in_powers(p, alphas(p)), lambda p: square_speed(p, by_angles, *angle_state(p)[:2])),
        Identity("17", "(17)", "α0 = l² (φ'² + sin²φ λ'²)", component(alphas, 0), _alpha(0)),
        Identity("18", "(18)", "α1 = 2(N+h) cosϕ l (φ' cosφ cosλ - λ' sinφ sinλ) + 2l² […]",
            component(alphas, 1), _alpha(1)),
        Identity("19", "(19)", "α2 = [(N+h) cosϕ - l (cosϕ cosφ + sinϕ sinφ sinλ)]² + l² sin²φ cos²λ",
            component(alphas, 2), _alpha(2)),
    )  # fmt: skip
