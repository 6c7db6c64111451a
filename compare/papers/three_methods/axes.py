"""The third source paper's two coupled equations, and their form in axes that turn; for its three methods."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..digits import MP, Vector, add, cos, scale, sin, sqrt, vector_derivative
from ..linear import rate_up
from ..points import Point

D = "Three methods"
Path = Callable[[Any], Vector]


def axes_rate(p: Point) -> Any:
    """Return ω_p = -ω sinα."""
    return -rate_up(p)


def coupled(p: Point, place: Vector, speed: Vector) -> Vector:
    """Return the acceleration by the two equations: -g/L x + 2ω sinα vy, -g/L y - 2ω sinα vx."""
    k, up = p.gravity / p.length, rate_up(p)
    return -k * place[0] + 2 * up * speed[1], -k * place[1] - 2 * up * speed[0]


def primed(path: Path, rate: Any) -> Path:
    """Return x' = x cosω_p t - y sinω_p t, y' = x sinω_p t + y cosω_p t along a path."""

    def turned(t: Any) -> Vector:
        x, y = path(t)
        c, s = cos(rate * t), sin(rate * t)
        return x * c - y * s, x * s + y * c

    return turned


def generic_path(p: Point) -> Path:
    """Return a path x, y with the point's velocities and accelerations at its time."""
    return lambda t: (
        p.x + p.vx * (t - p.t) + p.ax * (t - p.t) ** 2 / 2,
        p.y + p.vy * (t - p.t) + p.ay * (t - p.t) ** 2 / 2,
    )


def unprimed_equation(p: Point, rate: Any) -> Vector:
    """Return the x'', y'' for which x', y' obey the two equations, solved from their second derivatives."""

    def excess(a: Vector) -> Vector:
        moved = p.but(ax=a[0], ay=a[1])
        turned = primed(generic_path(moved), rate)
        place, speed, second = turned(p.t), vector_derivative(turned, p.t), vector_derivative(turned, p.t, 2)
        return add(second, scale(-1, coupled(p, place, speed)))

    zero = excess((MP.zero, MP.zero))
    columns = [add(excess(a), scale(-1, zero)) for a in ((MP.one, MP.zero), (MP.zero, MP.one))]
    solution = MP.lu_solve(MP.matrix([list(row) for row in zip(*columns, strict=True)]), MP.matrix([-z for z in zero]))
    return solution[0], solution[1]


def stiffness(p: Point) -> Any:
    """Return g/L + ω_p²."""
    return p.gravity / p.length + axes_rate(p) ** 2


def printed_rate(p: Point) -> Any:
    """Return ω̃ = sqrt(g/L + ω_p²)."""
    return sqrt(p.gravity / p.length + axes_rate(p) ** 2)


def measured_rate(p: Point) -> Any:
    """Return ω̃ from x'' of a bob at rest at x = 1 in the turning axes."""
    return sqrt(-unprimed_equation(p.but(x=MP.one, y=MP.zero, vx=MP.zero, vy=MP.zero), axes_rate(p))[0])
