"""Forces with wrong terms: the model's acceleration and errors of its coefficients, run on the sphere or linearly.

Near its lowest point the bob's acceleration is nearly linear in x, y and their velocities. A wrong
term is an error of one of these coefficients.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np

from reference import FoucaultError
from reference.engines.heyoka.propagator import AutonomousSystem, Propagator
from reference.engines.trajectory import MAX_STEPS
from reference.model.constants import Constants
from reference.model.force import acceleration
from reference.numbers.precision import DOUBLE, Array

# of each equation, with the units of their coefficients
TERMS = {"1": "m/s²", "x": "1/s²", "y": "1/s²", "vx": "1/s", "vy": "1/s"}
Place = tuple[int, int]  # 0 for the equation of x, 1 for that of y; and the index of a term
PLACES = tuple(itertools.product(range(2), range(len(TERMS))))
_NUDGE = 1e-6  # m, m/s: by which the lowest point is left for a slope
_CONSTANTS = 11  # numbers of turn, pull, centrifugal force's gradient and drag


def model_accelerations(state: Array, k: Constants) -> Array:
    """Return the horizontal acceleration of the full model in m/s², shape (2, rows)."""
    x, y, vx, vy = state / k.length
    z = -np.sqrt(1 - x * x - y * y)
    vz = -(x * vx + y * vy) / z
    ax, ay, _ = acceleration((x, y, z), (vx, vy, vz), k)
    return np.asarray(np.array([ax, ay]) * k.length)


@dataclass(frozen=True)
class WrongForce:
    """A force with some wrong coefficients.

    Attributes:
        k: the constants of the right force.
        kind: sphere, or linear in position and velocity.
        coefficients: their errors by place, in the units of `TERMS`.
    """

    k: Constants
    kind: str
    coefficients: dict[Place, float]

    @property
    def places(self) -> list[Place]:
        """Where the coefficients are."""
        return list(self.coefficients)

    @cached_property
    def linear(self) -> Array:
        """The coefficients of the right force about the lowest point, shape (2, 5)."""
        lowest = np.zeros((4, 1))
        nudges = _NUDGE * np.eye(4)
        after = model_accelerations(lowest + nudges, self.k)
        before = model_accelerations(lowest - nudges, self.k)
        slopes = (after - before) / (2 * _NUDGE)
        return np.hstack([model_accelerations(lowest, self.k), slopes])

    def with_errors(self, errors: Sequence[float]) -> WrongForce:
        """Return the force with other errors of the coefficients, in the order of `places`."""
        return replace(self, coefficients=dict(zip(self.coefficients, errors, strict=True)))

    def rows(self, start: Array, times: Array) -> Array:
        """Return x and y in m from a start x, y, vx, vy on, shape (times, 2); NaN where there is no such motion."""
        terms = self.linear.copy() if self.kind == "linear" else np.zeros((2, len(TERMS)))
        for place, error in self.coefficients.items():
            terms[place] += error
        terms[:, 0] /= self.k.length
        parameters = terms.ravel().tolist()
        if self.kind == "sphere":
            constants = (*self.k.turn, *self.k.pull, *self.k.centrifugal, self.k.drag)
            parameters += map(float, constants)
        start_over_length = (start / self.k.length).tolist()
        propagator = _propagator(self.kind)
        try:
            states = propagator.from_zero(
                start_over_length, times - times[0], parameters, MAX_STEPS
            )
        except (FoucaultError, ValueError, ArithmeticError):
            return np.full((len(times), 2), np.nan)
        return np.asarray(states[:, :2] * self.k.length)


@cache
def _propagator(kind: str) -> Propagator:
    """Return the propagator of x, y, vx, vy over the length.

    The parameters are the coefficients of further terms; on the sphere then turn, pull, centrifugal
    force's gradient and drag.
    """
    count = 2 * len(TERMS)

    def further(equation: int, state: Any, parameters: Any) -> Any:
        """Return the sum of the further terms of an equation."""
        first = equation * len(TERMS)
        constant, *coefficients = parameters[first : first + len(TERMS)]
        for coefficient, variable in zip(coefficients, state, strict=True):
            constant = constant + coefficient * variable
        return constant

    def linear(state: Any, functions: Any, parameters: Any) -> list[Any]:
        ax = further(0, state, parameters)
        ay = further(1, state, parameters)
        return [*state[2:], ax, ay]

    def on_sphere(state: Any, functions: Any, parameters: Any) -> list[Any]:
        x, y, vx, vy = state
        constants = parameters[count:]
        k = Constants(
            turn=tuple(constants[:3]),
            pull=tuple(constants[3:6]),
            centrifugal=tuple(constants[6:10]),
            drag=constants[10],
        )
        z = -functions.sqrt(1.0 - x * x - y * y)
        vz = -(x * vx + y * vy) / z
        ax, ay, _ = acceleration((x, y, z), (vx, vy, vz), k)
        _, _, linear_x, linear_y = linear(state, functions, parameters)
        return [vx, vy, ax + linear_x, ay + linear_y]

    variables = ("x", "y", "vx", "vy")
    if kind == "linear":
        return Propagator(AutonomousSystem(variables, linear, count), DOUBLE)
    return Propagator(AutonomousSystem(variables, on_sphere, count + _CONSTANTS), DOUBLE)
