"""Gastebois, section 3 and the annex: acceleration in a turning frame."""

from __future__ import annotations

from typing import Any

from ..checks import Check, Identity
from ..digits import MP, Vector, add, cos, cross, scale, sin, vector_derivative
from ..first_principles import AXIS, rotated
from ..points import Point
from .numbers import G


def turning_acceleration(p: Point) -> Vector:
    """Return the acceleration of a point with x'', y'' in axes that turn about z, from its place in axes at rest."""

    def at_rest(s: Any) -> Vector:
        place = (p.x + p.vx * s + p.ax * s * s / 2, p.y + p.vy * s + p.ay * s * s / 2, p.t + p.cord * s)
        return rotated(place, AXIS, p.rate * s)

    return vector_derivative(at_rest, 0, 2)


def turning_velocity(p: Point) -> Vector:
    """Return the velocity of the same point."""
    return vector_derivative(lambda s: rotated((p.x + p.vx * s, p.y + p.vy * s, p.t), AXIS, p.rate * s))


def turning(p: Point) -> Vector:
    """Return Ω on east, north, up at the latitude λ."""
    return (MP.zero, p.rate * cos(p.phi), p.rate * sin(p.phi))


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    return [
        Identity(
            "gastebois_3_1_v",
            f"{G} 3.1",
            "dOM/dt = x' i + x Ω j + y' j - y Ω i + z' k",
            lambda p: (p.vx - p.y * p.rate, p.x * p.rate + p.vy, MP.zero),
            turning_velocity,
        ),
        Identity(
            "gastebois_3_1_a",
            f"{G} 3.1",
            "d²OM/dt² = x'' i + x'Ω j + x'Ω j - xΩ² i + y'' j - y'Ω i - y'Ω i - yΩ² j + z'' k",
            lambda p: (
                p.ax - p.x * p.rate**2 - 2 * p.vy * p.rate,
                p.vx * p.rate + p.vx * p.rate + p.ay - p.y * p.rate**2,
                MP.zero,
            ),
            turning_acceleration,
        ),
        Identity(
            "gastebois_3_1_vector",
            f"{G} 3.1",
            "a = a_r - Ω² R - 2 v_r × Ω",
            lambda p: add(
                (p.ax, p.ay, MP.zero),
                scale(-(p.rate**2), (p.x, p.y, MP.zero)),
                scale(-2, cross((p.vx, p.vy, p.cord), (MP.zero, MP.zero, p.rate))),
            ),
            turning_acceleration,
        ),
        Identity(
            "gastebois_3_1_any",
            f"{G} 3.1",
            "true for any orientation of Ω",
            lambda p: add(
                scale(-1, cross(turning(p), cross(p.position, turning(p)))),
                scale(-2, cross(p.velocity, turning(p))),
            ),
            _tilted_frame,
        ),
        Identity(
            "gastebois_3_2",
            f"{G} 3.2",
            "m a_r = ΣF + m Ω² R + 2 m v_r × Ω",
            lambda p: add(
                scale(p.mass, turning_acceleration(p)),
                scale(p.mass * p.rate**2, (p.x, p.y, MP.zero)),
                scale(2 * p.mass, cross((p.vx, p.vy, p.cord), (MP.zero, MP.zero, p.rate))),
            ),
            lambda p: scale(p.mass, (p.ax, p.ay, MP.zero)),
        ),
        Identity(
            "gastebois_annex_i",
            f"{G}, annex",
            "i' = (-sinθ, cosθ) dθ/dt = Ω j",
            lambda p: scale(p.rate, (-sin(p.rate * p.t), cos(p.rate * p.t))),
            lambda p: vector_derivative(lambda t: (cos(p.rate * t), sin(p.rate * t)), p.t),
        ),
        Identity(
            "gastebois_annex_j",
            f"{G}, annex",
            "j' = (-cosθ, -sinθ) dθ/dt = -Ω i",
            lambda p: scale(-p.rate, (cos(p.rate * p.t), sin(p.rate * p.t))),
            lambda p: vector_derivative(lambda t: (-sin(p.rate * t), cos(p.rate * t)), p.t),
        ),
    ]


def _tilted_frame(p: Point) -> Vector:
    """Return the acceleration of a point that moves uniformly in axes turning about an inclined axis."""
    axis = scale(1 / p.rate, turning(p))
    return vector_derivative(lambda s: rotated(add(p.position, scale(s, p.velocity)), axis, p.rate * s), 0, 2)
