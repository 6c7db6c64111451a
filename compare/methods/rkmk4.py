"""Runge-Kutta-Munthe-Kaas, order 4, explicit Lie-group method, fixed step, by this project: n stays on the sphere.

n' = ω × n with ω = n × n' is solved in the group of rotations: n = cay(u) n₀, and u' = dcay⁻¹_u(ω)
is an ordinary vector equation, to which the classical tableau applies. The Cayley map is rational,
and its inverse differential has three terms, so that no series is truncated and nothing is
singular. The other half of the state, H or w, is a vector.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from reference.model.algebra import add, cross, dot, plus, product, scale, subtract
from reference.model.constants import Vector, is_zero

from .fixed_step import Derivatives, combined, explicit, fixed_step, moved
from .method import TWO_HUNDRED_STEPS, Family
from .rk4 import TABLEAU


def turned(n: Vector, u: Vector) -> Vector:
    """Return cay(u) n = n + (u × n + u × (u × n) / 2) / (1 + u·u/4), which is as long as n."""
    if all(map(is_zero, u)):
        return n
    once = cross(u, n)
    bent = add(once, scale(0.5, cross(u, once)))
    return add(n, scale(1 / (1 + product(0.25, dot(u, u))), bent))


def rate_of_u(u: Vector, omega: Vector) -> Vector:
    """Return dcay⁻¹_u(ω) = ω - u × ω / 2 + (u·ω) u / 4.

    (Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.8.3.)
    """
    return add(subtract(omega, scale(0.5, cross(u, omega))), scale(product(0.25, dot(u, omega)), u))


def step(state: Sequence[Any], h: Any, derivatives: Derivatives) -> Sequence[Any]:
    """Take one step of h seconds."""
    n, other = _vector(state[:3]), state[3:]
    turns: list[Vector] = []
    rates: list[Sequence[Any]] = []
    for row in TABLEAU.a:
        u = _vector([product(h, part) for part in combined(row, turns, 3)])
        at = turned(n, u)
        slopes = derivatives((*at, *moved(other, h, row, rates)))
        turns.append(rate_of_u(u, cross(at, _vector(slopes[:3]))))
        rates.append(slopes[3:])
    u = _vector([product(h, part) for part in combined(TABLEAU.b, turns, 3)])
    return (*turned(n, u), *moved(other, h, TABLEAU.b, rates))


def _vector(parts: Sequence[Any]) -> Vector:
    return (plus(parts[0]), plus(parts[1]), plus(parts[2]))


METHODS = (
    fixed_step(
        id="rkmk4",
        title="Runge-Kutta-Munthe-Kaas on the rotations, order 4",
        ladder=(0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002),
        source="H. Munthe-Kaas, BIT 38 (1998) 92, with the Cayley map",
        prepare=explicit(step, len(TABLEAU.b)),
        formulations=("momentum", "spin"),
        order=TABLEAU.order,
        family=Family.GEOMETRIC,
        stability=TWO_HUNDRED_STEPS,
    ),
)
