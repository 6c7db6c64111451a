"""Runge-Kutta and Runge-Kutta-Nyström tableaux in exact fractions, which check their own order by rooted trees.

The Taylor series of the solution and of the method are sums over the same rooted trees (Hairer, Nørsett,
Wanner, Solving Ordinary Differential Equations I, II.14): a vertex is an f, and hangs from the vertex below
it by one of f's arguments, y' (then it is integrated once) or y (twice); a y argument may also end in y'
itself, whose weight is the node c. A method has order p if it integrates every tree of up to p vertices as
the exact solution does. A Runge-Kutta method for y' = f(y) has the trees whose only arguments are y'.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from typing import Any

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


def fractions(row: str) -> Vector:
    """Return exact numbers, which are separated by blanks: fractions such as 81/640, or decimals."""
    return tuple(map(Fraction, row.split()))


def triangle(*rows: str) -> Matrix:
    """Return rows of exact numbers."""
    return tuple(map(fractions, rows))


def _square(rows: Sequence[Sequence[Fraction]], stages: int) -> Matrix:
    return tuple((*row, *[EXACT] * (stages - len(row))) for row in rows)


@dataclass(frozen=True, eq=False)
class Tree:
    """An f with its arguments: trees by way of y', trees by way of y, and the number of y that end in y'."""

    by_velocity: tuple[Tree, ...] = ()
    by_position: tuple[Tree, ...] = ()
    ends: int = 0

    @cached_property
    def order(self) -> int:
        """Power of h that its term in y' has."""
        return 1 + self.ends + sum(t.order for t in self.by_velocity) + sum(t.order + 1 for t in self.by_position)

    @cached_property
    def exact(self) -> Fraction:
        """Its value as a function of time is exact t^(order - 1)."""
        value = Fraction(1)
        for tree in self.by_velocity:
            value *= tree.exact / tree.order
        for tree in self.by_position:
            value *= tree.exact / (tree.order * (tree.order + 1))
        return value


class Stages:
    """Values of trees in every stage of a method, each computed once."""

    def __init__(self, c: Vector, velocity: Matrix, position: Matrix) -> None:
        self._c, self._velocity, self._position = c, velocity, position
        self._known: dict[Tree, Vector] = {}

    def of(self, tree: Tree) -> Vector:
        """Return the value of a tree, shape (stages,)."""
        if tree not in self._known:
            values = [node**tree.ends for node in self._c]
            for matrix, sons in ((self._velocity, tree.by_velocity), (self._position, tree.by_position)):
                for son in sons:
                    inner = self.of(son)
                    values = [value * _dot(row, inner) for value, row in zip(values, matrix, strict=True)]
            self._known[tree] = tuple(values)
        return self._known[tree]


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    return sum((p * q for p, q in zip(a, b, strict=True) if p and q), Fraction(0))


@cache
def trees(order: int, *, second: bool) -> tuple[Tree, ...]:
    """Return all trees of an order; without `second` those of a first-order system."""
    parts: list[tuple[int, str, Any]] = [(1, "end", None)] if second else []
    for smaller in range(1, order):
        parts += [(smaller, "velocity", tree) for tree in trees(smaller, second=second)]
        if second and smaller + 1 < order:
            parts += [(smaller + 1, "position", tree) for tree in trees(smaller, second=second)]

    def choices(remainder: int, first: int) -> Iterator[tuple[int, ...]]:
        if remainder == 0:
            yield ()
        for i in range(first, len(parts)):
            if parts[i][0] <= remainder:
                for others in choices(remainder - parts[i][0], i):
                    yield (i, *others)

    found_trees = []
    for choice in choices(order - 1, 0):
        kinds = [parts[i] for i in choice]
        by_velocity = tuple(tree for _, kind, tree in kinds if kind == "velocity")
        by_position = tuple(tree for _, kind, tree in kinds if kind == "position")
        found_trees.append(Tree(by_velocity, by_position, sum(kind == "end" for _, kind, _ in kinds)))
    return tuple(found_trees)


def worst_residual(order: int, stages: Stages, b: Vector, b_position: Vector | None) -> Fraction:
    """Return the largest violation of the conditions of exactly this order (lower ones are not checked).

    Args:
        order: of the method.
        stages: of the method.
        b: weights of the step's y'.
        b_position: weights of the step's y, whose trees are one order lower; None for a first-order system.
    """
    second = b_position is not None
    residuals = [abs(_dot(b, stages.of(tree)) - tree.exact / tree.order) for tree in trees(order, second=second)]
    if b_position is not None and order > 1:
        for tree in trees(order - 1, second=True):
            expected = tree.exact / (tree.order * (tree.order + 1))
            residuals.append(abs(_dot(b_position, stages.of(tree)) - expected))
    return max(residuals)
