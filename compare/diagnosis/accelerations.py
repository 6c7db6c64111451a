"""Accelerations that rows show by numerical differentiation, and the wrong terms that these propose."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reference.model.constants import Constants
from reference.numbers.precision import Array

from ..observed.least_squares import solved
from .forces import PLACES, Place, model_accelerations
from .thresholds import RIVAL

# stencils of order 6 for the first and the second derivative
_FIRST = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
_SECOND = np.array([2, -27, 270, -490, 270, -27, 2]) / 180
_LEAST = 30  # rows that can be differentiated
_USUAL = 0.15  # rad of the swing: step between rows that are differentiated
_FARTHEST = 0.5  # rad of the swing: the largest step
_PROPOSED = 0.02  # of the mean square of the accelerations' errors: the largest residual of terms that are run
_MOST = 3  # terms that are run together
_TRIED = 4  # proposals that are run


def root_mean_square(values: Array) -> float:
    """Return the root mean square of all values."""
    return float(np.sqrt(np.mean(values**2)))


@dataclass(frozen=True)
class MotionOfRows:
    """The motion that rows show.

    Attributes:
        state: x, y, vx, vy in m and m/s, shape (4, rows).
        accelerations: of x and y in m/s², shape (2, rows).
    """

    state: Array
    accelerations: Array

    def errors(self, k: Constants) -> Array:
        """Return the accelerations less those of the model in m/s², shape (2, rows)."""
        return np.asarray(self.accelerations - model_accelerations(self.state, k))


def differentiated(times: Array, plane: Array, swing_rate: float) -> MotionOfRows | None:
    """Return the motion of evenly spaced rows by numerical differentiation.

    None if rows are too few, not evenly spaced, or too far apart for the scene's motion or their
    own. If rows are close to each other only some are used: the others would amplify the rounding.
    """
    if len(times) < _LEAST:
        return None
    steps = np.diff(times)
    is_even = np.ptp(steps) < 1e-6 * steps[0]
    angle = float(steps[0]) * swing_rate
    if not is_even or not angle < _FARTHEST:
        return None
    stride = max(1, min(int(_USUAL / angle), len(times) // _LEAST))
    h = float(steps[0]) * stride
    plane = plane[::stride]
    velocities = _convolved(plane, _FIRST) / h
    accelerations = _convolved(plane, _SECOND) / h**2
    turns_back = h * h * root_mean_square(accelerations) > root_mean_square(plane)
    if turns_back:  # from row to row
        return None
    state = np.vstack([plane[3:-3].T, velocities])
    return MotionOfRows(state, accelerations)


def _convolved(plane: Array, stencil: Array) -> Array:
    """Return a stencil's sums over the rows of x and y, shape (2, rows)."""
    return np.array([np.convolve(column, stencil[::-1], "valid") for column in plane.T])


@dataclass(frozen=True)
class _Proposal:
    """Errors of coefficients, by place, and the mean square of the residuals of the accelerations' errors in m²/s⁴."""

    coefficients: dict[Place, float]
    mean_square: float


def proposed(motion: MotionOfRows, k: Constants) -> list[dict[Place, float]]:
    """Return errors of coefficients that explain the accelerations: of the fewest terms, the likeliest first."""
    errors = motion.errors(k)
    most = _PROPOSED * float(np.mean(errors**2))
    for count in range(1, _MOST + 1):
        sets = itertools.combinations(PLACES, count)
        proposals = [_fit(motion.state, errors, places) for places in sets]
        proposals.sort(key=lambda proposal: proposal.mean_square)
        if proposals[0].mean_square <= most:
            near = RIVAL**2 * proposals[0].mean_square
            likely = [each.coefficients for each in proposals if each.mean_square <= near]
            return likely[:_TRIED]
    return []


def _fit(state: Array, errors: Array, places: Sequence[Place]) -> _Proposal:
    """Return the fit of errors by the terms at some places."""
    basis = np.vstack([np.ones(state.shape[1]), state])
    coefficients: dict[Place, float] = {}
    residuals = errors.copy()
    for equation in range(2):
        terms = [term for where, term in places if where == equation]
        solution = solved(basis[terms].T, errors[equation])
        residuals[equation] -= solution @ basis[terms]
        for term, coefficient in zip(terms, solution.tolist(), strict=True):
            coefficients[equation, term] = coefficient
    return _Proposal(coefficients, float(np.mean(residuals**2)))
