"""Mathar, sections III and IV: the Lagrangian, its equations in angles (20)-(27), and in x and y (28)-(43)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..checks import Answer, Check, Identity, Statement, component, section
from ..digits import MP, Vector, cos, derivative, shown, sin, sqrt, vanishes, vector
from ..first_principles import (
    angle_state,
    by_angles,
    by_plane,
    euler_lagrange,
    horizontal_acceleration,
    in_rate,
    lagrangian,
    plane_state,
    square_speed,
)
from ..points import Point, paris_passage, points
from .kinematics import alphas, in_powers


def _symbols(p: Point) -> tuple[Any, ...]:
    """Return sine and cosine of ϕ, of φ and of λ, and R̂."""
    return sin(p.phi), cos(p.phi), *p.angle_functions, p.R / p.length


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


def plane_alphas(p: Point) -> Vector:
    """Return α0, α1, α2 in x and y by (28)-(30)."""
    x, y, vx, vy, l2, s, c, far = (
        p.x,
        p.y,
        p.vx,
        p.vy,
        p.length**2,
        sin(p.phi),
        cos(p.phi),
        p.N + p.altitude,
    )
    below = l2 - x**2 - y**2
    half = below ** MP.mpf("1.5")
    alpha0 = 2 * x * y * vx * vy + (l2 - y**2) * vx**2 + (l2 - x**2) * vy**2
    alpha1 = -2 * vx * s * y * l2 - 2 * vx * c * half + 2 * vx * s * y**3 - 2 * vy * s * x**3
    alpha1 += (
        2 * vx * s * y * x**2 - 2 * vx * c * x**2 * sqrt(below) - 2 * vy * c * x * y * sqrt(below)
    )
    alpha1 += 2 * l2 * far * c * vx - 2 * far * c * x**2 * vx - 2 * far * c * y**2 * vx
    alpha1 += 2 * l2 * s * x * vy - 2 * s * x * y**2 * vy
    alpha2 = (
        -2 * x**2 * y**2
        + y**2 * l2
        + 2 * c**2 * y**4
        + c**2 * x**4
        + x**2 * l2
        + c**2 * l2**2
        - x**4
        - y**4
    )
    alpha2 += (
        far**2 * c**2 * l2 - 3 * y**2 * l2 * c**2 - 2 * far * c**2 * half - 2 * c**2 * l2 * x**2
    )
    alpha2 += (
        3 * c**2 * x**2 * y**2 + 2 * s * c * y * half - far**2 * c**2 * x**2 - far**2 * c**2 * y**2
    )
    alpha2 += -2 * far * s * c * y * l2 + 2 * s * c * far * y * x**2 + 2 * s * c * far * y**3
    return vector(alpha0, alpha1, alpha2) / below


def _plane_alpha(power: int) -> Any:
    return lambda p: in_rate(
        lambda rate: square_speed(p.but(rate=rate), by_plane, *plane_state(p)[:2]), power
    )


def _energy_in_the_inertial_frame_changes() -> Answer:
    p = points()[0]
    (place, speed, _), second = plane_state(p), horizontal_acceleration(p)

    def energy(s: Any) -> Any:
        q = place + s * speed + s * s / 2 * second
        return square_speed(p, by_plane, q, speed + s * second) / 2 + p.gravity * by_plane(p, *q)[2]

    change = derivative(energy)
    return Answer(
        abs(change) > MP.mpf("1e-3"), f"dE/dt = {shown(change)} at a random point, along the motion"
    )


def _no_time_in_the_lagrangian() -> Answer:
    p = points()[0]
    q, v, _ = angle_state(p)
    early, late = (lagrangian(p, by_angles, q, v, t=t) for t in (MP.zero, p.t))
    return Answer(vanishes(early - late), f"L(t = 0) - L(t) = {shown(early - late)}")


def _angle_equations(p: Point) -> Vector:
    """Return what (24) and (26) say is zero, from the Lagrangian."""
    first, second = (euler_lagrange(p, by_angles, *angle_state(p), i) / p.length**2 for i in (0, 1))
    return vector(first, second / sin(p.cord))


def _azimuth_is_fast() -> Answer:
    """Compare λ' at the passage next to the vertical with the angular frequency of the swing."""
    near, miss = paris_passage()
    fast, slow = float((np.hypot(near[:, 3], near[:, 4]) / miss).max()), np.sqrt(9.80665 / 67)
    return Answer(
        fast > 100 * slow, f"λ' up to {fast:.12f} rad/s in Paris, sqrt(g/l) = {slow:.12f} rad/s"
    )


def _shared(p: Point) -> Any:
    """Return the two factors that (33) and (39) share, beside x and y."""
    bent = p.length**2 * (p.vx**2 + p.vy**2) - (p.x * p.vy - p.y * p.vx) ** 2
    return bent, p.gravity * abs(p.z) ** 3


