"""A slip in a closed formula: the two rates of a linear model, but products of cosines and sines that are not its own.

A program that solves no equation but prints a formula keeps its rates whatever it does to its coefficients:

    x, y = c1 cos ωt cos βt + c2 cos ωt sin βt + c3 sin ωt cos βt + c4 sin ωt sin βt + c5.

ω and β are fitted to x and y together, the coefficients are linear. No truth is needed, nor rows that are close.
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
from .causes import NAMED, causes_of
from .families import FamilyFit, windows
from .fitted import sized
from .programs import NAMES, Program
from .readings import CauseReading, Reader

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
        return replace(
            self,
            beta=-self.beta,
            coefficients=self.coefficients * np.array([[1], [-1], [1], [-1], [1]]),
        )

    def fit(self, times: Array, right: Program) -> FamilyFit:
        """Return its rates as a fit of theta: of that they give β and ω² alone."""
        theta = right.theta()
        turn, pull = NAMES.index("turn_z"), NAMES.index("pull_z")
        # γ1 γ2 = β² - ω² is the pull of the model whose phasors have these rates
        theta[turn], theta[pull] = self.beta, self.beta**2 - self.omega**2
        by_omega, by_beta = _slopes(times, self.omega, self.beta, self.coefficients)
        pulled = -by_omega / (2 * self.omega)
        turned = by_beta + by_omega * self.beta / self.omega
        slopes = np.column_stack([turned.ravel(), pulled.ravel()]) / math.sqrt(len(times))
        return FamilyFit("linear", theta, self.rest, (turn, pull), slopes)

    def slips(self, program: Program, same: float) -> list[str]:
        """Return what is said of each coefficient that differs by more than `same` from that of a linear model.

        Nothing is said where one is off slightly: an integrator's step does that. The model's own are those of
        e^{-iβt} (z0 cos ωt + (v0 + iβ z0)/ω sin ωt).
        """
        theta = program.theta()
        start, speed = complex(theta[7], theta[8]), complex(theta[9], theta[10])
        push = (speed + 1j * self.beta * start) / self.omega
        model = [start, -1j * start, push, -1j * push, 0j]  # of x and y: real and imaginary part
        size = float(np.abs(self.coefficients).max())

        def number(value: float) -> str:
            return f"{value:.6g}" if abs(value) > SAME * size else "0"

        sentences = []
        for i, name in enumerate("xy"):
            for product, value, both in zip(PRODUCTS, self.coefficients[:, i], model, strict=True):
                right = (both.real, both.imag)[i]
                if abs(value - right) <= same:
                    continue
                if abs(value - right) < SLIGHT * size:
                    return []
                where = f"in the formula of {name}, {product} has {number(value)} m"
                sentences.append(f"{where} where the model has {number(right)} m")
        return sentences


def of_formula(case: FileCase) -> Explanation | None:
    """Return what is known of rows that follow a closed formula with a slip; None if they do not, or with too many."""
    formula = fit_formula(case.rows, case.right)
    if formula is None or formula.rest > case.floor:
        return None
    # rates that have to be fitted are those of equations with a slip, not of a formula
    named = [
        cause for cause in causes_of(case, "linear") if cause.group != "drag" and not cause.free
    ]
    rates = [cause for cause in named if cause.stage in ("gravity", "model", "input")]
    releases = [cause for cause in named if cause.stage == "release"]
    same = max(SAME * float(np.hypot(case.right.x, case.right.y)), 10 * case.rows.noise)
    best: tuple[float, CauseReading, str] | None = None
    for turned in (formula, formula.mirrored):
        fit = turned.fit(case.rows.times, case.right)
        reader = Reader(replace(case.right, kind="linear"), fit, case.floor, fit.rest)
        reading = reader.readings(rates)[0]
        if reading.rest > 2 * case.floor:
            continue
        released = [
            replace(reading, causes=(*reading.causes, cause), program=cause.change(reading.program))
            for cause in releases
        ]
        for likely in (reading, *released):
            slips = turned.slips(likely.program, same)
            price = NAMED * len(slips) + sum(cause.cost for cause in likely.causes)
            if 0 < len(slips) <= MOST and (best is None or price < best[0]):
                best = (
                    price,
                    likely,
                    f"It follows a closed formula with a slip: {'; '.join(slips)}.",
                )
    if best is None:
        return None
    price, reading, text = best
    return replace(
        case.explanation(tuple(sized(case, reading)), formula.rest, formula.rest, price), slip=text
    )


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
