"""Gastebois, section 7.2: Lagrange's equations with the Coriolis force, for any angle."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from reference.model.force import acceleration

from ..checks import Check, Identity, component
from ..digits import MP, Vector, cos, derivative, dot, scale, sin
from ..first_principles import by_angles
from ..points import Point
from .lagrangian import along, angle_functions, coriolis, lagrangian, moving_velocity, speeds
from .numbers import G


def left_side(p: Point, i: int) -> Any:
    """Return d(∂L/∂q')/dt - ∂L/∂q of the Lagrangian, along a path with the point's accelerations."""
    q, v, a = (p.cord, p.azimuth), (p.cord_rate, p.azimuth_rate), (p.cord_second, p.azimuth_second)

    def nudged(vector: Vector, by: Any) -> Vector:
        return tuple(part + (by if k == i else 0) for k, part in enumerate(vector))

    def momentum(s: Any) -> Any:
        place = tuple(q[k] + v[k] * s + a[k] * s * s / 2 for k in (0, 1))
        rates = tuple(v[k] + a[k] * s for k in (0, 1))
        return (lagrangian(p, place, nudged(rates, 1)) - lagrangian(p, place, nudged(rates, -1))) / 2

    return derivative(momentum) - derivative(lambda s: lagrangian(p, nudged(q, s), v))


def without_prime(p: Point, i: int) -> Any:
    """Return d(dL/dq)/dt - dL/dq, as the general line is printed."""
    q, v, a = (p.cord, p.azimuth), (p.cord_rate, p.azimuth_rate), (p.cord_second, p.azimuth_second)

    def slope(s: Any) -> Any:
        place = tuple(q[k] + v[k] * s + a[k] * s * s / 2 for k in (0, 1))
        rates = tuple(v[k] + a[k] * s for k in (0, 1))
        return derivative(lambda u: lagrangian(p, tuple(x + (u if k == i else 0) for k, x in enumerate(place)), rates))

    return derivative(slope) - slope(MP.zero)


def _generalised(p: Point, i: int) -> Any:
    """Return f_c · ∂r/∂q_i."""
    return dot(coriolis(p), along(i)(p))


def angle_accelerations(p: Point) -> Vector:
    """Return θ'', φ'' of the reference's model with gravity alone, from its cartesian acceleration."""
    n, v = (scale(1 / p.length, vector) for vector in (by_angles(p, p.cord, p.azimuth), moving_velocity(p)))
    a = acceleration(n, v, p.uniform)
    sp, cp, *_ = angle_functions(p)
    second = (a[2] - cp * p.cord_rate**2) / sp
    turned = n[0] * a[1] - n[1] * a[0]
    return second, (turned - 2 * sp * cp * p.cord_rate * p.azimuth_rate) / sp**2


def printed_accelerations(p: Point) -> Vector:
    """Return θ'', φ'' as printed at the end of 7.2."""
    sp, cp, sl, _ = angle_functions(p)
    along = cp * sin(p.phi) - sp * sl * cos(p.phi)
    theta = -p.gravity / p.length * sp + sp * cp * p.azimuth_rate**2 + 2 * sp * along * p.rate * p.azimuth_rate
    return theta, (-2 * cp * p.cord_rate * p.azimuth_rate - 2 * along * p.rate * p.cord_rate) / sp


def checks() -> list[Check]:
    """Return the rows, in the order of print."""

    def theta_side(p: Point) -> Any:
        sp, cp, *_ = angle_functions(p)
        inertia = p.mass * p.length**2
        turned = inertia * (p.cord_second - sp * cp * p.azimuth_rate**2)
        return turned + p.mass * p.gravity * p.length * sp

    def phi_side(p: Point) -> Any:
        sp, cp, *_ = angle_functions(p)
        return p.mass * p.length**2 * (sp**2 * p.azimuth_second + 2 * sp * cp * p.cord_rate * p.azimuth_rate)

    def force(i: int, right: bool) -> Callable[[Point], Any]:
        """Return f_x, f_y or f_z as printed, or with φ where θ is printed."""

        def printed(p: Point) -> Any:
            along, across = speeds(p)
            sp, cp, sl, cl = angle_functions(p)
            up, north = p.rate * sin(p.phi), p.rate * cos(p.phi)
            wrong = (cp, sp, sp)[i]
            angle = (cl, sl, sl)[i] if right else wrong
            return (
                2
                * p.mass
                * (
                    along * cp * sl * up + across * angle * up - along * sp * north,
                    -along * cp * cl * up + across * angle * up,
                    along * cp * cl * north - across * angle * north,
                )[i]
            )

        return printed

    lines = (
        ("x", "v_φ cosθ Ω sinλ_a", "v_φ cosφ Ω sinλ_a"),
        ("y", "v_φ sinθ Ω sinλ_a", "v_φ sinφ Ω sinλ_a"),
        ("z", "- v_φ sinθ Ω cosλ_a", "- v_φ sinφ Ω cosλ_a"),
    )
    return [
        Identity(
            "gastebois_7_2_general",
            f"{G} 7.2",
            "d(dL/dq)/dt - dL/dq = …",
            lambda p: without_prime(p, 0),
            lambda p: left_side(p, 0),
            "d(dL/dq')/dt - dL/dq = …",
            theta_side,
            "for q = θ; the next two lines are printed with q'",
        ),
        Identity(
            "gastebois_7_2_theta",
            f"{G} 7.2",
            "m L0² θ'' - m L0² sinθ cosθ φ'² + m g_a L0 sinθ = …",
            theta_side,
            lambda p: left_side(p, 0),
        ),
        Identity(
            "gastebois_7_2_phi",
            f"{G} 7.2",
            "m L0² sin²θ φ'' + 2 m L0² sinθ cosθ θ' φ' = …",
            phi_side,
            lambda p: left_side(p, 1),
        ),
        Identity(
            "gastebois_7_2_work",
            f"{G} 7.2",
            "… = f_cx dx/dq + f_cy dy/dq + f_cz dz/dq",
            lambda p: tuple(_generalised(p, i) for i in (0, 1)),
            lambda p: tuple(left_side(_true_path(p), i) for i in (0, 1)),
            remark="along the accelerations of reference.model.force",
        ),
        *(
            Identity(
                f"gastebois_7_2_f{axis}",
                f"{G} 7.2",
                f"f_{axis} = 2 m (… {wrong} …)",
                force(i, False),
                component(coriolis, i),
                f"f_{axis} = 2 m (… {right} …)",
                force(i, True),
            )
            for i, (axis, wrong, right) in enumerate(lines)
        ),
        Identity(
            "gastebois_7_2_theta2",
            f"{G} 7.2",
            "θ'' = -g_a/L0 sinθ + sinθ cosθ φ'² + 2 sinθ (cosθ sinλ_a - sinθ sinφ cosλ_a) Ω φ'",
            lambda p: printed_accelerations(p)[0],
            lambda p: angle_accelerations(p)[0],
            remark="truth: reference.model.force with gravity alone; φ from east to north",
        ),
        Identity(
            "gastebois_7_2_phi2",
            f"{G} 7.2",
            "φ'' = (-2 cosθ θ'φ' - 2 (cosθ sinλ_a - sinθ sinφ cosλ_a) Ω θ') / sinθ",
            lambda p: printed_accelerations(p)[1],
            lambda p: angle_accelerations(p)[1],
        ),
    ]


def _true_path(p: Point) -> Point:
    second, turned = angle_accelerations(p)
    return p.but(cord_second=second, azimuth_second=turned)
