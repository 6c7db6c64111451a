"""Mathar, section III: the Lagrangian, its equations in angles (20)-(27), and α in x and y (28)-(30)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..checks import Check, Finding, Identity, Statement, section
from ..digits import MP, Vector, cos, derivative, shown, sin, sqrt
from ..first_principles import (
    angle_state,
    by_angles,
    by_plane,
    euler_lagrange,
    horizontal_acceleration,
    in_rate,
    lagrangian,
    square_speed,
)
from ..points import Point, points
from ..runs import paris_passage
from .kinematics import alpha_0, alpha_1, alpha_2


def _symbols(p: Point) -> tuple[Any, ...]:
    return sin(p.phi), cos(p.phi), sin(p.cord), cos(p.cord), sin(p.azimuth), cos(p.azimuth), p.R / p.length


def _slope_in_azimuth(p: Point) -> Any:
    """Return ∂L/∂λ by (22), for m = 1."""
    s, c, sp, cp, sl, cl, _ = _symbols(p)
    length, arm = p.length, p.R - p.length * (c * cp + s * sp * sl)
    once = 2 * p.R * length * (-p.cord_rate * cp * sl - p.azimuth_rate * sp * cl)
    once += 2 * length**2 * (sp * p.azimuth_rate * c * cp * cl + c * p.cord_rate * sl)
    twice = -2 * length * arm * s * sp * cl - 2 * length**2 * sp**2 * cl * sl
    return (once * p.rate + twice * p.rate**2) / 2


def cord_equation(p: Point) -> Any:
    """Return the left side of (24)."""
    s, c, sp, cp, sl, _, far = _symbols(p)
    turn, along = p.rate, c * sp * sl - s * cp
    return (
        p.cord_second
        + far * turn**2 * (s * cp * sl - c * sp)
        + 2 * turn * sp * along * p.azimuth_rate
        + turn**2 * (s * sp + c * cp * sl) * along
        - cp * sp * p.azimuth_rate**2
        + p.gravity / p.length * sp
    )


def azimuth_equation(p: Point) -> Any:
    """Return the left side of (26)."""
    s, c, sp, cp, sl, cl, far = _symbols(p)
    first = sp * p.azimuth_second + 2 * cp * p.cord_rate * p.azimuth_rate
    second = far * p.rate**2 * s * cl
    return first + second + p.rate * (c * sp * sl - s * cp) * (p.rate * c * cl - 2 * p.cord_rate)


def plane_alpha_0(p: Point) -> Any:
    """Return α0 in x and y by (28)."""
    x, y, vx, vy, square = p.x, p.y, p.vx, p.vy, p.length**2
    return (2 * x * y * vx * vy + (square - y**2) * vx**2 + (square - x**2) * vy**2) / (square - x**2 - y**2)


def plane_alpha_1(p: Point) -> Any:
    """Return α1 in x and y by (29)."""
    x, y, vx, vy, l2, s, c, far = p.x, p.y, p.vx, p.vy, p.length**2, sin(p.phi), cos(p.phi), p.N + p.altitude
    below = l2 - x**2 - y**2
    top = -2 * vx * s * y * l2 - 2 * vx * c * below ** MP.mpf("1.5") + 2 * vx * s * y**3 - 2 * vy * s * x**3
    top += 2 * vx * s * y * x**2 - 2 * vx * c * x**2 * sqrt(below) - 2 * vy * c * x * y * sqrt(below)
    top += 2 * l2 * far * c * vx - 2 * far * c * x**2 * vx - 2 * far * c * y**2 * vx
    top += 2 * l2 * s * x * vy - 2 * s * x * y**2 * vy
    return top / below


def plane_alpha_2(p: Point) -> Any:
    """Return α2 in x and y by (30)."""
    x, y, l2, s, c, far = p.x, p.y, p.length**2, sin(p.phi), cos(p.phi), p.N + p.altitude
    below = l2 - x**2 - y**2
    half = below ** MP.mpf("1.5")
    top = -2 * x**2 * y**2 + y**2 * l2 + 2 * c**2 * y**4 + c**2 * x**4 + x**2 * l2 + c**2 * l2**2 - x**4 - y**4
    top += far**2 * c**2 * l2 - 3 * y**2 * l2 * c**2 - 2 * far * c**2 * half - 2 * c**2 * l2 * x**2
    top += 3 * c**2 * x**2 * y**2 + 2 * s * c * y * half - far**2 * c**2 * x**2 - far**2 * c**2 * y**2
    top += -2 * far * s * c * y * l2 + 2 * s * c * far * y * x**2 + 2 * s * c * far * y**3
    return top / below


def _plane_alpha(power: int) -> Any:
    return lambda p: in_rate(lambda rate: square_speed(p, by_plane, (p.x, p.y), (p.vx, p.vy), rate), power)


def _energy_in_the_inertial_frame_changes() -> Finding:
    p = points()[0]
    acceleration = horizontal_acceleration(p)

    def energy(s: Any) -> Any:
        q = tuple(r + v * s + a * s * s / 2 for r, v, a in zip((p.x, p.y), (p.vx, p.vy), acceleration, strict=True))
        v = tuple(v + a * s for v, a in zip((p.vx, p.vy), acceleration, strict=True))
        return square_speed(p, by_plane, q, v) / 2 + p.gravity * by_plane(p, *q)[2]

    change = derivative(energy)
    return Finding(abs(change) > MP.mpf("1e-3"), f"dE/dt = {shown(change)} at a random point, along the motion")


def _no_time_in_the_lagrangian() -> Finding:
    p = points()[0]
    q, v, _ = angle_state(p)
    early, late = (lagrangian(p, by_angles, q, v, t=t) for t in (MP.zero, p.t))
    return Finding(abs(early - late) < MP.mpf("1e-45"), f"L(t = 0) - L(t) = {shown(early - late)}")


def _spherical(p: Point) -> Vector:
    """Return the equations of the spherical pendulum, from the Lagrangian without rotation."""
    q, v, a = angle_state(p)
    first, second = (euler_lagrange(p, by_angles, q, v, a, i, MP.zero) / p.length**2 for i in (0, 1))
    return first, second / sin(p.cord)


def _equation(i: int) -> Any:
    return lambda p: euler_lagrange(p, by_angles, *angle_state(p), i) / p.length**2


def _azimuth_is_fast() -> Finding:
    """Compare λ' at the passage next to the vertical with the angular frequency of the swing."""
    near, miss = paris_passage()
    fast, slow = float((np.hypot(near[:, 3], near[:, 4]) / miss).max()), np.sqrt(9.80665 / 67)
    return Finding(fast > 100 * slow, f"λ' up to {fast:.12f} rad/s in Paris, sqrt(g/l) = {slow:.12f} rad/s")


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    return section("mathar_", "Mathar III",
        Identity("20", "(20)", "K = m (α0 + α1 Ω + α2 Ω²) / 2",
            lambda p: p.mass / 2 * (alpha_0(p) + alpha_1(p) * p.rate + alpha_2(p) * p.rate**2),
            lambda p: p.mass * square_speed(p, by_angles, (p.cord, p.azimuth), (p.cord_rate, p.azimuth_rate)) / 2),
        Identity("21", "(21)", "V = m g z = -m g l cosφ", lambda p: -p.mass * p.gravity * p.length * cos(p.cord),
            lambda p: p.mass * p.gravity * by_angles(p, p.cord, p.azimuth)[2]),
        Identity("21_text", ", after (21)", "Ω → 0: the two equations are those of the spherical pendulum",
            lambda p: (cord_equation(p.but(rate=MP.zero)), azimuth_equation(p.but(rate=MP.zero))), _spherical),
        Identity("22", "(22)", "∂L/∂λ = (m/2) ([…] Ω + […] Ω²)", _slope_in_azimuth,
            lambda p: derivative(lambda s: lagrangian(p, by_angles, (p.cord, p.azimuth + s), (p.cord_rate,
                p.azimuth_rate)))),
        Identity("24", "(23), (24)", "φ'' + R̂Ω² (sinϕ cosφ sinλ - cosϕ sinφ) + … + (g/l) sinφ = 0",
            cord_equation, _equation(0)),
        Identity("26", "(25), (26)", "sinφ λ'' + 2 cosφ φ' λ' + R̂Ω² sinϕ cosλ + … = 0",
            azimuth_equation, lambda p: _equation(1)(p) / sin(p.cord)),
        Identity("27", "(27)", "R̂ = (N+h) cosϕ / l",
            lambda p: (p.N + p.altitude) * cos(p.phi) / p.length, lambda p: p.k.axis_distance,
            remark="truth: reference.model.constants"),
        Statement("27_l", ", after (27)", "the Lagrangian does not explicitly depend on time",
            _no_time_in_the_lagrangian),
        Statement("27_e", ", after (27)", "E = K + V in the inertial frame is not conserved",
            _energy_in_the_inertial_frame_changes,
            remark="conserved is v²/2 + g z - Ω²/2 (x² + q²), q the distance from the axis"),
        Identity("28", "(28)", "α0 = [2xyx'y' + (l²-y²)x'² + (l²-x²)y'²] / (l²-x²-y²)", plane_alpha_0, _plane_alpha(0)),
        Identity("29", "(29)", "α1 = [12 terms] / (l²-x²-y²)", plane_alpha_1, _plane_alpha(1)),
        Identity("30", "(30)", "α2 = [19 terms] / (l²-x²-y²)", plane_alpha_2, _plane_alpha(2)),
        Statement("30_fast", ", after (30)",
            "the sine in (26) induces quick changes of λ if the pendulum approaches small φ",
            _azimuth_is_fast, by_run=True),
    )  # fmt: skip
