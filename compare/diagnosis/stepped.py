"""Fixed steps on the sphere, run as a program would: of a length that divides the spacing of the rows.

What the leading error of a step does to a small swing is known; what a step does to a wide one, leaving the sphere on
its way, is not. So the equations of a program are stepped in the same way, and what that does to the rows is taken
from them before they are read.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from reference.engines.heyoka.propagator import compiled
from reference.model.constants import Constants
from reference.model.force import acceleration
from reference.numbers.precision import Array

from ..candidates.candidate import Deviation
from ..observed.least_squares import best_change
from .case import AS_IF, Explanation, FileCase, largest, rms
from .claims import explanation_of
from .families import fit_pendulum
from .fitted import readings_of
from .loops import LinearSteps, likely_loops
from .phasors import METHODS
from .programs import Program, SphericalPendulum
from .readings import CauseReading
from .thresholds import NEEDED

TITLES = {method.id: method.title for method in METHODS}
TITLES["heun"] = TITLES["rk2"]
FINEST = {  # ωh: the shortest step that is tried
    "semi_implicit_euler": 0.004, "semi_implicit_euler_drift": 0.004, "leapfrog": 0.004, "explicit_euler": 0.001,
    "rk2": 0.004, "heun": 0.004, "rk4": 0.02,
}  # fmt: skip
# places of the stages after the first, weights
RUNGE_KUTTA: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "explicit_euler": ((), (1.0,)),
    "rk2": ((1 / 2,), (0.0, 1.0)),
    "heun": ((1.0,), (1 / 2, 1 / 2)),
    "rk4": ((1 / 2, 1 / 2, 1.0), (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
}
LONGEST = 15_000  # steps that are run: of longer files the rows up to there are read
FEWEST = 30  # rows that tell a motion: to have as many, twice as many steps are run
TRIED = 24  # numbers of steps that are run at a time
LEAP, WORTH = 4, 4000  # steps that are compiled as one, and the steps from which that pays
SEARCHED = 8_000  # steps that are run at most where nothing tells how many there are
SWING = 1.5  # periods at the beginning that tell the step
LIKELY = 3  # steps that are tried on all rows
PLAIN = 0.3  # of what no step at all leaves of the first swing
READINGS = 2  # of that motion
STEP_LEFT = 1e-3  # of what the steps do that may be left
ALIKE = 10.0  # times what the likeliest leaves: others that are tried
NEWTON = 2  # times that they are moved before any are taken
# of theta, beside which a step is looked for: turn, pull, drag, place of the release
UNSURE = (2, 3, 4, 5, 6, 7, 8)
State = list[Any]


@dataclass(frozen=True)
class Steps(SphericalPendulum):
    """A pendulum that a method moves, from row to row in a whole number of steps.

    Attributes:
        method: a word of `FINEST`.
        every: number of steps from row to row.
        spacing: of the rows in s.
        near: the theta with which they make the first swing, or none.
    """

    method: str = ""
    every: int = 1
    spacing: float = 0.0
    near: tuple[float, ...] = ()
    kind: str = "sphere"

    @property
    def title(self) -> tuple[str, str]:
        """Its word, and what people call it."""
        return "rk2" if self.method == "heun" else self.method, TITLES[self.method]

    def exact(self, theta: Array, times: Array) -> Array:
        """Return x and y in m as an exact integration has them, shape (times, 2)."""
        return super().rows(theta, times, 2)

    def rows(self, theta: Array, times: Array, columns: int) -> Array:
        """Return x and y in m, shape (times, 2)."""
        return self._at(times, theta[:, None])[:, :, 0]

    def slopes(
        self, theta: Array, times: Array, columns: int, scales: Array, nudges: Array
    ) -> Array:
        """Return d rows / d theta times `scales`, by differences of `nudges` scales, shape (times * 2, 14)."""
        moved = self._at(times, np.column_stack([theta, theta[:, None] + np.diag(nudges * scales)]))
        return np.asarray((moved[:, :, 1:] - moved[:, :, :1]) / nudges).reshape(-1, len(theta))

    def _at(self, times: Array, thetas: Array) -> Array:
        at = np.round(times / self.spacing).astype(int)
        return np.asarray(
            self.all_rows(thetas, np.full(thetas.shape[1], self.every), int(at[-1]))[at]
        )

    def all_rows(self, thetas: Array, every: npt.NDArray[np.int64], count: int) -> Array:
        """Return x and y of row 0, 1, … in m, shape (rows, 2, columns of theta), each in steps of its own."""
        constants = [self.constants(theta) for theta in thetas.T]
        numbers = np.array(
            [[0.0, *k.pull, *k.turn, *k.centrifugal, k.drag] for k in constants]
        ).T.copy()
        numbers[0] = self.spacing / every
        state = np.column_stack([self.start(theta) for theta in thetas.T])
        rows = np.full((count + 1, *state[:2].shape), np.nan)
        rows[0] = state[:2]
        # by row and column, the number of steps that reach it; those that the same number reaches, together
        ends, done = np.arange(1, count + 1)[:, None] * every, 0
        numbers_of_steps, first = np.unique(np.sort(ends, axis=None), return_index=True)
        reached = np.split(np.argsort(ends, axis=None), first[1:])
        step, leap = _steps(self.method, 1), LEAP if numbers_of_steps[-1] >= WORTH else 1
        leaping = _steps(self.method, leap)
        for steps, ended in zip(numbers_of_steps.tolist(), reached, strict=True):
            leaps, more = divmod(steps - done, leap)
            for taken in [leaping] * leaps + [step] * more:
                state = taken(state, pars=numbers)
            row, column = np.divmod(ended, len(every))
            rows[row + 1, :, column], done = state[:2, column].T, steps
        return np.asarray(rows * thetas[11])


def of_steps(case: FileCase, reading: CauseReading | None) -> Explanation | None:
    """Return what is known of rows that such a method made on the sphere; None if none did.

    The numbers of the motion are fitted in these steps; what the steps do to it is taken from the rows.

    Args:
        case: the rows.
        reading: of the rows, its integrator's step known roughly; or None.
    """
    rows = replace(case.rows, positions=np.ascontiguousarray(case.rows.plane), cord=None)
    flat = replace(case, rows=rows, truth=case.truth[:, :2])
    hung = case.right.changed(length=case.rows.cord or case.right.length)
    for loop in likely_loops(flat):
        explanation = _of_steps(flat, loop)
        if explanation is not None:
            return explanation
    explanations = []
    for steps in likely_steps(
        replace(flat, right=hung), None if reading is None else reading.program
    ):
        within = rows.times <= steps.spacing / steps.every * max(
            LONGEST, min(FEWEST * steps.every, 2 * LONGEST)
        )
        explanation = (
            _of_steps(flat.part(int(within.sum())), steps) if within.sum() >= FEWEST else None
        )
        if explanation is not None:
            explanations.append(explanation)
            if all(cause.stage != AS_IF for cause in explanation.causes):
                break
    return min(explanations, key=lambda explanation: explanation.score, default=None)


def _of_steps(case: FileCase, steps: Steps | LinearSteps) -> Explanation | None:
    """Return what is known of rows that some steps made; None if others did."""
    rows = case.rows
    fit = fit_pendulum(case, steps, [np.array(steps.near)])
    if fit is None:
        return None
    theta, best = fit.theta, None
    readings: list[CauseReading] = []
    moved = steps.rows(theta, rows.times, 2)
    for _ in range(READINGS):
        effect, left = moved - steps.exact(theta, rows.times), rms(rows.positions - moved)
        if not left <= max(case.floor, STEP_LEFT * rms(effect)):
            return None
        if best is not None and left <= case.floor:
            break
        seen = replace(case, rows=replace(rows, positions=rows.positions - effect))
        readings = readings_of(seen, stepped=True)
        _, best = explanation_of(seen, readings)
        if best is None or best.reading.program.kind != steps.kind:
            return None
        pendulum, theta = case.pendulum_of(best.reading.program)
        steps = replace(steps, **vars(pendulum))
        moved = steps.rows(theta, rows.times, 2)
    effect = moved - steps.exact(theta, rows.times)
    residuals = rows.positions - moved
    if best is None or not largest(residuals) <= case.enough:
        return None
    # the steps of a linear model are exact: what they leave is rounding, or they are others; and numbers that nobody
    # typed take up what others leave
    most = 1.0 if best.untyped else NEEDED
    if steps.kind == "linear" and not rms(residuals) <= most * case.resolution:
        return None
    seen = replace(case, rows=replace(rows, positions=rows.positions - effect))
    explanation, _ = explanation_of(seen, [replace(best.reading, rest=rms(residuals)), *readings])
    causes = (*explanation.causes, step_cause(steps, effect))
    tested = case.tested(causes, residuals, len(causes))
    return tested if tested.causes else None


def step_cause(steps: Steps | LinearSteps, effect: Array) -> Deviation:
    """Return the cause that a program takes some steps, which have an effect on its rows."""
    step = steps.spacing / steps.every
    word, title = steps.title
    text = f"integrates with {title} at a step of {step:.3g} s"
    return Deviation(f"integrator_{word}", text, largest(effect), "integrator", step, step)


def likely_steps(case: FileCase, near: Program | None) -> list[Steps]:
    """Return methods and steps that the first swing looks like, the likeliest first; none for rows not evenly spaced.

    The rows have x and y alone, the first of them evenly spaced from the release on. Where they are so far apart that
    it takes long to try all, the shortest steps are not tried, or those near a program's step alone.
    """
    rows, frequency = case.rows, case.frequency
    if len(rows.times) < 8 or rows.times[0] != 0 or not frequency:
        return []
    spacing = float(rows.times[1])
    count = max(10, math.ceil(SWING * 2 * math.pi / frequency / spacing))
    even = (
        np.abs(rows.times / spacing - np.round(rows.times / spacing)).max()
        < 1e-6 * rows.times[-1] / spacing
    )
    if not even or len(rows.times) <= count or abs(rows.times[count] / spacing - count) > 1e-6:
        return []
    swing = case.part(count + 1)
    pendulum, right = case.pendulum_of(case.right)
    theta = right
    for _ in range(NEWTON):
        theta, slopes = _nearer(swing, pendulum, theta)
    thetas = np.column_stack([right, theta])
    plain = float(np.linalg.norm(swing.rows.positions - pendulum.rows(theta, swing.rows.times, 2)))
    likely: list[tuple[float, Steps]] = []
    for method in FINEST:
        steps = Steps(**vars(pendulum), method=method, spacing=spacing)
        finest = int(spacing * frequency / FINEST[method])
        low, high = 1, min(finest, SEARCHED // count)
        known = near and near.step and near.method and near.method.id == method
        roughly = round(spacing / near.step) if near and known else 0
        if 0 < roughly <= finest:
            likely.append((0.0, replace(steps, every=roughly, near=tuple(theta))))
            if roughly > high:
                low, high = roughly - TRIED // 4, min(finest, roughly + TRIED // 4)
        likely += _apart(swing, steps, thetas, slopes, low, high)
    likely.sort(key=lambda pair: pair[0])
    least = next((size for size, _ in likely if size), 0.0)
    return [steps for size, steps in likely[:LIKELY] if size < min(PLAIN * plain, ALIKE * least)]


def _nearer(swing: FileCase, pendulum: SphericalPendulum, theta: Array) -> tuple[Array, Array]:
    """Return theta, its unsure numbers moved to where the pendulum leaves less, and the slopes by these in scales."""
    rows, unsure = swing.rows, list(UNSURE)
    slopes = pendulum.slopes(theta, rows.times, 2, swing.scales, np.full(len(theta), 1e-6))[
        :, unsure
    ]
    left = (rows.positions - pendulum.rows(theta, rows.times, 2)).ravel()
    if not (np.isfinite(slopes).all() and np.isfinite(left).all()):
        return theta, np.zeros((len(left), 0))
    nearer = theta.copy()
    nearer[unsure] += swing.scales[unsure] * best_change(slopes, left)
    return nearer, slopes


def _apart(
    swing: FileCase, steps: Steps, thetas: Array, slopes: Array, low: int, high: int
) -> list[tuple[float, Steps]]:
    """Return what numbers of steps from row to row leave, from `low` to `high`: ever closer ones around the best.

    The theta is the one of some that leaves least, moved nearer with every round.
    """
    rows, settled = swing.rows, False
    while low <= high:
        shares = np.linalg.qr(slopes)[0]
        every = np.unique(np.geomspace(low, high, TRIED).round().astype(np.int64))
        together = thetas.repeat(len(every), axis=1), np.tile(every, thetas.shape[1])
        made = steps.all_rows(*together, len(rows.times) - 1)
        left = (rows.positions[:, :, None] - made).reshape(-1, made.shape[2])
        sizes = np.linalg.norm(left - shares @ (shares.T @ left), axis=0)
        which, best = divmod(
            int(np.argmin(np.where(np.isfinite(sizes), sizes, np.inf))), len(every)
        )
        theta, sizes = thetas[:, which], sizes.reshape(-1, len(every))[which]
        near = slice(max(best - 1, 0), best + 2)
        if settled or not np.isfinite(sizes[best]):
            closest = zip(sizes[near].tolist(), every[near].tolist(), strict=True)
            return [
                (size, replace(steps, every=count, near=tuple(theta))) for size, count in closest
            ]
        theta, slopes = _nearer(swing, replace(steps, every=int(every[best])), theta)
        thetas, settled = theta[:, None], high - low < len(every)
        low, high = (low, high) if settled else (int(every[near][0]), int(every[near][-1]))
    return []


@cache
def _steps(method: str, count: int) -> Any:
    """Return steps of a method as machine code: of a state over l, with h, pull, turn, centrifugal, drag as `pars`."""

    def change(state: State, numbers: State) -> State:
        pull, turn, centrifugal = tuple(numbers[1:4]), tuple(numbers[4:7]), tuple(numbers[7:11])
        k = Constants(pull=pull, turn=turn, centrifugal=centrifugal, drag=numbers[11])
        for _ in range(count):
            state = _taken(method, state, numbers[0], k)
        return state

    return compiled(("x", "y", "z", "vx", "vy", "vz"), 12, change)


def _taken(method: str, state: State, h: Any, k: Constants) -> State:
    """Return position and velocity after one step."""

    def rates(state: State) -> State:
        return [*state[3:], *acceleration(tuple(state[:3]), tuple(state[3:]), k)]

    def kicked(state: State, h: Any) -> State:
        return [*state[:3], *_along(state[3:], h, rates(state)[3:])]

    def drifted(state: State) -> State:
        return [*_along(state[:3], h, state[3:]), *state[3:]]

    if method == "semi_implicit_euler":
        return drifted(kicked(state, h))
    if method == "semi_implicit_euler_drift":
        return kicked(drifted(state), h)
    if method == "leapfrog":
        return kicked(drifted(kicked(state, h / 2)), h / 2)
    places, weights = RUNGE_KUTTA[method]
    stages = [rates(state)]
    for place in places:
        stages.append(rates(_along(state, place * h, stages[-1])))
    for weight, stage in zip(weights, stages, strict=True):
        state = _along(state, weight * h, stage) if weight else state
    return state


def _along(state: Sequence[Any], h: Any, rates: Sequence[Any]) -> State:
    return [value + h * rate for value, rate in zip(state, rates, strict=True)]
