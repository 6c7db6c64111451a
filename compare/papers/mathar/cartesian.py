"""Mathar, section IV: the equations of motion in x and y, (31)-(43)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..checks import Check, Finding, Identity, Statement, section
from ..digits import MP, Vector, cos, shown, sin
from ..first_principles import by_plane, euler_lagrange, horizontal_acceleration, in_rate
from ..points import Point, points


def _shared(p: Point) -> Any:
    """Return the two factors that (33) and (39) share, beside x and y."""
    bent = p.length**2 * (p.vx**2 + p.vy**2) - (p.x * p.vy - p.y * p.vx) ** 2
    return bent, p.gravity * abs(p.z) ** 3


def beta_x(p: Point) -> Vector:
    """Return β_x0, β_x1, β_x2 by (33)-(35)."""
    s, c, deep = sin(p.phi), cos(p.phi), abs(p.z) ** 3
    bent, pull = _shared(p)
    return (
        p.x * bent + p.x * pull,
        -2 * p.z**4 * s * p.vy + 2 * p.y * p.vy * c * deep,
        -p.x * p.z**4 * s**2 + p.x * c * (p.y * s - p.R) * deep,
    )


def beta_y(p: Point) -> Vector:
    """Return β_y0, β_y1, β_y2 by (39)-(41)."""
    s, c, deep = sin(p.phi), cos(p.phi), abs(p.z) ** 3
    bent, pull = _shared(p)
    return (
        p.y * bent + p.y * pull,
        2 * p.z**4 * s * p.vx - 2 * p.y * p.vx * c * deep,
        p.z**4 * (-p.y + p.R * s + 2 * p.y * c**2) - deep * c * (p.R * p.y + (p.z**2 - p.y**2) * s),
    )


def in_powers(p: Point, beta: Vector) -> Any:
    """Return the sum of β_i Ω^i."""
    return sum(part * p.rate**i for i, part in enumerate(beta))


def matrix_times(p: Point, a: Vector) -> Vector:
    """Return the left side of (42)."""
    x, y, z = p.position
    return (
        z**2 * (x**2 + z**2) * a[0] + z**2 * y * x * a[1],
        z**2 * y * x * a[0] + z**2 * (y**2 + z**2) * a[1],
    )


def inverse_times(p: Point, b: Vector) -> Vector:
    """Return the right side of (43)."""
    x, y, z = p.position
    top = ((y**2 + z**2) * b[0] - y * x * b[1], -y * x * b[0] + (x**2 + z**2) * b[1])
    return tuple(part / (z**4 * p.length**2) for part in top)


def solved(p: Point) -> Vector:
    """Return x'', y'' by (43)."""
    return inverse_times(p, (-in_powers(p, beta_x(p)), -in_powers(p, beta_y(p))))


def _equation(i: int) -> Callable[[Point], Any]:
    """Return the Euler-Lagrange equation for x or y."""
    return lambda p: euler_lagrange(p, by_plane, (p.x, p.y), (p.vx, p.vy), (p.ax, p.ay), i)


def _coefficient(i: int, power: int) -> Callable[[Point], Any]:
    """Return z⁴ times the terms of Euler-Lagrange without accelerations, at one power of Ω."""
    still = (MP.zero, MP.zero)
    return lambda p: (
        p.z**4 * in_rate(lambda rate: euler_lagrange(p, by_plane, (p.x, p.y), (p.vx, p.vy), still, i, rate), power)
    )


def _printed_32(p: Point) -> Any:
    x, y, square = p.x, p.y, p.length**2
    first = square**2 + y**4 - 2 * y**2 * square + y**2 * x**2 - square * x**2
    return first * p.ax + (-(x**3) * y + x * y * square - x * y**3) * p.ay + in_powers(p, beta_x(p))


def _swapped(p: Point) -> Point:
    return p.but(x=p.y, y=p.x, vx=p.vy, vy=p.vx)


def _east_unbiased() -> Finding:
    p = points()[0].but(rate=MP.zero)
    gap = solved(p)[0] - solved(_swapped(p))[1]
    return Finding(abs(gap) < MP.mpf("1e-45"), f"x'' - (y'' with x and y exchanged) at Ω = 0: {shown(gap)}")


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    return section("mathar_", "Mathar IV",
        Identity("32_text", ", before (32)", "multiply the result with z²",
            lambda p: p.z**2 * _equation(0)(p), _printed_32, "multiply with z⁴; (32), (36), (38) are printed so",
            lambda p: p.z**4 * _equation(0)(p)),
        Identity("32", "(31), (32)", "(l⁴+y⁴-2y²l²+y²x²-l²x²) x'' + (-x³y+xyl²-xy³) y'' + Σβ_x Ω^i = 0",
            _printed_32, lambda p: p.z**4 * _equation(0)(p)),
        Identity("33", "(33)", "β_x0 = x [l² (x'² + y'²) - (xy' - yx')²] + x g |z|³",
            lambda p: beta_x(p)[0], _coefficient(0, 0)),
        Identity("34", "(34)", "β_x1 = -2z⁴ sinϕ y' + 2y y' cosϕ |z|³", lambda p: beta_x(p)[1], _coefficient(0, 1)),
        Identity("35", "(35)", "β_x2 = -x z⁴ sin²ϕ + x cosϕ (y sinϕ - R) |z|³",
            lambda p: beta_x(p)[2], _coefficient(0, 2)),
        Identity("36", "(36)", "z²(x²+z²) x'' + z²yx y'' + Σβ_x Ω^i = 0",
            lambda p: matrix_times(p, (p.ax, p.ay))[0] + in_powers(p, beta_x(p)), lambda p: p.z**4 * _equation(0)(p)),
        Identity("38", "(37), (38)", "z²yx x'' + z²(y²+z²) y'' + Σβ_y Ω^i = 0",
            lambda p: matrix_times(p, (p.ax, p.ay))[1] + in_powers(p, beta_y(p)), lambda p: p.z**4 * _equation(1)(p)),
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
