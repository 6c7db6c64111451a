"""Steps of a linear model as products of matrices: statements in turn, and damped steps of named methods.

    vx += h (-q x + f vy);  vy += h (-q y - f vx);  x += h vx;  y += h vy

is no named method: the second statement has the new vx. One step is a 5 × 5 matrix, for x, y, vx, vy
and 1, and so are the steps from row to row.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from reference.numbers.precision import Array

from ..observed.least_squares import by_differences, gauss_newton, solved
from .case import FileCase, rms
from .phasors import TITLES, Phasors, fit_phasors
from .programs import SphericalPendulum, phasors_of
from .thresholds import NEEDED

# statements of one step: v of one axis, x and y of both; an axis moved between the velocities makes
# the same motion
_ORDERS = ("vx vy xy", "vy vx xy", "xy vx vy", "xy vy vx")
# positions with h²/2 a, then velocities with the mean of a before and after, both with the old
# velocity
_VERLET = "verlet"
# half of the change of the velocities, the positions, the other half
_LEAPFROG = "leapfrog"
# v of both axes at once, everything at once, and by the slopes of Runge-Kutta: named methods, tried here with a
# factor only
_NAMED = {
    "v xy": "semi_implicit_euler",
    "xy v": "semi_implicit_euler_drift",
    "all": "explicit_euler",
    "rk2": "rk2",
    "rk4": "rk4",
}
_RUNGE_KUTTA_ORDERS = {"rk2": 2, "rk4": 4}
# with a factor on both velocities after each step in place of the drag
_DAMPED = tuple(f"{order} factor" for order in (*_ORDERS, _VERLET, _LEAPFROG, *_NAMED))
_EXPLICIT = "both accelerations of the velocity before them,"
_IN_TURN = (
    "semi-implicit Euler, its velocities updated one after the other, "
    "the second with the first one's new value,"
)
_TITLES = {
    "vx": ("in_turn", _IN_TURN),
    "vy": ("in_turn", _IN_TURN),
    "xy": ("in_turn_drift", f"{_IN_TURN} positions first,"),
    "ve": ("leapfrog", f"velocity Verlet, {_EXPLICIT}"),
    "le": ("leapfrog", f"leapfrog, {_EXPLICIT}"),
}
_FINEST = 1e-4  # ωh: the shortest step that is tried
_TRIED = 10  # numbers of steps that are tried at a time
_NEWTON = 8  # Gauss-Newton steps of a fit
_GAIN = 0.9  # of the residual before it: a step with a larger one ends a fit
_LEAST = 24  # rows
_DECAYS = 1e-3  # part by which the amplitude changes: less may be an integrator's
# indices of theta that are fitted with a number of steps: turn, pull, drag and place of the
# release; and its velocity, if it is not the scene's
_FITTED = (2, 3, 4, 5, 6, 7, 8)
_PUSHED = (*_FITTED, 9, 10)


def _step_matrix(order: str, theta: Array, h: float) -> Array:
    """Return one step of x, y, vx, vy, 1 as a matrix, shape (5, 5)."""
    length = theta[11]
    drag = theta[6]
    damping = 0.0 if "factor" in order else -drag
    accelerations = np.array(
        [
            [theta[5], 0.0, damping, 2 * theta[2], theta[3] * length],
            [0.0, theta[5], -2 * theta[2], damping, theta[4] * length],
        ]
    )
    matrix = _matrix_without_factor(order.removesuffix(" factor"), accelerations, h)
    if "factor" in order:
        matrix[2:4] *= 1 - drag * h
    return matrix


def _matrix_without_factor(order: str, accelerations: Array, h: float) -> Array:
    """Return one step without a factor; `accelerations` are the rates of vx and vy, (2, 5)."""
    if order == _VERLET:
        return _verlet(accelerations, h)
    if order == _LEAPFROG:
        return _leapfrog(accelerations, h)

    velocities = np.eye(5)[2:4]
    if order in _RUNGE_KUTTA_ORDERS:
        return _runge_kutta(_RUNGE_KUTTA_ORDERS[order], np.vstack([velocities, accelerations]), h)
    # by statement, the rows of the state that it changes, and the rates by which it does
    statements = {
        "vx": ([2], accelerations[:1]),
        "vy": ([3], accelerations[1:]),
        "v": ([2, 3], accelerations),
        "xy": ([0, 1], velocities),
        "all": ([0, 1, 2, 3], np.concatenate([velocities, accelerations])),
    }
    matrix = np.eye(5)
    for statement in order.split():
        rows, rates = statements[statement]
        update = np.eye(5)
        update[rows] += h * rates
        matrix = update @ matrix
    return matrix


def _verlet(accelerations: Array, h: float) -> Array:
    """Return a step of velocity Verlet."""
    matrix = np.eye(5)
    matrix[:2] += h * np.eye(5)[2:4] + h * h / 2 * accelerations
    matrix[2:4] += h / 2 * (accelerations + accelerations @ matrix)
    return matrix


def _leapfrog(accelerations: Array, h: float) -> Array:
    """Return a step of leapfrog."""
    half_kick = np.eye(5)
    half_kick[2:4] += h / 2 * accelerations
    drift = np.eye(5)
    drift[:2] += h * np.eye(5)[2:4]
    return np.asarray(half_kick @ drift @ half_kick)


def _runge_kutta(order: int, rates: Array, h: float) -> Array:
    """Return a step of a Runge-Kutta method with as many stages as its order, up to 4.

    On a linear model it is the Taylor series of the exact step, up to that order.
    """
    term = np.eye(5)
    matrix = np.eye(5)
    slopes = np.vstack([rates, np.zeros(5)])
    for power in range(1, order + 1):
        term = h / power * slopes @ term
        matrix += term
    return matrix


@dataclass(frozen=True)
class LinearSteps(SphericalPendulum):
    """A linear pendulum that such statements move, with a whole number of steps from row to row.

    Attributes:
        method: the order of its statements.
        steps_per_row: number of steps from row to row.
        spacing_s: time from row to row.
        guess: the theta with which it meets the rows, or nearly.
    """

    method: str = ""
    steps_per_row: int = 1
    spacing_s: float = 0.0
    guess: tuple[float, ...] = ()
    kind: str = "linear"

    @property
    def step_s(self) -> float:
        """Its step."""
        return self.spacing_s / self.steps_per_row

    @property
    def title(self) -> tuple[str, str]:
        """The id of its method, and the name that people use."""
        order = self.method.removesuffix(" factor")
        if order in _NAMED:
            return _NAMED[order], TITLES[_NAMED[order]]
        return _TITLES[order[:2]]

    def rows(self, theta: Array, times: Array, columns: int) -> Array:
        """Return x and y in m, shape (times, 2)."""
        indices = np.round(times / self.spacing_s).astype(int)
        matrix = _step_matrix(self.method, theta, self.step_s)
        if not np.isfinite(matrix).all():
            return np.full((len(times), 2), np.nan)
        matrix = np.linalg.matrix_power(matrix, self.steps_per_row)
        states = np.array([[theta[7], theta[8], theta[9], theta[10], 1.0]])
        while len(states) <= indices[-1]:  # twice as many rows every time
            states = np.concatenate([states, states @ matrix.T])
            matrix = matrix @ matrix
        return np.asarray(states[indices, :2])

    def exact(self, theta: Array, times: Array) -> Array:
        """Return x and y in m of an exact integration, shape (times, 2)."""
        plane = phasors_of(theta, -theta[5], complex(theta[7], theta[8])).at(times)
        return np.column_stack([plane.real, plane.imag])


@dataclass(frozen=True)
class _LoopFit:
    """Steps with the theta that fits best, and the root mean square of their residuals in m."""

    steps: LinearSteps
    residual_m: float


def likely_loops(case: FileCase) -> list[LinearSteps]:
    """Return the statements and steps that make rows of a linear motion, the best first.

    There are none for other rows. The rows have x and y alone.
    """
    phasors = _phasors_of_even_rows(case)
    if phasors is None:
        return []
    orders = [*_ORDERS, _VERLET, _LEAPFROG]
    if abs(phasors.drag) * float(case.rows.times[-1]) > _DECAYS:
        orders += _DAMPED
    for free in (_FITTED, _PUSHED):
        search = _Search(case, phasors, free)
        fits = [search.best(order) for order in orders]
        exact = [fit for fit in fits if fit.residual_m <= NEEDED * case.resolution]
        if exact:
            exact.sort(key=lambda fit: fit.residual_m)
            return [fit.steps for fit in exact]
    return []


def _phasors_of_even_rows(case: FileCase) -> Phasors | None:
    """Return the phasors that make the rows of a linear motion roughly.

    None if there are none, the motion is not linear, or the rows are not evenly spaced from the release on.
    """
    times = case.rows.times
    if len(times) < _LEAST or times[0] != 0 or not case.frequency:
        return None
    spacings = times / float(times[1])
    if not np.abs(spacings - np.round(spacings)).max() < 1e-6:
        return None
    if not _is_linear(case):
        return None
    plane = case.rows.plane @ np.array([1, 1j])
    fit = fit_phasors(times, plane, case.frequency)
    return None if fit is None else fit.phasors


def _is_linear(case: FileCase) -> bool:
    """Return whether x and y of each row are linear in those of the two rows before, as in every linear motion.

    Rows after a gap are left out.
    """
    spacings = np.round(np.diff(case.rows.times) / float(case.rows.times[1]))
    (starts,) = np.nonzero((spacings[:-1] == 1) & (spacings[1:] == 1))
    if len(starts) < _LEAST:
        return False
    plane = case.rows.plane
    before = np.column_stack([plane[starts], plane[starts + 1], np.ones(len(starts))])
    after = plane[starts + 2]
    residuals = after - before @ solved(before, after)
    return rms(residuals) <= NEEDED * case.resolution


@dataclass(frozen=True)
class _Search:
    """A search for the steps that make rows.

    Attributes:
        case: the rows.
        phasors: that make the rows nearly.
        free: indices of theta that are fitted.
    """

    case: FileCase
    phasors: Phasors
    free: tuple[int, ...]

    def best(self, order: str) -> _LoopFit:
        """Return the fit of an order of statements with the number of steps whose residual is smallest."""
        case = self.case
        fits: dict[int, _LoopFit] = {}
        low = 1
        high = max(1, int(float(case.rows.times[1]) * case.frequency / _FINEST))
        while True:
            for count in np.unique(np.geomspace(low, high, _TRIED).round().astype(int)).tolist():
                if count not in fits:
                    fits[count] = self._fitted(order, count)
            best = min(fits, key=lambda count: fits[count].residual_m)
            if fits[best].residual_m <= NEEDED * case.resolution:
                return fits[best]

            # the next numbers lie between the neighbours of the best
            counts = sorted(fits)
            place = counts.index(best)
            low = counts[max(place - 1, 0)]
            high = counts[min(place + 1, len(counts) - 1)]
            if high - low < len(counts) and all(count in fits for count in range(low, high + 1)):
                return fits[best]

    def _fitted(self, order: str, steps_per_row: int) -> _LoopFit:
        """Return the steps of an order of statements, with the numbers of theta that fit best."""
        rows = self.case.rows
        free = [*self.free]
        scales = self.case.scales[free]
        theta = self.case.right.changed(kind="linear").theta()
        theta[2] = self.phasors.beta
        theta[5] = -self.phasors.square.real
        theta[6] = self.phasors.drag
        steps = LinearSteps(
            **vars(self.case.pendulum),
            method=order,
            steps_per_row=steps_per_row,
            spacing_s=float(rows.times[1]),
        )

        def theta_with(numbers: Array) -> Array:
            changed = theta.copy()
            changed[free] = numbers * scales
            return changed

        def rows_with(numbers: Array) -> Array:
            return steps.rows(theta_with(numbers), rows.times, 2).ravel()

        model = by_differences(rows_with, rows.plane.ravel(), np.full(len(free), 1e-6))
        numbers, norm_m = gauss_newton(model, theta[free] / scales, steps=_NEWTON, gain=_GAIN)
        guess = tuple(theta_with(numbers).tolist())
        return _LoopFit(replace(steps, guess=guess), norm_m / math.sqrt(len(rows.times)))
