"""Runge-Kutta and Runge-Kutta-Nyström tableaux in exact fractions, which check their own order by rooted trees.

The Taylor series of the solution and of the method are sums over the same rooted trees (Hairer,
Nørsett, Wanner, Solving Ordinary Differential Equations I, II.14): a vertex is an f, and hangs from
the vertex below it by one of f's arguments, y' (then it is integrated once) or y (twice); a y
argument may also end in y' itself, whose weight is the node c. A method has order p if it
integrates every tree of up to p vertices as the exact solution does. A Runge-Kutta method for y' =
f(y) has the trees whose only arguments are y'.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from operator import mul
from typing import Any, NamedTuple

from reference import FoucaultError

EXACT = Fraction(0)

Vector = tuple[Fraction, ...]
Matrix = tuple[Vector, ...]


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

    def __post_init__(self) -> None:
        check_order(self.name, conditions(self.order, [], [(self.a, self.b)]))


@dataclass(frozen=True)
class NystromTableau:
    """An explicit Runge-Kutta-Nyström method for y'' = f(y, y') (RKNG: "general", with y' in f).

    Stages Y_i = y + c_i h y' + h² Σ position_ij f_j and Y'_i = y' + h Σ velocity_ij f_j; the step
    is the same with c = 1 and the weights.

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

    def __post_init__(self) -> None:
        for node, velocity, position in zip(self.c, self.velocity, self.position, strict=True):
            residual = max(
                abs(sum(velocity, EXACT) - node), abs(sum(position, EXACT) - node * node / 2)
            )
            if residual > self.tolerance:
                raise TableauError(self.name, 2, residual)
        ways = [(self.velocity, self.velocity_weights), (self.position, self.position_weights)]
        end = Term(1, Fraction(1), self.c)
        check_order(self.name, conditions(self.order, [end], ways), self.tolerance)


def fractions(row: str) -> Vector:
    """Return exact numbers, which are separated by blanks: fractions such as 81/640, or decimals."""
    return tuple(map(Fraction, row.split()))


def triangle(*rows: str) -> Matrix:
    """Return the rows of a triangle of exact numbers."""
    return tuple(map(fractions, rows))


def parts(table: dict[str, str | list[str]]) -> dict[str, Any]:
    """Return the parts of a tableau that a document holds: lines of numbers, and the rows of triangles."""
    return {
        name: fractions(part) if isinstance(part, str) else triangle(*part)
        for name, part in table.items()
    }


class Term(NamedTuple):
    """A rooted tree, or an argument of f that belongs to one: its power of h, its values in solution and stages.

    Attributes:
        order: of a tree, the power of h that it has in y'; of an argument, what it adds to that.
        exact: factor of the power of time that is its value in the exact solution.
        stages: its value in every stage of the method, over the same power of h.
    """

    order: int
    exact: Fraction
    stages: Vector


def conditions(
    order: int, arguments: Sequence[Term], ways: Sequence[tuple[Matrix, Vector]]
) -> Iterator[Sequence[Fraction]]:
    """Yield the residuals of the conditions of each order from 1 to `order`, one for each tree and way.

    Args:
        order: the last one.
        arguments: those that are no trees: a y that ends in y'.
        ways: how a tree can be an argument, by y' and by y: the method's coefficients in the
            stages, and its weights.
    """
    arguments, residuals = list(arguments), [list[Fraction]() for _ in range(order + len(ways))]
    for power in range(1, order + 1):
        for tree in list(_products(arguments, power - 1, len(ways[0][1]))):
            for twice, (rows, weights) in enumerate(ways):
                exact = tree.exact / (power * (power + 1) ** twice)  # integrated once, or twice
                residuals[power + twice].append(abs(_dot(weights, tree.stages) - exact))
                arguments.append(
                    Term(power + twice, exact, tuple(_dot(row, tree.stages) for row in rows))
                )
        yield residuals[power]


def _products(arguments: Sequence[Term], order: int, stages: int) -> Iterator[Term]:
    """Yield the products of all choices of arguments, the same one repeatedly too, whose orders sum to `order`."""
    if order == 0:
        yield Term(0, Fraction(1), (Fraction(1),) * stages)
    for i, first in enumerate(arguments):
        if first.order <= order:
            for product in _products(arguments[i:], order - first.order, stages):
                yield Term(
                    order,
                    first.exact * product.exact,
                    tuple(map(mul, first.stages, product.stages)),
                )


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    """Return Σ a b; what a row of a lower triangle lacks is zero."""
    return sum((p * q for p, q in zip(a, b, strict=False) if p and q), EXACT)


def check_order(
    name: str, residuals: Iterable[Sequence[Fraction]], tolerance: Fraction = EXACT
) -> None:
    """Raise TableauError if the conditions of an order, from 1 on, are not met."""
    for order, of_order in enumerate(residuals, 1):
        if max(of_order) > tolerance:
            raise TableauError(name, order, max(of_order))
