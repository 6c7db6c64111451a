"""Gastebois, section 7.1: the Lagrangian and its coordinates."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from reference.model.force import acceleration

from ..checks import Check, Identity
from ..digits import MP, Vector, add, cos, cross, dot, scale, sin, vector_derivative
from ..first_principles import by_angles
from ..mathar.velocity import moving
from ..points import Point
from .frames import turning
from .numbers import G


def angle_functions(p: Point) -> tuple[Any, ...]:
    """Return sine and cosine of θ, then of φ."""
    return sin(p.cord), cos(p.cord), sin(p.azimuth), cos(p.azimuth)


def speeds(p: Point) -> Vector:
    """Return v_θ = L0 θ', v_φ = L0 sinθ φ'."""
    return p.length * p.cord_rate, p.length * sin(p.cord) * p.azimuth_rate


def moving_velocity(p: Point) -> Vector:
    """Return the velocity from the motion of the angles."""
    return vector_derivative(lambda s: moving(p, s))


def kinetic(p: Point, square: Any) -> Any:
    """Return L = m v²/2 + m g_a L0 cosθ, v² being `square`."""
    return p.mass * square / 2 + p.mass * p.gravity * p.length * cos(p.cord)


def lagrangian(p: Point, q: Vector, v: Vector) -> Any:
    """Return m v²/2 - m g_a z of angles q that change at the rates v, from the motion itself."""
    state = p.but(cord=q[0], azimuth=q[1], cord_rate=v[0], azimuth_rate=v[1])
    square = dot(moving_velocity(state), moving_velocity(state))
    return p.mass * square / 2 - p.mass * p.gravity * by_angles(p, *q)[2]


def coriolis(p: Point) -> Vector:
    """Return f_c = 2 m v × Ω from the motion of the angles."""
    return scale(2 * p.mass, cross(moving_velocity(p), turning(p)))


def along(i: int) -> Callable[[Point], Vector]:
    """Return ∂r/∂θ or ∂r/∂φ."""

    def slope(p: Point) -> Vector:
        return vector_derivative(
            lambda s: by_angles(p, p.cord + (s if i == 0 else 0), p.azimuth + (s if i == 1 else 0))
        )

    return slope


def checks() -> list[Check]:
    """Return the rows, in the order of print."""

    def velocity(p: Point) -> Vector:
        along, across = speeds(p)
        sp, cp, sl, cl = angle_functions(p)
        return along * cp * cl - across * sl, along * cp * sl + across * cl, along * sp

    def balance(p: Point, by: Any) -> Vector:
        """Return (m g_a + T + f_c) / `by` minus the acceleration."""
        n, v = (scale(1 / p.length, vector) for vector in (by_angles(p, p.cord, p.azimuth), moving_velocity(p)))
        a = acceleration(n, v, p.uniform)
        free = add(scale(p.mass, (MP.zero, MP.zero, -p.gravity)), coriolis(p))
        tension = -p.mass * p.length * dot(v, v) - dot(free, n)  # it keeps the bob on the sphere
        return add(scale(1 / by, add(free, scale(tension, n))), scale(-p.length, a))

    def half(p: Point) -> Any:
        sp, _, _, _ = angle_functions(p)
        return p.length**2 * p.cord_rate**2 + p.length**2 * sp**2 * p.azimuth_rate**2

    q_slopes = {
        "theta": (lambda p: scale(p.length, _by_theta(p)), 0, "dr/dθ = L0 (cosθ cosφ, cosθ sinφ, sinθ)"),
        "phi": (lambda p: scale(p.length, _by_phi(p)), 1, "dr/dφ = L0 (-sinθ sinφ, sinθ cosφ, 0)"),
    }
    return [
        Identity(
            "gastebois_7_1_newton",
            f"{G} 7.1",
            "a = m g_a + T + f_c",
            lambda p: balance(p, MP.one),
            lambda p: (MP.zero,) * 3,
            "m a = m g_a + T + f_c",
            lambda p: balance(p, p.mass),
            "as m g_a + T + f_c minus the left side",
        ),
        Identity(
            "gastebois_7_1_l",
            f"{G} 7.1",
            "L = m v_θ²/2 + m v_φ²/2 + m g_a L0 cosθ",
            lambda p: kinetic(p, dot(speeds(p), speeds(p))),
            lambda p: lagrangian(p, (p.cord, p.azimuth), (p.cord_rate, p.azimuth_rate)),
        ),
        Identity(
            "gastebois_7_1_v",
            f"{G} 7.1",
            "v_x = v_θ cosθ cosφ - v_φ sinφ, v_y = v_θ cosθ sinφ + v_φ cosφ, v_z = v_θ sinθ",
            velocity,
            moving_velocity,
        ),
        *(
            Identity(
                f"gastebois_7_1_{name}",
                f"{G} 7.1",
                text,
                printed,
                along(i),
            )
            for name, (printed, i, text) in q_slopes.items()
        ),
        Identity(
            "gastebois_7_1_l2",
            f"{G} 7.1",
            "L = m L0² θ'²/2 + m L0² sin²θ φ'²/2 + m g_a L0 cosθ",
            lambda p: kinetic(p, half(p)),
            lambda p: lagrangian(p, (p.cord, p.azimuth), (p.cord_rate, p.azimuth_rate)),
        ),
    ]


def _by_theta(p: Point) -> Vector:
    sp, cp, sl, cl = angle_functions(p)
    return cp * cl, cp * sl, sp


def _by_phi(p: Point) -> Vector:
    sp, _, sl, cl = angle_functions(p)
    return -sp * sl, sp * cl, MP.zero
