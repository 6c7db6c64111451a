"""Gastebois, section 7.3: small angles, and back to the equations of section 5."""

from __future__ import annotations

from typing import Any

from ..checks import Approximate, Check, Identity
from ..digits import Vector, cos, sin, vector_derivative
from ..linear import coupled, coupled_at, linearised, rate_up
from ..points import Point, points
from ..section import Section
from .lagrangian import angle_accelerations, angle_functions

G = Section("gastebois_", "Gastebois")


def small_accelerations(p: Point) -> Vector:
    """Return θ'', φ'' for small angles by 7.3."""
    theta, up = p.cord, rate_up(p)
    second = -p.gravity / p.length * theta + theta * p.azimuth_rate**2 + 2 * theta * up * p.azimuth_rate
    return second, (-2 * p.cord_rate * p.azimuth_rate - 2 * up * p.cord_rate) / theta


def _narrow(s: Any) -> Point:
    p = points()[0]
    return p.but(cord=p.cord * s, cord_rate=p.cord_rate * s)


def _flat(p: Point, s: Any = 0) -> Vector:
    """Return x = L0 θ cosφ, y = L0 θ sinφ of small angles, along the point's path."""
    theta = p.cord + p.cord_rate * s + p.cord_second * s * s / 2
    phi = p.azimuth + p.azimuth_rate * s + p.azimuth_second * s * s / 2
    return p.length * theta * cos(phi), p.length * theta * sin(phi)


def _flat_printed(p: Point) -> Vector:
    """Return x'' and y'' in θ, φ of 7.3, first lines."""
    _, _, sl, cl = angle_functions(p)
    length, theta, turn = p.length, p.cord, p.azimuth_rate
    x = length * p.cord_second * cl - 2 * length * p.cord_rate * sl * turn
    y = length * p.cord_second * sl + 2 * length * p.cord_rate * cl * turn
    return (
        x - length * theta * cl * turn**2 - length * theta * sl * p.azimuth_second,
        y - length * theta * sl * turn**2 + length * theta * cl * p.azimuth_second,
    )


def _flat_solved(p: Point) -> Vector:
    """Return x'' and y'' with the small-angle accelerations put in, from the definition of x and y."""
    second, turned = small_accelerations(p)
    solved = p.but(cord_second=second, azimuth_second=turned)
    return vector_derivative(lambda s: _flat(solved, s), 0, 2)


def _flat_middle(p: Point, sign: int) -> Vector:
    """Return x'' and y'' of 7.3, middle lines; `sign` is that of the last group of y''."""
    _, _, sl, cl = angle_functions(p)
    length, theta, turn, up = p.length, p.cord, p.azimuth_rate, rate_up(p)
    pull = -p.gravity / length * theta + theta * turn**2 + 2 * theta * turn * up
    group = -2 * p.cord_rate * turn - 2 * p.cord_rate * up
    x = length * cl * pull - 2 * length * p.cord_rate * sl * turn - length * theta * cl * turn**2 - length * sl * group
    y = length * sl * pull + 2 * length * p.cord_rate * cl * turn - length * theta * sl * turn**2
    return x, y + sign * length * cl * group


def _flat_end(p: Point) -> Vector:
    """Return x'' and y'' of 7.3, last lines in θ, φ."""
    _, _, sl, cl = angle_functions(p)
    length, theta, up = p.length, p.cord, rate_up(p)
    along = length * p.cord_rate * cl - length * theta * sl * p.azimuth_rate
    across = length * p.cord_rate * sl + length * theta * cl * p.azimuth_rate
    return -p.gravity * cl * theta + 2 * up * across, -p.gravity * sl * theta - 2 * up * along


def checks() -> list[Check]:
    """Return the rows, in the order of print."""
    return [
        *G.rows(
            Approximate("7_3_theta", "7.3", "θ'' = -g_a/L0 θ + θ φ'² + 2 θ sinλ_a Ω φ'",
                lambda s: (small_accelerations(_narrow(s))[0], angle_accelerations(_narrow(s))[0]), 1, "θ",
                remark="at a random point"),
            Approximate("7_3_phi", "7.3", "φ'' = (-2 θ'φ' - 2 sinλ_a Ω θ') / θ",
                lambda s: (small_accelerations(_narrow(s))[1], angle_accelerations(_narrow(s))[1]), 1, "θ",
                remark="at a random point"),
            Identity("7_3_first", "7.3",
                "x'' = L0 θ'' cosφ - …, y'' = L0 θ'' sinφ + … (of x = L0 θ cosφ, y = L0 θ sinφ)",
                _flat_printed, lambda p: vector_derivative(lambda s: _flat(p, s), 0, 2)),
            Identity("7_3_x", "7.3", "x'' = L0 cosφ (…) - … - L0 sinφ (-2θ'φ' - 2Ωθ' sinλ_a)",
                lambda p: _flat_middle(p, 1)[0], lambda p: _flat_solved(p)[0]),
            Identity("7_3_y", "7.3", "y'' = L0 sinφ (…) + … - L0 cosφ (-2θ'φ' - 2Ωθ' sinλ_a)",
                lambda p: _flat_middle(p, -1)[1], lambda p: _flat_solved(p)[1], "the last group has +",
                lambda p: _flat_middle(p, 1)[1]),
            Identity("7_3_end", "7.3", "x'' = -g_a cosφ θ + 2Ω sinλ_a (…), y'' = -g_a sinφ θ - 2Ω sinλ_a (…)",
                _flat_end, _flat_solved),
            Identity("7_3_5", "7.3", "the equations of section 5 again",
                lambda p: coupled(p, _flat(p), vector_derivative(lambda s: _flat(p, s))), _flat_solved),
            Identity("7_3_5b", "7.3", "x'' = -g_a x/L0 + 2y'Ω sinλ_a, y'' = -g_a y/L0 - 2x'Ω sinλ_a",
                coupled_at, linearised),
        ),
    ]  # fmt: skip
