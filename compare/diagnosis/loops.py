"""Steps of a linear model whose statements stand one after the other, the second with what the first has changed.

    vx += h (-q x + f vy);  vy += h (-q y - f vx);  x += h vx;  y += h vy

is no named method: the second line has the new vx. One step is a 4 × 4 matrix, and so are the steps from row to row.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from reference.numbers.precision import Array

from ..observed.least_squares import by_differences, gauss_newton
from .case import FileCase
from .phasors import Phasors, fit_phasors
from .programs import SphericalPendulum, phasors_of
from .thresholds import NEEDED

# statements of one step: v of one axis, x and y of both, and a factor on both velocities; an axis moved between the
# velocities is the same motion
ORDERS = ("vx vy xy", "vy vx xy", "xy vx vy", "xy vy vx")
DAMPED = tuple(f"{order} factor" for order in ORDERS)
# positions with h²/2 a, then velocities with the mean of a before and after, both of the old velocity
VERLET = "verlet"
# half the velocities, the positions, half the velocities again, of what they are by then
LEAPFROG = "leapfrog"
EXPLICIT = "both accelerations of the velocity before them,"
IN_TURN = "semi-implicit Euler, its velocities updated one after the other, the second with the first one's new value,"
TITLES = {
    "vx": ("in_turn", IN_TURN),
    "vy": ("in_turn", IN_TURN),
    "xy": ("in_turn_drift", f"{IN_TURN} positions first,"),
    "ve": ("leapfrog", f"velocity Verlet, {EXPLICIT}"),
    "le": ("leapfrog", f"leapfrog, {EXPLICIT}"),
}
FINEST = 1e-4  # ωh: the shortest step that is tried
TRIED = 10  # numbers of steps that are tried at a time
NEWTON = 8  # steps of a fit
GAIN = 0.9  # of what was left: a step that leaves more ends a fit
LEAST = 24  # rows
NEAR = 1e-3  # of the amplitude that two phasors may leave
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
    if order == LEAPFROG:
        half, drift = np.eye(5), np.eye(5)
        half[2:4] += h / 2 * np.array([kicks["vx"][1], kicks["vy"][1]])
        drift[:2] += h * np.eye(5)[2:4]
        return np.asarray(half @ drift @ half)
    for statement in order.removesuffix(" factor").replace("xy", "x y").split():
        row, rates = kicks[statement]
        one = np.eye(5)
        one[row] += h * np.array(rates)
        matrix = one @ matrix
    if "factor" in order:
        matrix[2:4] *= 1 - drag * h
    return matrix


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
    every: int = 1
    spacing: float = 0.0
    near: tuple[float, ...] = ()
    kind: str = "linear"

    def rows(self, theta: Array, times: Array, columns: int) -> Array:
        """Return x and y in m, shape (times, 2)."""
        at = np.round(times / self.spacing).astype(int)
        matrix = step_matrix(self.method, theta, self.spacing / self.every)
        if not np.isfinite(matrix).all():
            return np.full((len(times), 2), np.nan)
        matrix = np.linalg.matrix_power(matrix, self.every)
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
        fits = [
            _best_number(case, order, fitted[0], free)
            for order in (*ORDERS, VERLET, LEAPFROG, *(DAMPED if slows else ()))
        ]
        exact = [fit for fit in fits if fit[1] <= NEEDED * case.resolution]
        if exact:
            return [steps for steps, _ in sorted(exact, key=lambda fit: fit[1])]
    return []


def _best_number(
    case: FileCase, order: str, phasors: Phasors, free: tuple[int, ...]
) -> tuple[LinearSteps, float]:
    """Return the steps of an order of statements, as many from row to row as leave least, and what they leave in m."""
    fits: dict[int, tuple[LinearSteps, float]] = {}
    low, high = 1, max(1, int(float(case.rows.times[1]) * case.frequency / FINEST))
    while True:
        tried = np.unique(np.geomspace(low, high, TRIED).round().astype(int)).tolist()
        for every in tried:
            if every not in fits:
                fits[every] = _fitted(case, order, every, phasors, free)
        best = min(fits, key=lambda every: fits[every][1])
        known = sorted(fits)
        place = known.index(best)
        low, high = known[max(place - 1, 0)], known[min(place + 1, len(known) - 1)]
        if fits[best][1] <= NEEDED * case.resolution or (
            high - low < len(known) and all(every in fits for every in range(low, high + 1))
        ):
            return fits[best]


def _fitted(
    case: FileCase, order: str, every: int, phasors: Phasors, free: tuple[int, ...]
) -> tuple[LinearSteps, float]:
    """Return some steps with the numbers of theta that make the rows, and what they leave in m.

    Args:
        case: the rows.
        order: of the statements.
        every: number of steps from row to row.
        phasors: that make the rows nearly.
        free: numbers of theta that are fitted.
    """
    rows, scales = case.rows, case.scales[[*free]]
    theta = case.right.changed(kind="linear").theta()
    theta[2] = phasors.beta
    theta[5] = -phasors.square.real
    theta[6] = phasors.drag
    steps = LinearSteps(
        **vars(case.pendulum), method=order, every=every, spacing=float(rows.times[1])
    )

    def theta_with(numbers: Array) -> Array:
        moved = theta.copy()
        moved[[*free]] = numbers * scales
        return moved

    def rows_with(numbers: Array) -> Array:
        return steps.rows(theta_with(numbers), rows.times, 2).ravel()

    nudges = np.full(len(free), 1e-6)
    model = by_differences(rows_with, rows.plane.ravel(), nudges)
    start = theta[[*free]] / scales
    numbers, left = gauss_newton(model, start, steps=NEWTON, gain=GAIN)
    near = tuple(theta_with(numbers).tolist())
    return replace(steps, near=near), left / math.sqrt(len(rows.times))
