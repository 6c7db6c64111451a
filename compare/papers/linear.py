"""The linear Foucault pendulum: the reference's model linearised about straight down, and its exact motion."""

from __future__ import annotations

from functools import cache
from typing import Any

from reference.model.force import acceleration

from .digits import MP, Vector, cos, j, mpf, scale, sin, sqrt, vector_derivative
from .points import Point


def turning(p: Point) -> Vector:
    """Return Ω on east, north, up at the latitude λ."""
    return (MP.zero, p.rate * cos(p.phi), p.rate * sin(p.phi))


def uniform_acceleration(p: Point) -> Vector:
    """Return x'', y'' of the reference's model with gravity alone."""
    n, v = (scale(1 / p.length, vector) for vector in (p.position, p.velocity))
    return tuple(p.length * part for part in acceleration(n, v, p.uniform)[:2])


def linearised(p: Point) -> Vector:
    """Return x'', y'' of the reference's model without centrifugal force, linear about straight down."""

    def scaled(s: Any) -> Vector:
        moved = p.but(x=p.x * s, y=p.y * s, vx=p.vx * s, vy=p.vy * s)
        return uniform_acceleration(moved)

    return vector_derivative(scaled)


def rate_up(p: Point) -> Any:
    """Return Ω_z = Ω sinλ_a."""
    return p.rate * sin(p.phi)


def coupled(p: Point, place: Vector, speed: Vector) -> Vector:
    """Return x'', y'' of the pair that all three print, Mathar as (51)-(52): -g/l x + 2Ω_z vy, -g/l y - 2Ω_z vx."""
    pull, up = p.gravity / p.length, rate_up(p)
    return -pull * place[0] + 2 * up * speed[1], -pull * place[1] - 2 * up * speed[0]


def coupled_at(p: Point) -> Vector:
    """Return the same at the point's own place and speed."""
    return coupled(p, (p.x, p.y), (p.vx, p.vy))


def swing_rate(p: Point) -> Any:
    """Return ω = sqrt(ω0² + Ω_z²)."""
    return sqrt(p.gravity / p.length + rate_up(p) ** 2)


@cache
def matrix(p: Point) -> Any:
    """Return the matrix of the reference's model with gravity alone, linear about straight down, from unit states."""
    columns = []
    for name in ("x", "y", "vx", "vy"):
        state = dict.fromkeys(("x", "y", "vx", "vy"), MP.zero) | {name: MP.one / 10}
        unit = p.but(**state)
        columns.append([10 * part for part in (unit.vx, unit.vy, *linearised(unit))])
    return MP.matrix(columns).T


def motion(p: Point, start: Vector, t: Any) -> Vector:
    """Return x, y, vx, vy of the linear system after a time."""
    return tuple(MP.expm(matrix(p) * t, method="taylor") * MP.matrix(start))


def start_at_rest(p: Point) -> Vector:
    """Return the start of a bob let go at rest at x, in the east."""
    return (p.x, MP.zero, MP.zero, MP.zero)


def motion_at_rest(p: Point, t: Any) -> Vector:
    """Return x, y of the linear system let go at rest at x."""
    return motion(p, start_at_rest(p), t)[:2]


def acceleration_of(p: Point) -> Vector:
    """Return x'', y'', z'' of the reference's model with gravity alone."""
    ax, ay = uniform_acceleration(p)
    z, vz = p.z, p.vz
    return ax, ay, -(p.vx**2 + p.vy**2 + vz**2 + p.x * ax + p.y * ay) / z


def turning_rates(p: Point) -> list[Any]:
    """Return the two α of motions Z = c exp(jαt), smaller first: eigenvalues of the matrix with y = -j x."""
    values, vectors = MP.eig(matrix(p))
    return sorted(value.imag for i, value in enumerate(values) if abs(vectors[1, i] + j * vectors[0, i]) < mpf("1e-30"))
