"""The third source paper, its equations: Newton, small angles, components, and axes that turn."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..checks import Approximate, Check, Finding, Identity, Statement, section
from ..digits import MP, Vector, add, cos, cross, dot, mpf, norm, scale, shown, sin, sqrt, unit, vector_derivative
from ..first_principles import acceleration_of, coupled, coupled_at, linearised, rate_up, turning, uniform_acceleration
from ..points import Point, points

Path = Callable[[Any], Vector]


def axes_rate(p: Point) -> Any:
    """Return ω_p = -ω sinα."""
    return -rate_up(p)


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
    return sqrt(stiffness(p))


def measured_rate(p: Point) -> Any:
    """Return ω̃ from x'' of a bob at rest at x = 1 in the turning axes."""
    return sqrt(-unprimed_equation(p.but(x=MP.one, y=MP.zero, vx=MP.zero, vy=MP.zero), axes_rate(p))[0])


def _away_from_axis() -> Finding:
    p = points()[0]
    axis, far = turning(p), (MP.zero, MP.zero, p.radius)
    pushed = scale(-1, cross(axis, cross(axis, far)))
    across = add(far, scale(-dot(far, unit(axis)), unit(axis)))
    gap = norm(add(unit(pushed), scale(-1, unit(across))))
    return Finding(gap < mpf("1e-45"), f"-ω × (ω × r) points away from the axis to within {shown(gap)}")


def rising(s: Any) -> Point:
    """Return the first random point, its amplitude times s."""
    p = points()[0]
    return p.but(x=p.x * s, y=p.y * s, vx=p.vx * s, vy=p.vy * s)


def _cord(p: Point) -> Vector:
    """Return T along the cord, of the size that r·r'' = -v² requires."""
    free = add((MP.zero, MP.zero, -p.gravity), scale(-2, cross(turning(p), p.velocity)))
    pull = (dot(p.velocity, p.velocity) + dot(free, p.position)) / p.length**2
    return scale(-p.mass * pull, p.position)


def _horizontal(s: Any) -> Point:
    p = points()[0].but(rate=MP.zero)
    return p.but(x=p.x * s, y=p.y * s, vx=p.vx * s, vy=p.vy * s)


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    return section("methods_", "Three methods",
        Identity("newton", "", "T - mgk - 2m ω × v = m a",
            lambda p: add(_cord(p), scale(p.mass, (MP.zero, MP.zero, -p.gravity)), scale(-2 * p.mass,
                cross(turning(p), p.velocity))), lambda p: scale(p.mass, acceleration_of(p)),
            remark="truth: reference.model.force with gravity alone; T along the cord"),
        Identity("centrifugal", "", "|ω × (ω × r)| = ω² r cosα", lambda p: p.rate**2 * p.radius * cos(p.phi),
            lambda p: norm(cross(turning(p), cross(turning(p), (MP.zero, MP.zero, p.radius))))),
        Statement("away", "", "with direction away from the axis of rotation", _away_from_axis),
        Approximate("sine", "", "mg sinθ ≈ mgθ",
            lambda s: (points()[0].cord * s, sin(points()[0].cord * s)), 2, "θ", remark="at a random θ of 0.9 rad"),
        Approximate("hooke", "", "T - mgk ≈ -(mg/L) ρ (i cosφ + j sinφ)",
            lambda s: (scale(-_horizontal(s).gravity / _horizontal(s).length, (_horizontal(s).x, _horizontal(s).y)),
                uniform_acceleration(_horizontal(s))), 2, "amplitude", remark="horizontal part, at a random point"),
        Identity("omega", "", "ω = ω (j cosα + k sinα)",
            lambda p: (MP.zero, p.rate * cos(p.phi), p.rate * sin(p.phi)), lambda p: p.k.turn),
        Identity("cross", "", "-2ω × v = 2ω xdot k cosα - 2ω xdot j sinα + 2ω ydot i sinα",
            lambda p: (2 * p.rate * p.vy * sin(p.phi), -2 * p.rate * p.vx * sin(p.phi), 2 * p.rate * p.vx *
                cos(p.phi)), lambda p: scale(-2, cross(p.k.turn, (p.vx, p.vy, MP.zero)))),
        Approximate("z", "", "2ω xdot cosα = zddot (and ignored)",
            lambda s: (2 * rising(s).rate * rising(s).vx * cos(rising(s).phi), acceleration_of(rising(s))[2]), 1,
            "amplitude", "m/s²", "at a random point; the cord's vertical pull differs from mg by as much"),
        Identity("pair", "", "xddot + (g/L) x = 2ω sinα ydot, yddot + (g/L) y = -2ω sinα xdot", coupled_at, linearised,
            remark="truth: reference.model.force with gravity alone, linear"),
    )  # fmt: skip
