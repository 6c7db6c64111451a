"""Mathar, section II: the bob and its velocity, (7)-(19)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..checks import Check, Identity
from ..digits import MP, Vector, add, cos, dot, scale, sin, vector_derivative
from ..first_principles import by_angles, in_rate, place, square_speed, suspension, turned_to_site
from ..points import Point
from .axes import AXES, II, east, north, printed_suspension, up


def printed_position(p: Point, cord: Any, azimuth: Any) -> Vector:
    """Return x, y, z by (7)."""
    return (
        p.length * sin(cord) * cos(azimuth),
        p.length * sin(cord) * sin(azimuth),
        -p.length * cos(cord),
    )


def printed_velocity(p: Point) -> Vector:
    """Return the velocity by (10)."""
    sp, cp, sl, cl = sin(p.cord), cos(p.cord), sin(p.azimuth), cos(p.azimuth)
    return (
        p.length * (p.cord_rate * cl * cp - p.azimuth_rate * sp * sl),
        p.length * (p.cord_rate * sl * cp + p.azimuth_rate * sp * cl),
        p.length * p.cord_rate * sp,
    )


def moving(p: Point, s: Any) -> Vector:
    """Return the bob in local axes, its angles changing at their rates."""
    return by_angles(p, p.cord + p.cord_rate * s, p.azimuth + p.azimuth_rate * s)


def _in_matrix(p: Point) -> Vector:
    st, ct, s, c = sin(p.rate * p.t), cos(p.rate * p.t), sin(p.phi), cos(p.phi)
    x, y, z = p.position
    turned = (-st * x - s * ct * y + c * ct * z, ct * x - s * st * y + c * st * z, c * y + s * z)
    return add(printed_suspension(p, p.t), turned)


def _in_vectors(p: Point) -> Vector:
    return add(printed_suspension(p, p.t), scale(p.x, east(p, p.t)), scale(p.y, north(p, p.t)), scale(p.z, up(p, p.t)))


def _by_chain_rule(p: Point) -> Vector:
    terms = [vector_derivative(lambda t: printed_suspension(p, t), p.t)]
    for axis, length, speed in zip((east, north, up), p.position, p.velocity, strict=True):
        terms += [scale(length, _rates_of(axis)(p)), scale(speed, axis(p, p.t))]
    return add(*terms)


def _velocity_of_place(p: Point) -> Vector:
    return vector_derivative(lambda s: place(p, add(p.position, scale(s, p.velocity)), p.t + s))


def _angles_alpha(power: int) -> Any:
    def truth(p: Point) -> Any:
        q, v = (p.cord, p.azimuth), (p.cord_rate, p.azimuth_rate)
        return in_rate(lambda rate: square_speed(p, by_angles, q, v, rate), power)

    return truth


def alpha_0(p: Point) -> Any:
    """Return α0 by (17)."""
    return p.length**2 * (p.cord_rate**2 + sin(p.cord) ** 2 * p.azimuth_rate**2)


def alpha_1(p: Point) -> Any:
    """Return α1 by (18)."""
    sp, cp, sl, cl, s, c = sin(p.cord), cos(p.cord), sin(p.azimuth), cos(p.azimuth), sin(p.phi), cos(p.phi)
    first = 2 * (p.N + p.altitude) * c * p.length * (p.cord_rate * cp * cl - p.azimuth_rate * sp * sl)
    return first + 2 * p.length**2 * (sp * p.azimuth_rate * (s * sp + c * cp * sl) - c * p.cord_rate * cl)


def alpha_2(p: Point) -> Any:
    """Return α2 by (19)."""
    sp, cp, sl, cl, s, c = sin(p.cord), cos(p.cord), sin(p.azimuth), cos(p.azimuth), sin(p.phi), cos(p.phi)
    arm = (p.N + p.altitude) * c - p.length * (c * cp + s * sp * sl)
    return arm**2 + p.length**2 * sp**2 * cl**2


def _rates_of(axis: Callable[[Point, Any], Vector]) -> Callable[[Point], Vector]:
    return lambda p: vector_derivative(lambda t: axis(p, t), p.t)


def checks() -> list[Check]:
    """Return the rows of section II from (7) on."""
    return [
        Identity(
            "mathar_7",
            f"{II} (7)",
            "x = l (sinφ cosλ, sinφ sinλ, -cosφ)",
            lambda p: printed_position(p, p.cord, p.azimuth),
            lambda p: by_angles(p, p.cord, p.azimuth),
            remark="truth: straight down, turned by φ towards λ",
        ),
        Identity(
            "mathar_8", f"{II} (8)", "X = X_s + e_E x + e_N y + e_U z", _in_vectors, lambda p: place(p, p.position, p.t)
        ),
        Identity(
            "mathar_9",
            f"{II} (9)",
            "X = X_s + matrix with the columns e_E, e_N, e_U · x",
            _in_matrix,
            lambda p: place(p, p.position, p.t),
        ),
        Identity(
            "mathar_10",
            f"{II} (10)",
            "xdot = l (φ' cosλ cosφ - λ' sinφ sinλ; φ' sinλ cosφ + λ' sinφ cosλ; φ' sinφ)",
            printed_velocity,
            lambda p: vector_derivative(lambda s: moving(p, s)),
        ),
        Identity(
            "mathar_11",
            f"{II} (11)",
            "xdot² = l² (λ'² sin²φ + φ'²)",
            lambda p: p.length**2 * (p.azimuth_rate**2 * sin(p.cord) ** 2 + p.cord_rate**2),
            lambda p: dot(vector_derivative(lambda s: moving(p, s)), vector_derivative(lambda s: moving(p, s))),
        ),
        Identity(
            "mathar_12",
            f"{II} (12)",
            "x · xdot = 0",
            lambda p: MP.zero,
            lambda p: dot(moving(p, 0), vector_derivative(lambda s: moving(p, s))),
        ),
        Identity(
            "mathar_13",
            f"{II} (13)",
            "Xdot_s = (N+h) Ω (-cosϕ sinΩt, cosϕ cosΩt, 0)",
            lambda p: scale(
                (p.N + p.altitude) * p.rate,
                (-cos(p.phi) * sin(p.rate * p.t), cos(p.phi) * cos(p.rate * p.t), MP.zero),
            ),
            lambda p: vector_derivative(lambda t: suspension(p, p.rate * t), p.t),
        ),
        Identity(
            "mathar_14",
            f"{II} (14)",
            "Xdot = Xdot_s + e_E' x + e_E x' + e_N' y + e_N y' + e_U' z + e_U z'",
            _by_chain_rule,
            _velocity_of_place,
        ),
        Identity(
            "mathar_15_e",
            f"{II} (15)",
            "e_E' = Ω (-cosΩt, -sinΩt, 0)",
            lambda p: scale(p.rate, (-cos(p.rate * p.t), -sin(p.rate * p.t), MP.zero)),
            _rates_of(lambda p, t: turned_to_site(p, AXES[0], p.rate * t)),
        ),
        Identity(
            "mathar_15_n",
            f"{II} (15)",
            "e_N' = Ω (sinϕ sinΩt, -sinϕ cosΩt, 0)",
            lambda p: scale(p.rate * sin(p.phi), (sin(p.rate * p.t), -cos(p.rate * p.t), MP.zero)),
            _rates_of(lambda p, t: turned_to_site(p, AXES[1], p.rate * t)),
        ),
        Identity(
            "mathar_15_u",
            f"{II} (15)",
            "e_U' = Ω (-cosϕ sinΩt, cosϕ cosΩt, 0)",
            lambda p: scale(p.rate * cos(p.phi), (-sin(p.rate * p.t), cos(p.rate * p.t), MP.zero)),
            _rates_of(lambda p, t: turned_to_site(p, AXES[2], p.rate * t)),
        ),
        Identity(
            "mathar_16",
            f"{II} (16)",
            "Xdot² + Ydot² + Zdot² = α0 + α1 Ω + α2 Ω²",
            lambda p: alpha_0(p) + alpha_1(p) * p.rate + alpha_2(p) * p.rate**2,
            lambda p: square_speed(p, by_angles, (p.cord, p.azimuth), (p.cord_rate, p.azimuth_rate)),
        ),
        Identity("mathar_17", f"{II} (17)", "α0 = l² (φ'² + sin²φ λ'²)", alpha_0, _angles_alpha(0)),
        Identity(
            "mathar_18",
            f"{II} (18)",
            "α1 = 2(N+h) cosϕ l (φ' cosφ cosλ - λ' sinφ sinλ) + 2l² […]",
            alpha_1,
            _angles_alpha(1),
        ),
        Identity(
            "mathar_19",
            f"{II} (19)",
            "α2 = [(N+h) cosϕ - l (cosϕ cosφ + sinϕ sinφ sinλ)]² + l² sin²φ cos²λ",
            alpha_2,
            _angles_alpha(2),
        ),
    ]
