"""Gastebois, section 7: Lagrange's equations with the Coriolis force, and for small angles those of section 5 again."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..checks import Approximate, Check, Identity, component, over, section
from ..digits import MP, Vector, cos, cross, derivative, dot, sin, vector
from ..first_principles import (
    acceleration_of,
    angle_state,
    by_angles,
    coupled,
    coupled_at,
    euler_lagrange,
    forces,
    lagrangian,
    linearised,
    moving_velocity,
    rate_up,
    turning,
)
from ..points import Point, points


def speeds(p: Point) -> Vector:
    """Return v_θ = L0 θ', v_φ = L0 sinθ φ'."""
    return vector(p.length * p.cord_rate, p.length * sin(p.cord) * p.azimuth_rate)


def kinetic(p: Point, square: Any) -> Any:
    """Return L = m v²/2 + m g_a L0 cosθ, v² being `square`."""
    return p.mass * square / 2 + p.mass * p.gravity * p.length * cos(p.cord)


def _lagrangian(p: Point, q: Vector, v: Vector) -> Any:
    """Return m v²/2 - m g_a z of angles q that change at the rates v, from the motion itself."""
    return p.mass * lagrangian(p.but(rate=MP.zero), by_angles, q, v)


def coriolis(p: Point) -> Vector:
    """Return f_c = 2 m v × Ω from the motion of the angles."""
    return 2 * p.mass * cross(moving_velocity(p), turning(p))


def along(i: int) -> Callable[[Point], Vector]:
    """Return ∂r/∂θ or ∂r/∂φ."""
    return lambda p: derivative(lambda s: by_angles(p, *(angle_state(p)[0] + s * vector(1 - i, i))))


def _tangents(p: Point) -> tuple[Vector, Vector]:
    """Return ∂r/∂θ and ∂r/∂φ over L0 as printed."""
    sp, cp, sl, cl = p.angle_functions
    return vector(cp * cl, cp * sl, sp), vector(-sp * sl, sp * cl, 0)


def _velocity(p: Point) -> Vector:
    """Return v_x, v_y, v_z as printed."""
    along, across = speeds(p)
    sp, cp, sl, cl = p.angle_functions
    return vector(along * cp * cl - across * sl, along * cp * sl + across * cl, along * sp)


def _hung(p: Point) -> Point:
    """Return the point with the place and the velocity that its angles give."""
    (x, y, _), (vx, vy, _) = by_angles(p, p.cord, p.azimuth), moving_velocity(p)
    return p.but(x=x, y=y, vx=vx, vy=vy)


def _balance(p: Point, by: Any) -> Vector:
    """Return (m g_a + T + f_c) / `by` minus the acceleration."""
    return forces(_hung(p)) / by - acceleration_of(_hung(p))


def left_side(p: Point, i: int) -> Any:
    """Return d(∂L/∂q')/dt - ∂L/∂q of the Lagrangian, along a path with the point's accelerations."""
    return p.mass * euler_lagrange(p.but(rate=MP.zero), by_angles, *angle_state(p), i)


def _without_prime(p: Point) -> Any:
    """Return d(dL/dq)/dt - dL/dq, as the general line is printed, for q = θ."""
    q, v, a = angle_state(p)

    def slope(s: Any) -> Any:
        place, rates = q + s * v + s * s / 2 * a, v + s * a
        return derivative(lambda u: _lagrangian(p, place + vector(u, 0), rates))

    return derivative(slope) - slope(MP.zero)


def angle_accelerations(p: Point) -> Vector:
    """Return θ'', φ'' of the reference's model with gravity alone, from its cartesian acceleration."""
    sp, cp, sl, cl = p.angle_functions
    ax, ay, az = acceleration_of(_hung(p)) / p.length
    second = (az - cp * p.cord_rate**2) / sp
    turned = sp * (cl * ay - sl * ax)
    return vector(second, (turned - 2 * sp * cp * p.cord_rate * p.azimuth_rate) / sp**2)


def printed_accelerations(p: Point) -> Vector:
    """Return θ'', φ'' as printed at the end of 7.2."""
    sp, cp, sl, _ = p.angle_functions
    along = cp * sin(p.phi) - sp * sl * cos(p.phi)
    theta = (
        -p.gravity / p.length * sp
        + sp * cp * p.azimuth_rate**2
        + 2 * sp * along * p.rate * p.azimuth_rate
    )
    return vector(
        theta, (-2 * cp * p.cord_rate * p.azimuth_rate - 2 * along * p.rate * p.cord_rate) / sp
    )


def _accelerated(p: Point, accelerations: Vector) -> Point:
    return p.but(cord_second=accelerations[0], azimuth_second=accelerations[1])


def _theta_side(p: Point) -> Any:
    sp, cp, *_ = p.angle_functions
    turned = p.mass * p.length**2 * (p.cord_second - sp * cp * p.azimuth_rate**2)
    return turned + p.mass * p.gravity * p.length * sp


def _phi_side(p: Point) -> Any:
    sp, cp, *_ = p.angle_functions
    return (
        p.mass
        * p.length**2
        * (sp**2 * p.azimuth_second + 2 * sp * cp * p.cord_rate * p.azimuth_rate)
    )


def force(i: int, right: bool) -> Callable[[Point], Any]:
    """Return f_x, f_y or f_z as printed, or with φ where θ is printed."""

    def printed(p: Point) -> Any:
        along, across = speeds(p)
        sp, cp, sl, cl = p.angle_functions
        up, north = rate_up(p), p.rate * cos(p.phi)
        angle = (cl, sl, sl)[i] if right else (cp, sp, sp)[i]
        halves = (
            along * cp * sl * up + across * angle * up - along * sp * north,
            -along * cp * cl * up + across * angle * up,
            along * cp * cl * north - across * angle * north,
        )
        return 2 * p.mass * halves[i]

    return printed


def small_accelerations(p: Point) -> Vector:
    """Return θ'', φ'' for small angles by 7.3."""
    theta, up = p.cord, rate_up(p)
    second = (
        -p.gravity / p.length * theta + theta * p.azimuth_rate**2 + 2 * theta * up * p.azimuth_rate
    )
    return vector(second, (-2 * p.cord_rate * p.azimuth_rate - 2 * up * p.cord_rate) / theta)


def _narrow(s: Any) -> Point:
    p = points()[0]
    return p.but(cord=p.cord * s, cord_rate=p.cord_rate * s)


def _flat(p: Point, s: Any = 0) -> Vector:
    """Return x = L0 θ cosφ, y = L0 θ sinφ of small angles, along the point's path."""
    q, v, a = angle_state(p)
    theta, phi = q + s * v + s * s / 2 * a
    return vector(p.length * theta * cos(phi), p.length * theta * sin(phi))


def _flat_printed(p: Point) -> Vector:
    """Return x'' and y'' in θ, φ of 7.3, first lines."""
    _, _, sl, cl = p.angle_functions
    length, theta, turn = p.length, p.cord, p.azimuth_rate
    x = length * p.cord_second * cl - 2 * length * p.cord_rate * sl * turn
    y = length * p.cord_second * sl + 2 * length * p.cord_rate * cl * turn
    return vector(
        x - length * theta * cl * turn**2 - length * theta * sl * p.azimuth_second,
        y - length * theta * sl * turn**2 + length * theta * cl * p.azimuth_second,
    )


def _flat_solved(p: Point) -> Vector:
    """Return x'' and y'' with the small-angle accelerations put in, from the definition of x and y."""
    return derivative(lambda s: _flat(_accelerated(p, small_accelerations(p)), s), 0, 2)


def _flat_middle(p: Point, sign: int) -> Vector:
    """Return x'' and y'' of 7.3, middle lines: the first with θ'', φ'' put in.

    `sign` is that of the group of φ''.
    """
    second, turned = small_accelerations(p)
    return _flat_printed(_accelerated(p, (second, sign * turned)))


def _flat_end(p: Point) -> Vector:
    """Return x'' and y'' of 7.3, last lines in θ, φ."""
    _, _, sl, cl = p.angle_functions
    length, theta, up = p.length, p.cord, rate_up(p)
    along = length * p.cord_rate * cl - length * theta * sl * p.azimuth_rate
    across = length * p.cord_rate * sl + length * theta * cl * p.azimuth_rate
    return vector(
        -p.gravity * cl * theta + 2 * up * across, -p.gravity * sl * theta - 2 * up * along
    )


def checks() -> list[Check]:
    """Return the rows in the order in which they are printed."""
    lines = (
        ("x", "v_φ cosθ Ω sinλ_a", "v_φ cosφ Ω sinλ_a"),
        ("y", "v_φ sinθ Ω sinλ_a", "v_φ sinφ Ω sinλ_a"),
        ("z", "- v_φ sinθ Ω cosλ_a", "- v_φ sinφ Ω cosλ_a"),
    )
    return section("gastebois_", "Gastebois",
        Identity("7_1_newton", "7.1", "a = m g_a + T + f_c",
            lambda p: _balance(p, MP.one), lambda p: (0,) * 3, "m a = m g_a + T + f_c",
            lambda p: _balance(p, p.mass), remark="as m g_a + T + f_c minus the left side"),
        Identity("7_1_l", "7.1", "L = m v_θ²/2 + m v_φ²/2 + m g_a L0 cosθ",
            lambda p: kinetic(p, dot(speeds(p), speeds(p))), lambda p: _lagrangian(p, *angle_state(p)[:2])),
        Identity("7_1_v", "7.1", "v_x = v_θ cosθ cosφ - v_φ sinφ, v_y = v_θ cosθ sinφ + v_φ cosφ, v_z = v_θ sinθ",
            _velocity, moving_velocity),
        Identity("7_1_theta", "7.1", "dr/dθ = L0 (cosθ cosφ, cosθ sinφ, sinθ)",
            lambda p: p.length * _tangents(p)[0], along(0)),
        Identity("7_1_phi", "7.1", "dr/dφ = L0 (-sinθ sinφ, sinθ cosφ, 0)",
            lambda p: p.length * _tangents(p)[1], along(1)),
        Identity("7_1_l2", "7.1", "L = m L0² θ'²/2 + m L0² sin²θ φ'²/2 + m g_a L0 cosθ",
            lambda p: kinetic(p, p.length**2 * p.cord_rate**2 + p.length**2 * sin(p.cord) ** 2 * p.azimuth_rate**2),
            lambda p: _lagrangian(p, *angle_state(p)[:2])),
        Identity("7_2_general", "7.2", "d(dL/dq)/dt - dL/dq = …",
            _without_prime, lambda p: left_side(p, 0), "d(dL/dq')/dt - dL/dq = …", _theta_side,
            remark="for q = θ; the next two lines are printed with q'"),
        Identity("7_2_theta", "7.2", "m L0² θ'' - m L0² sinθ cosθ φ'² + m g_a L0 sinθ = …",
            _theta_side, lambda p: left_side(p, 0)),
        Identity("7_2_phi", "7.2", "m L0² sin²θ φ'' + 2 m L0² sinθ cosθ θ' φ' = …",
            _phi_side, lambda p: left_side(p, 1)),
        Identity("7_2_work", "7.2", "… = f_cx dx/dq + f_cy dy/dq + f_cz dz/dq",
            lambda p: tuple(dot(coriolis(p), along(i)(p)) for i in (0, 1)),
            lambda p: tuple(left_side(_accelerated(p, angle_accelerations(p)), i) for i in (0, 1)),
            remark="along the accelerations of reference.model.force"),
        *(Identity(f"7_2_f{axis}", "7.2", f"f_{axis} = 2 m (… {wrong} …)",
            force(i, False), component(coriolis, i), f"f_{axis} = 2 m (… {right} …)",
            force(i, True)) for i, (axis, wrong, right) in enumerate(lines)),
        Identity("7_2_theta2", "7.2",
            "θ'' = -g_a/L0 sinθ + sinθ cosθ φ'² + 2 sinθ (cosθ sinλ_a - sinθ sinφ cosλ_a) Ω φ'",
            lambda p: printed_accelerations(p)[0], lambda p: angle_accelerations(p)[0],
            remark="truth: reference.model.force with gravity alone; φ from east to north"),
        Identity("7_2_phi2", "7.2", "φ'' = (-2 cosθ θ'φ' - 2 (cosθ sinλ_a - sinθ sinφ cosλ_a) Ω θ') / sinθ",
            lambda p: printed_accelerations(p)[1], lambda p: angle_accelerations(p)[1]),
        Approximate("7_3_theta", "7.3", "θ'' = -g_a/L0 θ + θ φ'² + 2 θ sinλ_a Ω φ'",
            over(_narrow, component(small_accelerations, 0), component(angle_accelerations, 0)), 1, "θ",
            remark="at a random point"),
        Approximate("7_3_phi", "7.3", "φ'' = (-2 θ'φ' - 2 sinλ_a Ω θ') / θ",
            over(_narrow, component(small_accelerations, 1), component(angle_accelerations, 1)), 1, "θ",
            remark="at a random point"),
        Identity("7_3_first", "7.3", "x'' = L0 θ'' cosφ - …, y'' = L0 θ'' sinφ + … (of x = L0 θ cosφ, y = L0 θ sinφ)",
            _flat_printed, lambda p: derivative(lambda s: _flat(p, s), 0, 2)),
        Identity("7_3_x", "7.3", "x'' = L0 cosφ (…) - … - L0 sinφ (-2θ'φ' - 2Ωθ' sinλ_a)",
            lambda p: _flat_middle(p, 1)[0], lambda p: _flat_solved(p)[0]),
        Identity("7_3_y", "7.3", "y'' = L0 sinφ (…) + … - L0 cosφ (-2θ'φ' - 2Ωθ' sinλ_a)",
            lambda p: _flat_middle(p, -1)[1], lambda p: _flat_solved(p)[1], "the last group has +",
            lambda p: _flat_middle(p, 1)[1]),
        Identity("7_3_end", "7.3", "x'' = -g_a cosφ θ + 2Ω sinλ_a (…), y'' = -g_a sinφ θ - 2Ω sinλ_a (…)",
            _flat_end, _flat_solved),
        Identity("7_3_5", "7.3", "the equations of section 5 again",
            lambda p: coupled(p, _flat(p), derivative(lambda s: _flat(p, s))), _flat_solved),
        Identity("7_3_5b", "7.3", "x'' = -g_a x/L0 + 2y'Ω sinλ_a, y'' = -g_a y/L0 - 2x'Ω sinλ_a",
            coupled_at, linearised),
    )  # fmt: skip
