"""Runge-Kutta and Runge-Kutta-Nyström tableaux in exact fractions, which check their own order conditions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from reference import FoucaultError

from .trees import Matrix, Stages, Vector, worst_residual

EXACT = Fraction(0)


class TableauError(FoucaultError):
    """A tableau does not have the order it claims; `order` is the first condition that fails."""

    def __init__(self, name: str, order: int, residual: Fraction) -> None:
        self.name, self.order, self.residual = name, order, residual
        super().__init__(
            f"{name}: the conditions of order {order} are off by {float(residual):.1e}. Look for a misprint."
        )


@dataclass(frozen=True)
class Tableau:
    """An explicit Runge-Kutta method: Y_i = y + h Σ a_ij f(Y_j), y_new = y + h Σ b_i f(Y_i).

    Attributes:
        name: for messages.
        order: claimed, and checked by all rooted trees up to it.
        a: lower triangle by rows, the first one empty.
        b: weights.
    """

    name: str
    order: int
    a: Matrix
    b: Vector

    @property
    def stages(self) -> int:
        """Evaluations of the right-hand side in a step."""
        return len(self.b)

    def __post_init__(self) -> None:
        c = tuple(sum(row, EXACT) for row in self.a)
        stages = Stages(c, _square(self.a, len(self.b)), ())
        for order in range(1, self.order + 1):
            residual = worst_residual(order, stages, self.b, None)
            if residual:
                raise TableauError(self.name, order, residual)


@dataclass(frozen=True)
class NystromTableau:
    """An explicit Runge-Kutta-Nyström method for y'' = f(y, y') (RKNG: "general", with y' in f).

    Stages Y_i = y + c_i h y' + h² Σ position_ij f_j and Y'_i = y' + h Σ velocity_ij f_j; the step is the same
    with c = 1 and the weights.

    Attributes:
        name: for messages.
        order: claimed in y and y', and checked by all Nyström trees up to it.
        c: nodes.
        velocity: lower triangle by rows, the first one empty.
        position: the same.
        velocity_weights: of the step's y'.
        position_weights: of the step's y.
        tolerance: residual that the conditions may leave, for tables that are printed as decimals.
    """

    name: str
    order: int
    c: Vector
    velocity: Matrix
    position: Matrix
    velocity_weights: Vector
    position_weights: Vector
    tolerance: Fraction = EXACT

    @property
    def stages(self) -> int:
        """Evaluations of the right-hand side in a step."""
        return len(self.c)

    def __post_init__(self) -> None:
        for node, velocity, position in zip(self.c, self.velocity, self.position, strict=True):
            residual = max(abs(sum(velocity, EXACT) - node), abs(sum(position, EXACT) - node * node / 2))
            if residual > self.tolerance:
                raise TableauError(self.name, 2, residual)
        size = len(self.c)
        stages = Stages(self.c, _square(self.velocity, size), _square(self.position, size))
        for order in range(1, self.order + 1):
            residual = worst_residual(order, stages, self.velocity_weights, self.position_weights)
            if residual > self.tolerance:
                raise TableauError(self.name, order, residual)


def fractions(*numbers: str) -> Vector:
    """Return exact numbers from "81/640" or decimals."""
    return tuple(map(Fraction, numbers))


def triangle(*rows: str) -> Matrix:
    """Return rows of exact numbers, which are separated by blanks."""
    return tuple(fractions(*row.split()) for row in rows)


def _square(rows: Sequence[Sequence[Fraction]], stages: int) -> Matrix:
    return tuple((*row, *[EXACT] * (stages - len(row))) for row in rows)
