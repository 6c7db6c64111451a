"""Gastebois, section 5: the forces, and the equations for small angles."""

from __future__ import annotations

from typing import Any

from reference.model.force import tension

from ..checks import Approximate, Check, Identity
from ..digits import MP, Vector, add, cos, dot, scale
from ..linear import acceleration_of, rate_up
from ..mathar.slow import linearised, uniform_acceleration
from ..points import Point, points
from .numbers import G


def _swung(s: Any) -> tuple[Any, Any]:
    """Return g_a (θm² - θ²) and v²/L0 at θ = θm/2, for a pendulum let go at θm = 0.3 s."""
    p = points()[0]
    top, angle = MP.mpf("0.3") * s, MP.mpf("0.15") * s
    return p.gravity * (top**2 - angle**2), 2 * p.gravity * (cos(angle) - cos(top))


def _tension(s: Any) -> tuple[Any, Any]:
    """Return g_a and the tension of the cord per mass, without rotation, at s times the point's amplitude."""
    p = points()[0].but(rate=MP.zero)
    x, y = p.x * s, p.y * s
    state = p.but(x=x, y=y, vx=p.vx * s, vy=p.vy * s)
    n, v = (scale(1 / p.length, vector) for vector in (state.position, state.velocity))
    return p.gravity, p.length * tension(n, v, state.uniform)


def _with_tension(p: Point) -> Vector:
    """Return -T/m x/L0 + 2y'Ω sinλ_a - 2z'Ω cosλ_a, and the line for y''."""
    n, v = (scale(1 / p.length, vector) for vector in (p.position, p.velocity))
    pull = p.length * tension(n, v, p.uniform)
    up, north = rate_up(p), p.rate * cos(p.phi)
    return (
        -pull * p.x / p.length + 2 * p.vy * up - 2 * p.vz * north,
        -pull * p.y / p.length - 2 * p.vx * up,
    )


def _small(p: Point) -> Vector:
    square, up = p.gravity / p.length, rate_up(p)
    return -square * p.x + 2 * p.vy * up, -square * p.y - 2 * p.vx * up


def _forces(p: Point) -> tuple[Vector, Vector]:
    """Return the acceleration of the reference's model, and m g_a + T + 2 m v × Ω."""
    n, v = (scale(1 / p.length, vector) for vector in (p.position, p.velocity))
    pull = p.length * tension(n, v, p.uniform)
    weight = (MP.zero, MP.zero, -p.mass * p.gravity)
    north, up = p.rate * cos(p.phi), rate_up(p)
    bent = (p.vy * up - p.vz * north, -p.vx * up, p.vx * north)
    return acceleration_of(p), add(weight, scale(-p.mass * pull, n), scale(2 * p.mass, bent))


def _energy(p: Point) -> tuple[Any, Any]:
    """Return the change of v²/2 per time, and the power of gravity per mass: the Coriolis force does no work."""
    accelerated = dot(p.velocity, acceleration_of(p))
    return accelerated, -p.gravity * p.vz


def checks() -> list[Check]:
    """Return the rows of section 5."""
    return [
        Identity(
            "gastebois_5_newton",
            f"{G} 5",
            "a = m g_a + T + 2 m v × Ω",
            lambda p: _forces(p)[0],
            lambda p: _forces(p)[1],
            "m a = m g_a + T + 2 m v × Ω",
            lambda p: scale(p.mass, _forces(p)[0]),
        ),
        Identity(
            "gastebois_5_energy",
            f"{G} 5",
            "v²/L0 = 2 g_a (cosθ - cosθm): conservation of energy",
            lambda p: _energy(p)[0],
            lambda p: _energy(p)[1],
            remark="as rates: v · a = -g_a z'",
        ),
        Approximate(
            "gastebois_5_square",
            f"{G} 5",
            "2 g_a (cosθ - cosθm) = g_a (θm² - θ²)",
            _swung,
            2,
            "θm",
            remark="θm = 0.3, θ = 0.15",
        ),
        Approximate("gastebois_5_tension", f"{G} 5", "T = m g_a", _tension, 2, "amplitude", remark="at a random point"),
        Identity(
            "gastebois_5_long",
            f"{G} 5",
            "x'' = -T/m x/L0 + 2y'Ω sinλ_a - 2z'Ω cosλ_a, y'' = -T/m y/L0 - 2x'Ω sinλ_a",
            _with_tension,
            uniform_acceleration,
            remark="truth: reference.model.force with gravity alone",
        ),
        Identity(
            "gastebois_5_small",
            f"{G} 5",
            "x'' = -ω0² x + 2y'Ω sinλ_a, y'' = -ω0² y - 2x'Ω sinλ_a",
            _small,
            linearised,
            remark="truth: reference.model.force with gravity alone, linear",
        ),
    ]
