"""The standard for the papers' formulas: the Lagrangian, differentiated in high precision and never written out.

The bob's place in axes that do not turn is composed of rotations and of the ellipsoid's geometry;
its velocity is the derivative of that place, the kinetic energy half its square, and Euler and
Lagrange give the equations of motion. With gravity alone and linear about straight down that is the
linear pendulum of all three papers, whose exact motion is the exponential of its matrix.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from reference.model.constants import Constants
from reference.model.force import acceleration, tension

from .digits import MP, Vector, cos, cross, derivative, dot, j, mpf, sin, sqrt, tan, vector
from .points import Point

Coordinates = Callable[[Point, Any, Any], Vector]

AXIS = vector(0, 0, MP.one)  # the Earth's axis
MIDDLE = vector(0, MP.one, 0)  # east at the meridian of longitude 0


def rotated(a: Vector, axis: Vector, angle: Any) -> Vector:
    """Return a vector turned about a unit axis, right-handed (Rodrigues' formula)."""
    along = dot(axis, a) * (1 - cos(angle)) * axis
    return cos(angle) * a + sin(angle) * cross(axis, a) + along


def turned_in_plane(xy: Vector, angle: Any) -> Vector:
    """Return x, y turned by an angle, from x to y."""
    (x, y), c, s = xy, cos(angle), sin(angle)
    return vector(x * c - y * s, x * s + y * c)


def suspension(p: Point, longitude: Any) -> Vector:
    """Return the point at p's altitude along the ellipsoid's normal from where the normal has p's latitude."""
    polar = p.radius * (1 - p.flattening)
    reduced = MP.atan((1 - p.flattening) * tan(p.phi))
    foot = vector(p.radius * cos(reduced), 0, polar * sin(reduced))
    return rotated(foot + p.altitude * vector(cos(p.phi), 0, sin(p.phi)), AXIS, longitude)


def turned_to_site(p: Point, local: Vector, longitude: Any) -> Vector:
    """Return a vector given on east, north, up, in axes that do not turn."""
    east, north, up = local
    return rotated(rotated(vector(up, east, north), MIDDLE, -p.phi), AXIS, longitude)


def place(p: Point, local: Vector, t: Any) -> Vector:
    """Return the bob's place in axes that do not turn."""
    return suspension(p, p.rate * t) + turned_to_site(p, local, p.rate * t)


def by_angles(p: Point, cord: Any, azimuth: Any) -> Vector:
    """Return the bob in local axes: straight down, tilted by the cord's angle towards the azimuth (east to north)."""
    axis = vector(sin(azimuth), -cos(azimuth), 0)
    return rotated(vector(0, 0, -p.length), axis, cord)


def by_plane(p: Point, x: Any, y: Any) -> Vector:
    """Return the bob in local axes, on the sphere below the suspension."""
    return vector(x, y, -sqrt(p.length**2 - x**2 - y**2))


def square_speed(p: Point, coordinates: Coordinates, q: Vector, v: Vector, t: Any = 0) -> Any:
    """Return v² in axes that do not turn, twice the kinetic energy per mass: of coordinates q with the rates v."""
    velocity = derivative(lambda s: place(p, coordinates(p, *(q + s * v)), t + s))
    return dot(velocity, velocity)


def lagrangian(p: Point, coordinates: Coordinates, q: Vector, v: Vector, t: Any = 0) -> Any:
    """Return K - V per mass, V = g z."""
    return square_speed(p, coordinates, q, v, t) / 2 - p.gravity * coordinates(p, *q)[2]


def euler_lagrange(
    p: Point, coordinates: Coordinates, q: Vector, v: Vector, a: Vector, i: int
) -> Any:
    """Return d/dt ∂L/∂v_i - ∂L/∂q_i along a path with coordinates q, rates v and accelerations a."""

    def shifted(a: Vector, by: Any) -> Vector:
        return a + by * np.eye(len(a), dtype=int)[i]

    def momentum(s: Any) -> Any:
        position, rates = q + s * v + s * s / 2 * a, v + s * a
        ahead, behind = (
            lagrangian(p, coordinates, position, shifted(rates, by), s) for by in (1, -1)
        )
        return (ahead - behind) / 2  # exact: L is quadratic in the velocities

    return derivative(momentum) - derivative(lambda s: lagrangian(p, coordinates, shifted(q, s), v))


def in_rate(function: Callable[[Any], Any], power: int) -> Any:
    """Return the coefficient of Ω**power of a function that is quadratic in Ω, from its values at -1, 0, 1."""
    below, middle, above = (function(MP.mpf(rate)) for rate in (-1, 0, 1))
    return (middle, (above - below) / 2, (above + below) / 2 - middle)[power]


def _acceleration(p: Point, k: Constants) -> Vector:
    """Return x'', y'', z'' of the reference's model with some constants."""
    return p.length * vector(*acceleration(p.case.n, p.case.v, k))


def horizontal_acceleration(p: Point) -> Vector:
    """Return x'' and y'' of the reference's model at this point."""
    return _acceleration(p, p.k)[:2]


def acceleration_of(p: Point) -> Vector:
    """Return x'', y'', z'' of the reference's model with gravity alone."""
    return _acceleration(p, p.uniform)


def uniform_acceleration(p: Point) -> Vector:
    """Return x'', y'' of the same."""
    return acceleration_of(p)[:2]


def pull(p: Point) -> Any:
    """Return the tension of the cord per mass, of the reference's model with gravity alone."""
    return p.length * tension(p.case.n, p.case.v, p.uniform)


def rest(p: Point) -> Vector:
    """Return the rest position by the reference, in m."""
    return p.length * vector(*p.case.rest)


def moving_velocity(p: Point) -> Vector:
    """Return the velocity of the bob in local axes, its angles changing at their rates."""
    return derivative(
        lambda s: by_angles(p, p.cord + p.cord_rate * s, p.azimuth + p.azimuth_rate * s)
    )


def angle_state(p: Point) -> tuple[Vector, Vector, Vector]:
    """Return the angles, their rates and their accelerations."""
    return (
        vector(p.cord, p.azimuth),
        vector(p.cord_rate, p.azimuth_rate),
        vector(p.cord_second, p.azimuth_second),
    )


def plane_state(p: Point) -> tuple[Vector, Vector, Vector]:
    """Return x and y, their rates and their accelerations."""
    return vector(p.x, p.y), vector(p.vx, p.vy), vector(p.ax, p.ay)


def turning(p: Point) -> Vector:
    """Return Ω on east, north, up at the latitude λ."""
    return vector(0, p.rate * cos(p.phi), rate_up(p))


def forces(p: Point) -> Vector:
    """Return m g + T + 2 m v × Ω, with gravity alone and the tension of the reference's model."""
    weight, cord = vector(0, 0, -p.gravity), -pull(p) * vector(*p.case.n)
    return p.mass * (weight + cord + 2 * cross(p.velocity, turning(p)))


def linearised(p: Point) -> Vector:
    """Return x'', y'' of the reference's model without centrifugal force, linear about straight down."""
    return derivative(lambda s: uniform_acceleration(p.swinging(s)))


def rate_up(p: Point) -> Any:
    """Return Ω_z = Ω sinλ_a."""
    return p.rate * sin(p.phi)


def coupled(p: Point, place: Vector, speed: Vector) -> Vector:
    """Return x'', y'' of the pair that all three print, Mathar as (51)-(52): -g/l x + 2Ω_z vy, -g/l y - 2Ω_z vx."""
    pull, up = p.gravity / p.length, rate_up(p)
    return vector(-pull * place[0] + 2 * up * speed[1], -pull * place[1] - 2 * up * speed[0])


def coupled_at(p: Point) -> Vector:
    """Return the same at the point's own place and speed."""
    return coupled(p, (p.x, p.y), (p.vx, p.vy))


def coupled_complex(p: Point) -> Any:
    """Return Z'' of the same for Z = x + jy, as the second and the third paper print it: -g/l Z - 2jΩ_z Z'."""
    return -p.gravity / p.length * MP.mpc(p.x, p.y) - 2 * j * rate_up(p) * MP.mpc(p.vx, p.vy)


def swing_rate(p: Point) -> Any:
    """Return ω = sqrt(ω0² + Ω_z²)."""
    return sqrt(p.gravity / p.length + rate_up(p) ** 2)


@cache
def matrix(p: Point) -> Any:
    """Return the matrix of the reference's model with gravity alone, linear about straight down, from unit states."""
    columns = []
    for name in ("x", "y", "vx", "vy"):
        state = p.but(**(dict.fromkeys(("x", "y", "vx", "vy"), MP.zero) | {name: MP.one / 10}))
        columns.append([10 * part for part in (state.vx, state.vy, *linearised(state))])
    return MP.matrix(columns).T


def motion(p: Point, start: Vector, t: Any) -> Vector:
    """Return x, y, vx, vy of the linear system after a time."""
    return vector(*MP.expm(matrix(p) * t, method="taylor") * MP.matrix(start))


def turning_rates(p: Point) -> list[Any]:
    """Return the two α of motions Z = c exp(jαt), smaller first: eigenvalues of the matrix with y = -j x."""
    values, vectors = MP.eig(matrix(p))
    return sorted(
        value.imag
        for i, value in enumerate(values)
        if abs(vectors[1, i] + j * vectors[0, i]) < mpf("1e-30")
    )