def beta_x(p: Point) -> Vector:
    """Return β_x0, β_x1, β_x2 by (33)-(35)."""
    s, c, deep = sin(p.phi), cos(p.phi), abs(p.z) ** 3
    bent, pull = _shared(p)
    return vector(
        p.x * bent + p.x * pull,
        -2 * p.z**4 * s * p.vy + 2 * p.y * p.vy * c * deep,
        -p.x * p.z**4 * s**2 + p.x * c * (p.y * s - p.R) * deep,
    )


def beta_y(p: Point) -> Vector:
    """Return β_y0, β_y1, β_y2 by (39)-(41)."""
    s, c, deep = sin(p.phi), cos(p.phi), abs(p.z) ** 3
    bent, pull = _shared(p)
    return vector(
        p.y * bent + p.y * pull,
        2 * p.z**4 * s * p.vx - 2 * p.y * p.vx * c * deep,
        p.z**4 * (-p.y + p.R * s + 2 * p.y * c**2) - deep * c * (p.R * p.y + (p.z**2 - p.y**2) * s),
    )


def matrix_times(p: Point, a: Vector) -> Vector:
    """Return the left side of (42)."""
    x, y, z = p.position
    return vector(
        z**2 * (x**2 + z**2) * a[0] + z**2 * y * x * a[1],
        z**2 * y * x * a[0] + z**2 * (y**2 + z**2) * a[1],
    )


def inverse_times(p: Point, b: Vector) -> Vector:
    """Return the right side of (43)."""
    x, y, z = p.position
    top = vector((y**2 + z**2) * b[0] - y * x * b[1], -y * x * b[0] + (x**2 + z**2) * b[1])
    return top / (z**4 * p.length**2)


def solved(p: Point) -> Vector:
    """Return x'', y'' by (43)."""
    return inverse_times(p, (-in_powers(p, beta_x(p)), -in_powers(p, beta_y(p))))


def _plane_equation(i: int, power: int = 4) -> Callable[[Point], Any]:
    """Return the Euler-Lagrange equation for x or y, times a power of z."""
    return lambda p: p.z**power * euler_lagrange(p, by_plane, *plane_state(p), i)


def _coefficient(i: int, power: int) -> Callable[[Point], Any]:
    """Return z⁴ times the terms of Euler-Lagrange without accelerations, at one power of Ω."""
    return lambda p: in_rate(
        lambda rate: _plane_equation(i)(p.but(rate=rate, ax=MP.zero, ay=MP.zero)), power
    )


def _printed_32(p: Point) -> Any:
    x, y, square = p.x, p.y, p.length**2
    first = square**2 + y**4 - 2 * y**2 * square + y**2 * x**2 - square * x**2
    return first * p.ax + (-(x**3) * y + x * y * square - x * y**3) * p.ay + in_powers(p, beta_x(p))


def _swapped(p: Point) -> Point:
    return p.but(x=p.y, y=p.x, vx=p.vy, vy=p.vx)


