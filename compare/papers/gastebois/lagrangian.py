"""Gastebois, sections 7.1 and 7.2: the Lagrangian, and Lagrange's equations with the Coriolis force."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from reference.model.force import acceleration

from ..checks import Check, Identity, component
from ..digits import MP, Vector, add, cos, cross, derivative, dot, scale, sin, vector_derivative
from ..first_principles import by_angles, moving
from ..linear import turning
from ..points import Point
from ..section import Section

G = Section("gastebois_", "Gastebois")


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


def _by_theta(p: Point) -> Vector:
    sp, cp, sl, cl = angle_functions(p)
    return cp * cl, cp * sl, sp


def _by_phi(p: Point) -> Vector:
    sp, _, sl, cl = angle_functions(p)
    return -sp * sl, sp * cl, MP.zero


def _velocity(p: Point) -> Vector:
    """Return v_x, v_y, v_z as printed."""
    along, across = speeds(p)
    sp, cp, sl, cl = angle_functions(p)
    return along * cp * cl - across * sl, along * cp * sl + across * cl, along * sp


def _balance(p: Point, by: Any) -> Vector:
    """Return (m g_a + T + f_c) / `by` minus the acceleration."""
    n, v = (scale(1 / p.length, vector) for vector in (by_angles(p, p.cord, p.azimuth), moving_velocity(p)))
    a = acceleration(n, v, p.uniform)
    free = add(scale(p.mass, (MP.zero, MP.zero, -p.gravity)), coriolis(p))
    tension = -p.mass * p.length * dot(v, v) - dot(free, n)  # it keeps the bob on the sphere
    return add(scale(1 / by, add(free, scale(tension, n))), scale(-p.length, a))


def _half(p: Point) -> Any:
    sp, _, _, _ = angle_functions(p)
    return p.length**2 * p.cord_rate**2 + p.length**2 * sp**2 * p.azimuth_rate**2


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


def _true_path(p: Point) -> Point:
    second, turned = angle_accelerations(p)
    return p.but(cord_second=second, azimuth_second=turned)


def _theta_side(p: Point) -> Any:
    sp, cp, *_ = angle_functions(p)
    inertia = p.mass * p.length**2
    turned = inertia * (p.cord_second - sp * cp * p.azimuth_rate**2)
    return turned + p.mass * p.gravity * p.length * sp


def _phi_side(p: Point) -> Any:
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


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    q_slopes = {
        "theta": (lambda p: scale(p.length, _by_theta(p)), 0, "dr/dθ = L0 (cosθ cosφ, cosθ sinφ, sinθ)"),
        "phi": (lambda p: scale(p.length, _by_phi(p)), 1, "dr/dφ = L0 (-sinθ sinφ, sinθ cosφ, 0)"),
    }
    lines = (
        ("x", "v_φ cosθ Ω sinλ_a", "v_φ cosφ Ω sinλ_a"),
        ("y", "v_φ sinθ Ω sinλ_a", "v_φ sinφ Ω sinλ_a"),
        ("z", "- v_φ sinθ Ω cosλ_a", "- v_φ sinφ Ω cosλ_a"),
    )
    return [
        *G.rows(
            Identity("7_1_newton", "7.1", "a = m g_a + T + f_c",
                lambda p: _balance(p, MP.one), lambda p: (MP.zero,) * 3, "m a = m g_a + T + f_c",
                lambda p: _balance(p, p.mass), "as m g_a + T + f_c minus the left side"),
            Identity("7_1_l", "7.1", "L = m v_θ²/2 + m v_φ²/2 + m g_a L0 cosθ",
                lambda p: kinetic(p, dot(speeds(p), speeds(p))),
                lambda p: lagrangian(p, (p.cord, p.azimuth), (p.cord_rate, p.azimuth_rate))),
            Identity("7_1_v", "7.1", "v_x = v_θ cosθ cosφ - v_φ sinφ, v_y = v_θ cosθ sinφ + v_φ cosφ, v_z = v_θ sinθ",
                _velocity, moving_velocity),
            *(Identity(f"7_1_{name}", "7.1", text, printed, along(i)) for name, (printed, i, text) in q_slopes.items()),
            Identity("7_1_l2", "7.1", "L = m L0² θ'²/2 + m L0² sin²θ φ'²/2 + m g_a L0 cosθ",
                lambda p: kinetic(p, _half(p)),
                lambda p: lagrangian(p, (p.cord, p.azimuth), (p.cord_rate, p.azimuth_rate))),
            Identity("7_2_general", "7.2", "d(dL/dq)/dt - dL/dq = …",
                lambda p: without_prime(p, 0), lambda p: left_side(p, 0), "d(dL/dq')/dt - dL/dq = …", _theta_side,
                "for q = θ; the next two lines are printed with q'"),
            Identity("7_2_theta", "7.2", "m L0² θ'' - m L0² sinθ cosθ φ'² + m g_a L0 sinθ = …",
                _theta_side, lambda p: left_side(p, 0)),
            Identity("7_2_phi", "7.2", "m L0² sin²θ φ'' + 2 m L0² sinθ cosθ θ' φ' = …",
                _phi_side, lambda p: left_side(p, 1)),
            Identity("7_2_work", "7.2", "… = f_cx dx/dq + f_cy dy/dq + f_cz dz/dq",
                lambda p: tuple(_generalised(p, i) for i in (0, 1)),
                lambda p: tuple(left_side(_true_path(p), i) for i in (0, 1)),
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
        ),
    ]  # fmt: skip
