"""Steps of a linear model whose statements stand one after the other, the second with what the first has changed.

    vx += h (-q x + f vy);  vy += h (-q y - f vx);  x += h vx;  y += h vy

is no named method: the second line has the new vx. One step is a 4 × 4 matrix, and so are the steps from row to row.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference.numbers.precision import Array

from ..observed.least_squares import by_differences, gauss_newton
from .case import FileCase
from .families import windows
from .phasors import Phasors, fit_phasors
from .programs import SphericalPendulum, phasors_of

# statements of one step: v of one axis, x and y of both, and a factor on both velocities; an axis moved between the
# velocities is the same motion
ORDERS = ("vx vy xy", "vy vx xy", "xy vx vy", "xy vy vx")
DAMPED = tuple(f"{order} factor" for order in ORDERS)
# positions with h²/2 a, then velocities with the mean of a before and after, both of the old velocity
VERLET = "verlet"
IN_TURN = "semi-implicit Euler, its velocities updated one after the other, the second with the first one's new value,"
TITLES = {
    "vx": ("in_turn", IN_TURN),
    "vy": ("in_turn", IN_TURN),
    "xy": ("in_turn_drift", f"{IN_TURN} positions first,"),
    "ve": ("leapfrog", "velocity Verlet, both accelerations of the old velocity,"),
}
PHASES = (0.006, 0.02, 0.06, 0.2)  # ωh of a first step
NEWTON = 30  # steps of a fit
GAIN = 0.97  # of what was left: a step that leaves more ends a fit
LEAST = 24  # rows
LARGEST = 50.0  # logarithm of a step in s, either way
MOST_STEPS = 1e5  # from row to row
CLOSE = 10.0  # times the rounding: what a fit may leave, before its steps are a whole number
WHOLE = 0.02  # of a step: how far a whole number of them may be from the spacing of the rows
NEAR = 1e-3  # of the amplitude that a first fit may leave
# of theta, beside the step: turn, pull, drag and place of the release; and its velocity, if it is not the scene's
FITTED = (2, 3, 4, 5, 6, 7, 8)
PUSHED = (*FITTED, 9, 10)


def step_matrix(order: str, theta: Array, h: float) -> Array:
    """Return one step of x, y, vx, vy, 1 as a matrix, shape (5, 5)."""
    length, drag = theta[11], theta[6]
    inside = 0.0 if "factor" in order else -drag
    kicks: dict[str, tuple[int, list[Any]]] = {
        "vx": (2, [theta[5], 0.0, inside, 2 * theta[2], theta[3] * length]),
        "vy": (3, [0.0, theta[5], -2 * theta[2], inside, theta[4] * length]),
        "x": (0, [0.0, 0.0, 1.0, 0.0, 0.0]),
        "y": (1, [0.0, 0.0, 0.0, 1.0, 0.0]),
    }
    matrix = np.eye(5)
    if order == VERLET:
        both = np.array([kicks["vx"][1], kicks["vy"][1]])
        matrix[:2] += h * np.eye(5)[2:4] + h * h / 2 * both
        matrix[2:4] += h / 2 * (both + both @ matrix)
        return matrix
    for statement in order.removesuffix(" factor").replace("xy", "x y").split():
        row, rates = kicks[statement]
        one = np.eye(5)
        one[row] += h * np.array(rates)
        matrix = one @ matrix
    if "factor" in order:
        matrix[2:4] *= 1 - drag * h
    return matrix


def power(matrix: Array, exponent: float) -> Array:
    """Return a power of a matrix, which need not be whole."""
    if exponent == round(exponent):
        return np.asarray(np.linalg.matrix_power(matrix, round(exponent)))
    values, vectors = np.linalg.eig(matrix)
    turned = vectors * values.astype(complex) ** exponent
    return np.asarray(np.linalg.solve(vectors.T, turned.T).T.real)


@dataclass(frozen=True)
class LinearSteps(SphericalPendulum):
    """A linear pendulum that such statements move, from row to row.

    Attributes:
        method: the order of its statements.
        every: number of steps from row to row.
        spacing: of the rows in s.
        near: the theta with which they make the rows, or nearly.
    """

    method: str = ""
    every: float = 1
    spacing: float = 0.0
    near: tuple[float, ...] = ()
    kind: str = "linear"

    def rows(self, theta: Array, times: Array, columns: int) -> Array:
        """Return x and y in m, shape (times, 2)."""
        at = np.round(times / self.spacing).astype(int)
        matrix = step_matrix(self.method, theta, self.spacing / self.every)
        if not (np.isfinite(matrix).all() and self.every < MOST_STEPS):
            return np.full((len(times), 2), np.nan)
        matrix = power(matrix, self.every)
        states = np.array([[theta[7], theta[8], theta[9], theta[10], 1.0]])
        while len(states) <= at[-1]:  # twice as many rows every time
            states = np.concatenate([states, states @ matrix.T])
            matrix = matrix @ matrix
        return np.asarray(states[at, :2])

    @property
    def title(self) -> tuple[str, str]:
        """Its word, and what people call it."""
        return TITLES[self.method[:2]]

    def exact(self, theta: Array, times: Array) -> Array:
        """Return x and y in m as an exact integration has them, shape (times, 2)."""
        plane = phasors_of(theta, -theta[5], complex(theta[7], theta[8])).at(times)
        return np.column_stack([plane.real, plane.imag])


def likely_loops(case: FileCase) -> list[LinearSteps]:
    """Return the statements and steps that make rows of a linear motion, the best first; none for other rows.

    The rows have x and y alone.
    """
    rows, frequency = case.rows, case.frequency
    if len(rows.times) < LEAST or rows.times[0] != 0 or not frequency:
        return []
    spacing = float(rows.times[1])
    even = np.abs(rows.times / spacing - np.round(rows.times / spacing)).max() < 1e-6
    plane = rows.plane @ np.array([1, 1j])
    fitted = fit_phasors(rows.times, plane, frequency) if even else None
    if fitted is None or fitted[1] > NEAR * float(np.abs(plane).max()):
        return []
    slows = abs(fitted[0].drag) * float(rows.times[-1]) > NEAR
    for free in (FITTED, PUSHED):
        for order in (*ORDERS, VERLET, *DAMPED) if slows else (*ORDERS, VERLET):
            for phase in PHASES:
                steps, size = _fitted(case, order, phase / frequency, fitted[0], free)
                if size <= CLOSE * case.resolution and _is_whole(steps.every):
                    return [_whole(steps)]
    return []


def _is_whole(every: float) -> bool:
    return math.isfinite(every) and round(every) > 0 and abs(every - round(every)) < WHOLE


def _whole(steps: LinearSteps) -> LinearSteps:
    return LinearSteps(**(vars(steps) | {"every": max(1, round(steps.every))}))


def _fitted(
    case: FileCase, order: str, step: float, phasors: Phasors, free: tuple[int, ...]
) -> tuple[LinearSteps, float]:
    """Return the steps of an order of statements that make the rows, and what they leave in m.

    Args:
        case: the rows.
        order: of the statements.
        step: a first value, in s.
        phasors: that make the rows nearly.
        free: numbers of theta that are fitted beside the step.
    """
    rows, scales = case.rows, case.scales
    spacing = float(rows.times[1])
    theta = case.right.changed(kind="linear").theta()
    theta[2] = phasors.beta
    theta[5] = -phasors.square.real
    theta[6] = phasors.drag
    numbers = np.append(theta[[*free]] / scales[[*free]], math.log(step))

    def steps_of(numbers: Array) -> LinearSteps:
        moved = theta.copy()
        moved[[*free]] = numbers[:-1] * scales[[*free]]
        every = spacing * math.exp(-max(-LARGEST, min(numbers[-1], LARGEST)))
        known = vars(case.pendulum)
        return LinearSteps(**known, method=order, every=every, spacing=spacing, near=tuple(moved))

    size = math.inf
    for count in windows(rows.times, 4.0, LEAST, LEAST):
        times, goal = rows.times[:count], rows.plane[:count].ravel()

        def rows_of(numbers: Array, times: Array = times) -> Array:
            steps = steps_of(numbers)
            return steps.rows(np.array(steps.near), times, 2).ravel()

        nudges = np.full(len(numbers), 1e-6)
        model = by_differences(rows_of, goal, nudges)
        numbers, left = gauss_newton(model, numbers, steps=NEWTON, gain=GAIN)
        size = left / math.sqrt(count)
    return steps_of(numbers), size
