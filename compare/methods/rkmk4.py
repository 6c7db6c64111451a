"""Runge-Kutta-Munthe-Kaas of order 4: n turns by rotations and so stays on the sphere.

n' = ω × n with ω = n × n' is solved in the rotations: n = cay(u) n₀, and u' = dcay⁻¹_u(ω) is a plain vector
equation that the classical tableau solves. The Cayley map is rational, and its inverse differential has three
terms, so that nothing is cut off and nothing is singular. The other half of the state, H or w, is a vector.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from reference.model.algebra import add, cross, dot, plus, product, scale, subtract
from reference.model.constants import Vector, is_zero

from ..rhs.problem import Problem
from .fixed_step import Derivatives, combined, moved, prepare_fixed
from .method import Method, Work
from .rk4 import TABLEAU


def turned(n: Vector, u: Vector) -> Vector:
    """cay(u) n = n + (u × n + u × (u × n) / 2) / (1 + u·u/4): as long as n."""
    if all(map(is_zero, u)):
        return n
    once = cross(u, n)
    bent = add(once, scale(0.5, cross(u, once)))
    return add(n, scale(1 / (1 + product(0.25, dot(u, u))), bent))


def rate_of_u(u: Vector, omega: Vector) -> Vector:
    """dcay⁻¹_u(ω) = ω - u × ω / 2 + (u·ω) u / 4 (Hairer, Lubich, Wanner, Geometric Numerical Integration, IV.8.3)."""
    return add(subtract(omega, scale(0.5, cross(u, omega))), scale(product(0.25, dot(u, omega)), u))


def step(state: Sequence[Any], h: Any, derivatives: Derivatives) -> Sequence[Any]:
    """One step of length h, s."""
    n, rest = _vector(state[:3]), state[3:]
    turns: list[Vector] = []
    rates: list[Sequence[Any]] = []
    for row in TABLEAU.a:
        u = _vector([product(h, part) for part in combined(row, turns, 3)])
        at = turned(n, u)
        found = derivatives((*at, *moved(rest, h, row, rates)))
        turns.append(rate_of_u(u, cross(at, _vector(found[:3]))))
        rates.append(found[3:])
    u = _vector([product(h, part) for part in combined(TABLEAU.b, turns, 3)])
    return (*turned(n, u), *moved(rest, h, TABLEAU.b, rates))


def _vector(parts: Sequence[Any]) -> Vector:
    return (plus(parts[0]), plus(parts[1]), plus(parts[2]))


def prepare(problem: Problem, setting: float) -> Work:
    """Fixed step of `setting` seconds."""
    return prepare_fixed(problem, setting, step, stages=len(TABLEAU.b))


METHOD = Method(
    id="rkmk4",
    title="Runge-Kutta-Munthe-Kaas on the rotations, order 4",
    setting="step",
    ladder=(0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002),
    source="H. Munthe-Kaas, BIT 38 (1998) 92, with the Cayley map",
    licence="this project's",
    prepare=prepare,
    formulations=("momentum", "spin"),
    dense=False,
    requires=("numba",),
    extra="methods",
)