def _east_unbiased() -> Answer:
    p = points()[0].but(rate=MP.zero)
    gap = solved(p)[0] - solved(_swapped(p))[1]
    return Answer(vanishes(gap), f"x'' - (y'' with x and y exchanged) at Ω = 0: {shown(gap)}")


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    in_angles = section("mathar_", "Mathar III",
        Identity("20", "(20)", "K = m (α0 + α1 Ω + α2 Ω²) / 2",
            lambda p: p.mass / 2 * in_powers(p, alphas(p)),
            lambda p: p.mass * square_speed(p, by_angles, *angle_state(p)[:2]) / 2),
        Identity("21", "(21)", "V = m g z = -m g l cosφ", lambda p: -p.mass * p.gravity * p.length * cos(p.cord),
            lambda p: p.mass * p.gravity * by_angles(p, p.cord, p.azimuth)[2]),
        Identity("21_text", ", after (21)", "Ω → 0: the two equations are those of the spherical pendulum",
            lambda p: (cord_equation(p.but(rate=MP.zero)), azimuth_equation(p.but(rate=MP.zero))),
            lambda p: _angle_equations(p.but(rate=MP.zero))),
        Identity("22", "(22)", "∂L/∂λ = (m/2) ([…] Ω + […] Ω²)", _slope_in_azimuth,
            lambda p: derivative(lambda s: lagrangian(p, by_angles, (p.cord, p.azimuth + s), angle_state(p)[1]))),
        Identity("24", "(23), (24)", "φ'' + R̂Ω² (sinϕ cosφ sinλ - cosϕ sinφ) + … + (g/l) sinφ = 0",
            cord_equation, component(_angle_equations, 0)),
        Identity("26", "(25), (26)", "sinφ λ'' + 2 cosφ φ' λ' + R̂Ω² sinϕ cosλ + … = 0",
            azimuth_equation, component(_angle_equations, 1)),
        Identity("27", "(27)", "R̂ = (N+h) cosϕ / l",
            lambda p: (p.N + p.altitude) * cos(p.phi) / p.length, lambda p: p.k.axis_distance,
            remark="truth: reference.model.constants"),
        Statement("27_l", ", after (27)", "the Lagrangian does not explicitly depend on time",
            _no_time_in_the_lagrangian),
        Statement("27_e", ", after (27)", "E = K + V in the inertial frame is not conserved",
            _energy_in_the_inertial_frame_changes,
            remark="conserved is v²/2 + g z - Ω²/2 (x² + q²), q the distance from the axis"),
        Identity("28", "(28)", "α0 = [2xyx'y' + (l²-y²)x'² + (l²-x²)y'²] / (l²-x²-y²)",
            component(plane_alphas, 0), _plane_alpha(0)),
        Identity("29", "(29)", "α1 = [12 terms] / (l²-x²-y²)", component(plane_alphas, 1), _plane_alpha(1)),
        Identity("30", "(30)", "α2 = [19 terms] / (l²-x²-y²)", component(plane_alphas, 2), _plane_alpha(2)),
        Statement("30_fast", ", after (30)",
            "the sine in (26) induces quick changes of λ if the pendulum approaches small φ",
            _azimuth_is_fast, by_run=True),
    )  # fmt: skip
    in_plane = section("mathar_", "Mathar IV",
        Identity("32_text", ", before (32)", "multiply the result with z²",
            _plane_equation(0, 2), _printed_32, "multiply with z⁴; (32), (36), (38) are printed so",
            _plane_equation(0)),
        Identity("32", "(31), (32)", "(l⁴+y⁴-2y²l²+y²x²-l²x²) x'' + (-x³y+xyl²-xy³) y'' + Σβ_x Ω^i = 0",
            _printed_32, _plane_equation(0)),
        Identity("33", "(33)", "β_x0 = x [l² (x'² + y'²) - (xy' - yx')²] + x g |z|³",
            lambda p: beta_x(p)[0], _coefficient(0, 0)),
        Identity("34", "(34)", "β_x1 = -2z⁴ sinϕ y' + 2y y' cosϕ |z|³", lambda p: beta_x(p)[1], _coefficient(0, 1)),
        Identity("35", "(35)", "β_x2 = -x z⁴ sin²ϕ + x cosϕ (y sinϕ - R) |z|³",
            lambda p: beta_x(p)[2], _coefficient(0, 2)),
        Identity("36", "(36)", "z²(x²+z²) x'' + z²yx y'' + Σβ_x Ω^i = 0",
            lambda p: matrix_times(p, (p.ax, p.ay))[0] + in_powers(p, beta_x(p)), _plane_equation(0)),
        Identity("38", "(37), (38)", "z²yx x'' + z²(y²+z²) y'' + Σβ_y Ω^i = 0",
            lambda p: matrix_times(p, (p.ax, p.ay))[1] + in_powers(p, beta_y(p)), _plane_equation(1)),
        Identity("39", "(39)", "β_y0 = y [l² (x'² + y'²) - (xy' - yx')²] + y g |z|³",
            lambda p: beta_y(p)[0], _coefficient(1, 0)),
        Identity("40", "(40)", "β_y1 = 2z⁴ sinϕ x' - 2y x' cosϕ |z|³", lambda p: beta_y(p)[1], _coefficient(1, 1)),
        Identity("41", "(41)", "β_y2 = z⁴ (-y + R sinϕ + 2y cos²ϕ) - |z|³ cosϕ [Ry + (z² - y²) sinϕ]",
            lambda p: beta_y(p)[2], _coefficient(1, 2)),
        Identity("39_text", ", after (39)", "β_y0 is β_x0 with the roles of x and y flipped",
            lambda p: beta_x(_swapped(p))[0], lambda p: beta_y(p)[0]),
        Statement("39_bias", ", after (39)", "Ω → 0: no bias with respect to the compass directions", _east_unbiased),
        Identity("40_text", ", after (40)", "β_y1 is β_x1 with the roles of x and y flipped and the sign switched",
            lambda p: -beta_x(_swapped(p))[1], lambda p: beta_y(p)[1],
            "only the velocities change roles: -2 y xdot cosϕ |z|³ as printed in (40)",
            lambda p: -beta_x(p.but(vx=p.vy, vy=p.vx))[1]),
        Identity("42", "(42)", "matrix · (x'', y'') = (-Σβ_x Ω^i, -Σβ_y Ω^i)",
            lambda p: matrix_times(p, horizontal_acceleration(p)),
            lambda p: (-in_powers(p, beta_x(p)), -in_powers(p, beta_y(p))),
            remark="with the accelerations of reference.model.force"),
        Identity("43_inverse", "(43)", "the inverse matrix / (z⁴ l²)",
            lambda p: inverse_times(p, matrix_times(p, (p.ax, p.ay))), lambda p: (p.ax, p.ay)),
        Identity("43", "(43)", "(x'', y'') = inverse · (-Σβ_x Ω^i, -Σβ_y Ω^i) / (z⁴ l²)",
            solved, horizontal_acceleration, remark="truth: reference.model.force"),
    )  # fmt: skip
    return in_angles + in_plane
