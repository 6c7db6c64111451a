"""A slip in a closed formula: the two rates of a linear model, but products of cosines and sines that are not its own.

A program that solves no equation but prints a formula keeps its rates whatever it does to its coefficients:

    x, y = c1 cos ωt cos βt + c2 cos ωt sin βt + c3 sin ωt cos βt + c4 sin ωt sin βt + c5.

ω and β are fitted to x and y together, the coefficients are linear. A few of them that are far from the model's are
slips. They are put right in the rows, and what the rows then show of the program passes the tests of a claim.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from reference.numbers.precision import Array

from ..observed.least_squares import gauss_newton, solved
from .case import Explanation, FileCase, FileRows
from .claims import explanation_of
from .families import windows
from .fitted import readings_of
from .programs import Program
from .thresholds import NEEDED

PRODUCTS = ("cos ωt cos βt", "cos ωt sin βt", "sin ωt cos βt", "sin ωt sin βt", "the constant term")
LEAST = 24  # rows, twice the numbers that are fitted
STEPS = 12  # Gauss-Newton steps in one window at most
GAIN = 0.9  # of what was left: a step that leaves more is not taken
WINDOW = 4.0  # ratio of the lengths of one window and the one before
HELD = 1e-9  # of the amplitude: what holds a rate that a window does not show
SAME = 1e-6  # of the amplitude: coefficients that differ by less are one
FLAT = 1e-12  # of the largest: products whose share in the rows is less are not distinguished
MOST = 3  # coefficients that are off
# of the amplitude: a coefficient that is off by less may be so by an integrator's step
SLIGHT = 0.05
RELEASES = (0.0, 1.0, -1.0, 2.0)  # velocities of the release over that of rest against the stars


@dataclass(frozen=True)
class Slip:
    """A coefficient that is not the model's.

    Attributes:
        column: 0 of x, 1 of y.
        product: its number in `PRODUCTS`.
        value: in m.
        right: the model's, in m.
    """

    column: int
    product: int
    value: float
    right: float

    def sentence(self, size: float) -> str:
        """Return what is said of it; numbers that are small beside a size are 0."""
        value, right = (
            number if abs(number) > SAME * size else 0.0 for number in (self.value, self.right)
        )
        where = f"in the formula of {'xy'[self.column]}, {PRODUCTS[self.product]}"
        return f"{where} has {value:.6g} m where the model has {right:.6g} m"


@dataclass(frozen=True)
class Formula:
    """Products of two rates: ω and β in rad/s, coefficients of x and y in m in the order of `PRODUCTS`, shape (5, 2).

    Attributes:
        omega: of the swing.
        beta: of the plane.
        coefficients: of the products.
        rest: root mean square of what the formula leaves, in m.
    """

    omega: float
    beta: float
    coefficients: Array
    rest: float

    @property
    def mirrored(self) -> Formula:
        """The same formula with the other sign of β."""
        signs = np.array([[1], [-1], [1], [-1], [1]])
        return replace(self, beta=-self.beta, coefficients=self.coefficients * signs)

    def slips(self, right: Program, released: float, same: float) -> list[Slip]:
        """Return the coefficients that differ by more than `same` from those of a linear model.

        There are none where one is off slightly: an integrator's step does that. The model's own are those of
        e^{-iβt} (z0 cos ωt + (v0 + iβ z0)/ω sin ωt), whose v0 has a multiple of rest against the stars, -iβ z0.
        """
        start = complex(right.x, right.y)
        speed = complex(right.vx, right.vy) - 1j * self.beta * released * start
        push = (speed + 1j * self.beta * start) / self.omega
        model = np.array([start, -1j * start, push, -1j * push, 0j])
        expected = np.column_stack([model.real, model.imag])
        off = np.abs(self.coefficients - expected)
        if ((off > same) & (off < SLIGHT * np.abs(self.coefficients).max())).any():
            return []
        places = np.argwhere(off > same).tolist()
        return [
            Slip(
                column,
                product,
                float(self.coefficients[product, column]),
                float(expected[product, column]),
            )
            for product, column in places
        ]


def of_formula(case: FileCase) -> Explanation | None:
    """Return what is known of rows that follow a closed formula with a slip; None if they do not, or with too many."""
    formula = fit_formula(case.rows, case.right)
    if formula is None or formula.rest > NEEDED * case.resolution:
        return None
    size = float(np.hypot(case.right.x, case.right.y))
    same = max(SAME * size, 10 * case.rows.noise)
    explanations = []
    for turned in (formula, formula.mirrored):
        for released in RELEASES:
            slips = turned.slips(case.right, released, same)
            if not 0 < len(slips) <= MOST:
                continue
            explanation = _of_slips(case, turned, slips)
            if explanation is not None:
                text = "; ".join(slip.sentence(size) for slip in slips)
                slipped = f"It follows a closed formula with a slip: {text}."
                explanations.append((len(slips), replace(explanation, slip=slipped)))
    return min(explanations, key=lambda pair: pair[0], default=(0, None))[1]


def _of_slips(case: FileCase, formula: Formula, slips: list[Slip]) -> Explanation | None:
    """Return what is known of rows whose slips are put right; None unless all of that is certain."""
    basis = _basis(case.rows.times, formula.omega, formula.beta)
    positions = case.rows.plane.copy()
    for slip in slips:
        positions[:, slip.column] += (slip.right - slip.value) * basis[:, slip.product]
    rows = replace(case.rows, positions=positions, cord=None)
    mended = replace(case, rows=rows, truth=case.truth[:, :2])
    explanation, _ = explanation_of(mended, readings_of(mended, stepped=True))
    certain = explanation.causes and len(explanation.known) == len(explanation.causes)
    return explanation if certain and explanation.corrected_m <= case.enough else None


def fit_formula(rows: FileRows, right: Program) -> Formula | None:
    """Return the formula that leaves least, from the rates of the scene's own swing; None if the rows are too few.

    The span grows, so that no turn of the phase is lost. A formula and its mirror image leave as much: one is fitted.
    """
    beta = right.rate * math.sin(math.radians(right.latitude))
    if len(rows.times) < LEAST or not right.g or not beta:
        return None
    times, plane = rows.times, rows.plane
    rates, left = np.array([math.sqrt(right.g / right.length), -abs(beta)]), math.inf
    hold = HELD * float(np.abs(plane).max())
    for count in windows(times, WINDOW, LEAST, LEAST):
        model = partial(_left, times[:count], plane[:count], hold * math.sqrt(count))
        rates, left = gauss_newton(model, rates, steps=STEPS, gain=GAIN)
        if not math.isfinite(left):
            return None
    omega, beta = rates.tolist()
    return Formula(
        omega, beta, solved(_basis(times, omega, beta), plane, FLAT), left / math.sqrt(len(times))
    )


def _basis(times: Array, omega: float, beta: float) -> Array:
    a, b = omega * times, beta * times
    ca, sa, cb, sb = np.cos(a), np.sin(a), np.cos(b), np.sin(b)
    return np.column_stack([ca * cb, ca * sb, sa * cb, sa * sb, np.ones_like(times)])


def _slopes(times: Array, omega: float, beta: float, coefficients: Array) -> Iterator[Array]:
    """Yield d rows / d ω and d rows / d β, each of shape (rows, 2)."""
    cc, cs, sc, ss, constant = _basis(times, omega, beta).T
    zero = np.zeros_like(constant)
    for changed in ([-sc, -ss, cc, cs, zero], [-cs, cc, -ss, sc, zero]):
        yield times[:, None] * (np.column_stack(changed) @ coefficients)


def _left(
    times: Array, plane: Array, hold: float, rates: Array
) -> tuple[Array, Callable[[], Array]]:
    """Return what products of two rates leave, and its slopes by the rates, each held, then by the coefficients."""
    omega, beta = rates.tolist()
    basis = _basis(times, omega, beta)
    coefficients = solved(basis, plane, FLAT)

    def slopes() -> Array:
        moved = np.column_stack(
            [slope.ravel() for slope in _slopes(times, omega, beta, coefficients)]
        )
        matrix = np.column_stack([moved, np.kron(basis, np.eye(2))])
        return np.vstack([matrix, hold * np.eye(2, matrix.shape[1])])

    return np.concatenate([(plane - basis @ coefficients).ravel(), np.zeros(2)]), slopes
