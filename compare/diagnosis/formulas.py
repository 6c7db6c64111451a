"""A slip in a closed formula: the two rates of a linear model, with other coefficients.

A program that prints a formula instead of solving an equation keeps its rates, whatever its
coefficients are:

    x, y = c1 cos ωt cos βt + c2 cos ωt sin βt + c3 sin ωt cos βt + c4 sin ωt sin βt + c5.

ω and β are fitted to x and y together, the coefficients are linear. A few coefficients that are far
from the model's are slips. They are corrected in the rows, and whatever else the rows show of the
program has to pass the tests of a claim.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from ..observed.least_squares import gauss_newton, solved
from .case import Explanation, FileCase, FileRows
from .claims import explanation_of, graded
from .families import windows
from .fitted import readings_of
from .hypotheses import Claim
from .programs import Program

_PRODUCTS = (
    "cos ωt cos βt",
    "cos ωt sin βt",
    "sin ωt cos βt",
    "sin ωt sin βt",
    "the constant term",
)
_LEAST = 24  # rows, twice the numbers that are fitted
_STEPS = 12  # Gauss-Newton steps in one window at most
_GAIN = 0.9  # of the residual before it: a step with a larger one is not taken
_WINDOW = 4.0  # ratio of the length of a window to that of the one before
_HELD = 1e-9  # of the amplitude: holds a rate that a window does not determine
_SAME = 1e-6  # of the amplitude: coefficients that differ by less are equal
# of the largest singular value: combinations of products below it are not distinguished
_FLAT = 1e-12
_MOST = 3  # coefficients that are wrong
# of the amplitude: an integrator's step may change a coefficient by less
_SLIGHT = 0.05
_RELEASES = (0.0, 1.0, -1.0, 2.0)  # velocities of the release over that of rest against the stars


@dataclass(frozen=True)
class _Slip:
    """A coefficient that differs from the model's.

    Attributes:
        column: 0 of x, 1 of y.
        product: its index in `_PRODUCTS`.
        value: in m.
        right: the model's, in m.
    """

    column: int
    product: int
    value: float
    right: float

    def sentence(self, size: float) -> str:
        """Return the sentence that reports it; numbers that are small beside a size in m are 0."""
        value = self.value if abs(self.value) > _SAME * size else 0.0
        right = self.right if abs(self.right) > _SAME * size else 0.0
        where = f"in the formula of {'xy'[self.column]}, {_PRODUCTS[self.product]}"
        return f"{where} has {value:.6g} m where the model has {right:.6g} m"


@dataclass(frozen=True)
class _Formula:
    """The products of two rates, with their coefficients.

    Attributes:
        omega: rate of the swing in rad/s.
        beta: rate of the plane in rad/s.
        coefficients: of x and y in m, in the order of `_PRODUCTS`, shape (5, 2).
    """

    omega: float
    beta: float
    coefficients: Array

    def residuals(self, rows: FileRows) -> Array:
        """Return x and y of some rows less its own in m, shape (rows, 2)."""
        return rows.plane - _basis(rows.times, self.omega, self.beta) @ self.coefficients

    @property
    def mirrored(self) -> _Formula:
        """The same formula with the other sign of β."""
        signs = np.array([[1], [-1], [1], [-1], [1]])
        return replace(self, beta=-self.beta, coefficients=self.coefficients * signs)

    def slips(self, right: Program, released: float, same: float) -> list[_Slip]:
        """Return the coefficients that differ by more than `same` from those of a linear model.

        There are none if a coefficient differs slightly: an integrator's step does that. The
        model's own are those of e^{-iβt} (z0 cos ωt + (v0 + iβ z0)/ω sin ωt). Its v0 contains
        `released` times the velocity of rest against the stars, -iβ z0.
        """
        start = complex(right.x, right.y)
        speed = complex(right.vx, right.vy) - 1j * self.beta * released * start
        push = (speed + 1j * self.beta * start) / self.omega
        model = np.array([start, -1j * start, push, -1j * push, 0j])
        expected = np.column_stack([model.real, model.imag])

        difference = np.abs(self.coefficients - expected)
        differs = difference > same
        slightly = difference < _SLIGHT * np.abs(self.coefficients).max()
        if (differs & slightly).any():
            return []
        slips = []
        for product, column in np.argwhere(differs).tolist():
            value = float(self.coefficients[product, column])
            slips.append(_Slip(column, product, value, float(expected[product, column])))
        return slips


@dataclass(frozen=True, eq=False)
class _FormulaClaim(Claim):
    """The claim that rows follow a closed formula.

    Attributes:
        formula: fitted to all rows.
    """

    formula: _Formula

    @property
    def free_numbers(self) -> int:
        """The two rates and all coefficients."""
        return 2 + self.formula.coefficients.size

    def foreseen(self, count: int) -> Array:
        """Return the residuals in m of the formula that is fitted to the first `count` rows."""
        formula = _fit_formula(self.case.part(count).rows, self.case.right)
        if formula is None:
            return np.full_like(self.residuals, np.inf)
        return formula.residuals(self.case.rows)


def of_formula(case: FileCase) -> Explanation | None:
    """Return the explanation of rows that follow a closed formula with a slip.

    None if they do not, or with too many slips.
    """
    flat = case.in_the_plane()
    formula = _fit_formula(flat.rows, flat.right)
    if formula is None:
        return None
    claim = _FormulaClaim(flat, formula.residuals(flat.rows), formula)
    # the residual of a formula is rounding
    if not claim.is_exact:
        return None
    size = float(np.hypot(flat.right.x, flat.right.y))
    same = max(_SAME * size, 10 * flat.rows.noise)
    best: Explanation | None = None
    fewest = _MOST + 1
    for signed in (formula, formula.mirrored):
        for released in _RELEASES:
            slips = signed.slips(flat.right, released, same)
            if not 0 < len(slips) < fewest:
                continue
            explanation = _explanation_with(flat, signed, slips)
            slip = _sentence_on(claim, slips, size)
            if explanation is not None and slip:
                best = replace(explanation, slip=slip)
                fewest = len(slips)
    return best


def _sentence_on(claim: Claim, slips: list[_Slip], size: float) -> str:
    """Return the sentence on slips that pass the tests of a claim; empty if they do not.

    `size` in m is that of the motion.
    """
    text = "; ".join(slip.sentence(size) for slip in slips)
    proposed = Deviation("slip", f"follows a closed formula with a slip: {text}", stage="model")
    slip = graded(claim, proposed, claim.case.error)
    return f"It {slip.text}." if slip is proposed else ""


def _explanation_with(case: FileCase, formula: _Formula, slips: list[_Slip]) -> Explanation | None:
    """Return the explanation of rows with their slips corrected; None unless all is certain."""
    basis = _basis(case.rows.times, formula.omega, formula.beta)
    positions = case.rows.positions.copy()
    for slip in slips:
        positions[:, slip.column] += (slip.right - slip.value) * basis[:, slip.product]
    rows = replace(case.rows, positions=positions)
    corrected = replace(case, rows=rows)
    explanation, _ = explanation_of(corrected, readings_of(corrected, stepped=True))
    certain = explanation.causes and len(explanation.known) == len(explanation.causes)
    return explanation if certain and explanation.explains else None


def _fit_formula(rows: FileRows, right: Program) -> _Formula | None:
    """Return the formula with the smallest residual, starting from the rates of the scene's own swing.

    None if there are too few rows. The span grows, so that no turn of the phase is lost. A formula
    and its mirror image have the same residual: one of them is returned.
    """
    beta = right.rate * math.sin(math.radians(right.latitude))
    if len(rows.times) < _LEAST or not right.g or not beta:
        return None
    times = rows.times
    plane = rows.plane
    rates = np.array([math.sqrt(right.g / right.length), -abs(beta)])
    norm_m = math.inf
    hold = _HELD * float(np.abs(plane).max())
    for count in windows(times, _WINDOW, _LEAST, _LEAST):
        model = partial(_residuals, times[:count], plane[:count], hold * math.sqrt(count))
        rates, norm_m = gauss_newton(model, rates, steps=_STEPS, gain=_GAIN)
        if not math.isfinite(norm_m):
            return None
    omega, beta = rates.tolist()
    coefficients = solved(_basis(times, omega, beta), plane, _FLAT)
    return _Formula(omega, beta, coefficients)


def _basis(times: Array, omega: float, beta: float) -> Array:
    """Return the values of `_PRODUCTS`, shape (times, 5)."""
    cos_swing = np.cos(omega * times)
    sin_swing = np.sin(omega * times)
    cos_turn = np.cos(beta * times)
    sin_turn = np.sin(beta * times)
    products = [
        cos_swing * cos_turn,
        cos_swing * sin_turn,
        sin_swing * cos_turn,
        sin_swing * sin_turn,
        np.ones_like(times),
    ]
    return np.column_stack(products)


def _slopes(times: Array, omega: float, beta: float, coefficients: Array) -> Iterator[Array]:
    """Yield d rows / d ω and d rows / d β, each of shape (rows, 2)."""
    cc, cs, sc, ss, constant = _basis(times, omega, beta).T
    zero = np.zeros_like(constant)
    by_omega = [-sc, -ss, cc, cs, zero]
    by_beta = [-cs, cc, -ss, sc, zero]
    for products in (by_omega, by_beta):
        yield times[:, None] * (np.column_stack(products) @ coefficients)


def _residuals(
    times: Array, plane: Array, hold: float, rates: Array
) -> tuple[Array, Callable[[], Array]]:
    """Return the residuals of products of two rates, and their slopes.

    The slopes are by the rates, each of them held, then by the coefficients.
    """
    omega, beta = rates.tolist()
    basis = _basis(times, omega, beta)
    coefficients = solved(basis, plane, _FLAT)

    def slopes() -> Array:
        columns = [slope.ravel() for slope in _slopes(times, omega, beta, coefficients)]
        by_coefficients = np.kron(basis, np.eye(2))
        matrix = np.column_stack([*columns, by_coefficients])
        return np.vstack([matrix, hold * np.eye(2, matrix.shape[1])])

    residuals = (plane - basis @ coefficients).ravel()
    return np.concatenate([residuals, np.zeros(2)]), slopes
