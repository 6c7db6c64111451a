"""The yardstick of the papers' formulas: the Lagrangian, differentiated in high precision and never written out.

The bob's place in axes that do not turn is composed of rotations and of the ellipsoid's geometry; its velocity is the
derivative of that place, the kinetic energy half its square, and Euler and Lagrange give the equations of motion.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from reference.model.force import acceleration, rest_position, tension

from .digits import MP, Vector, add, cos, cross, derivative, dot, scale, sin, sqrt, tan, vector_derivative
from .points import Point

Coordinates = Callable[[Point, Any, Any], Vector]
Path = Callable[[Any], Vector]

AXIS = (MP.zero, MP.zero, MP.one)  # the Earth's axis
MIDDLE = (MP.zero, MP.one, MP.zero)  # east at the meridian of longitude 0


def rotated(vector: Vector, axis: Vector, angle: Any) -> Vector:
    """Return a vector turned about a unit axis, right-handed (Rodrigues' formula)."""
    along = scale(dot(axis, vector) * (1 - cos(angle)), axis)
    return add(scale(cos(angle), vector), scale(sin(angle), cross(axis, vector)), along)


def suspension(p: Point, longitude: Any, altitude: Any = None, phi: Any = None) -> Vector:
    """Return the point `altitude` along the ellipsoid's normal from where the normal has the latitude phi (radians)."""
    height = p.altitude if altitude is None else altitude
    latitude = p.phi if phi is None else phi
    polar = p.radius * (1 - p.flattening)
    reduced = MP.atan((1 - p.flattening) * tan(latitude))
    foot = (p.radius * cos(reduced), MP.zero, polar * sin(reduced))
    return rotated(add(foot, scale(height, (cos(latitude), MP.zero, sin(latitude)))), AXIS, longitude)


def turned_to_site(p: Point, local: Vector, longitude: Any) -> Vector:
    """Return a vector given on east, north, up, in axes that do not turn."""
    east, north, up = local
    return rotated(rotated((up, east, north), MIDDLE, -p.phi), AXIS, longitude)


def place(p: Point, local: Vector, t: Any, rate: Any = None) -> Vector:
    """Return the bob's place in axes that do not turn."""
    longitude = (p.rate if rate is None else rate) * t
    return add(suspension(p, longitude), turned_to_site(p, local, longitude))


def by_angles(p: Point, cord: Any, azimuth: Any) -> Vector:
    """Return the bob in local axes: straight down, tilted by the cord's angle towards the azimuth (east to north)."""
    axis = (sin(azimuth), -cos(azimuth), MP.zero)
    return rotated((MP.zero, MP.zero, -p.length), axis, cord)


def by_plane(p: Point, x: Any, y: Any) -> Vector:
    """Return the bob in local axes, on the sphere below the suspension."""
    return (x, y, -sqrt(p.length**2 - x**2 - y**2))


def velocity(p: Point, coordinates: Coordinates, q: Vector, v: Vector, rate: Any = None, t: Any = 0) -> Vector:
    """Return the velocity in axes that do not turn, of coordinates q that change at the rates v."""
    return vector_derivative(lambda s: place(p, coordinates(p, q[0] + v[0] * s, q[1] + v[1] * s), t + s, rate))


def square_speed(p: Point, coordinates: Coordinates, q: Vector, v: Vector, rate: Any = None, t: Any = 0) -> Any:
    """Return twice the kinetic energy per mass."""
    moving = velocity(p, coordinates, q, v, rate, t)
    return dot(moving, moving)


def lagrangian(p: Point, coordinates: Coordinates, q: Vector, v: Vector, rate: Any = None, t: Any = 0) -> Any:
    """Return K - V per mass, V = g z."""
    return square_speed(p, coordinates, q, v, rate, t) / 2 - p.gravity * coordinates(p, *q)[2]


def euler_lagrange(
    p: Point, coordinates: Coordinates, q: Vector, v: Vector, a: Vector, i: int, rate: Any = None
) -> Any:
    """Return d/dt ∂L/∂v_i - ∂L/∂q_i along a path with coordinates q, rates v and accelerations a."""

    def shifted(vector: Vector, by: Any) -> Vector:
        return tuple(part + (by if k == i else 0) for k, part in enumerate(vector))

    def momentum(s: Any) -> Any:
        position = tuple(q[k] + v[k] * s + a[k] * s * s / 2 for k in (0, 1))
        rates = tuple(v[k] + a[k] * s for k in (0, 1))
        ahead, behind = (lagrangian(p, coordinates, position, shifted(rates, by), rate, s) for by in (1, -1))
        return (ahead - behind) / 2  # exact: L is quadratic in the velocities

    return derivative(momentum) - derivative(lambda s: lagrangian(p, coordinates, shifted(q, s), v, rate))


def in_rate(function: Callable[[Any], Any], power: int) -> Any:
    """Return the coefficient of Ω**power of a function that is quadratic in Ω, from its values at -1, 0, 1."""
    below, middle, above = (function(MP.mpf(rate)) for rate in (-1, 0, 1))
    return (middle, (above - below) / 2, (above + below) / 2 - middle)[power]


def horizontal_acceleration(p: Point) -> Vector:
    """Return x'' and y'' of the reference's model at this point."""
    n, v = (scale(1 / p.length, vector) for vector in (p.position, p.velocity))
    return tuple(p.length * part for part in acceleration(n, v, p.k)[:2])


def rest(p: Point) -> Vector:
    """Return the rest position by the reference, in m."""
    return scale(p.length, rest_position(p.k, MP))


def rest_angle(p: Point) -> Any:
    """Return the angle of the rest position from straight down, to the south, in radians."""
    _, y, z = rest(p)
    return MP.atan2(-y, -z)


def pull_at_rest(p: Point) -> Any:
    """Return the tension of the cord per mass in the rest position."""
    n = scale(1 / p.length, rest(p))
    return p.length * tension(n, (0, 0, 0), p.k)


def moving(p: Point, s: Any) -> Vector:
    """Return the bob in local axes, its angles changing at their rates."""
    return by_angles(p, p.cord + p.cord_rate * s, p.azimuth + p.azimuth_rate * s)
