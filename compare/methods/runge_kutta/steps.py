"""The step of an explicit Runge-Kutta or Runge-Kutta-Nyström tableau, in the model's generic style."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

from reference.model.algebra import plus, product

from .tableau import NystromTableau, Tableau

Derivatives = Callable[[Sequence[Any]], Sequence[Any]]
Step = Callable[[Sequence[Any], Any, Derivatives], Sequence[Any]]


def runge_kutta(tableau: Tableau) -> Step:
    """Return the step of an explicit Runge-Kutta method."""

    def step(state: Sequence[Any], h: Any, derivatives: Derivatives) -> Sequence[Any]:
        slopes: list[Sequence[Any]] = []
        for row in tableau.a:
            slopes.append(derivatives(moved(state, h, row, slopes)))
        return moved(state, h, tableau.b, slopes)

    return step


def nystrom(tableau: NystromTableau) -> Step:
    """Return the step of an explicit Runge-Kutta-Nyström method, for formulations whose state is (y, y')."""

    def step(state: Sequence[Any], h: Any, derivatives: Derivatives) -> Sequence[Any]:
        half = len(state) // 2
        y, rate = state[:half], state[half:]
        forces: list[Sequence[Any]] = []

        def stage(c: Fraction, position: Sequence[Fraction], velocity: Sequence[Fraction]) -> list[Any]:
            straight = moved(y, 1, (c,), [[product(h, v) for v in rate]])
            bent = [product(h, h, part) for part in combined(position, forces, half)]
            return [*map(plus, straight, bent), *moved(rate, h, velocity, forces)]

        for c, position, velocity in zip(tableau.c, tableau.position, tableau.velocity, strict=True):
            forces.append(derivatives(stage(c, position, velocity))[half:])
        return stage(Fraction(1), tableau.position_weights, tableau.velocity_weights)

    return step


def combined(weights: Sequence[Fraction], slopes: Sequence[Sequence[Any]], size: int) -> list[Any]:
    """Return Σ weight slope for each of `size` components; a slope with weight zero is left out."""
    exact = [0 if weight == 0 else weight for weight in weights]
    return [plus(*(product(w, slope[i]) for w, slope in zip(exact, slopes, strict=True))) for i in range(size)]


def moved(state: Sequence[Any], h: Any, weights: Sequence[Fraction], slopes: Sequence[Sequence[Any]]) -> list[Any]:
    """Return state + h Σ weight slope."""
    return [plus(x, product(h, part)) for x, part in zip(state, combined(weights, slopes, len(state)), strict=True)]
