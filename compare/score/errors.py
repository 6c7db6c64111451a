"""Measure a candidate's errors against the truth, following the IVP test set's conventions.

Candidate and truth may agree to more digits than a double holds: both come as a double and its low
part, and both parts are subtracted.

A candidate whose ellipse is turned by a small angle δθ, and that is late by a small delay δτ,
differs from the truth u = (x, y) - rest by

    δu = δθ (-u_y, u_x) - δτ (ẋ, ẏ),

two unknowns that least squares finds from the rows of about one swing; the candidate's velocities
are not needed. For wide swings the same fit gives the turn about the vertical and the delay that
explain most of the error.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from reference import Golden, Scene, Solution
from reference.dataset.golden import Dense
from reference.errors import counted
from reference.model.constants import constants_in_double
from reference.model.force import energy, rates
from reference.numbers.columns import POSITION, VELOCITY
from reference.numbers.precision import Array

from ..candidates.candidate import COLUMNS, Candidate
from ..observed.least_squares import gauss_newton, power_of_time

_BLOCKS = 48  # parts of the run at most, in each of which turn and delay are fitted
# rows of a run at least: one row has as many equations as unknowns, so that nothing checks the fit
_FEWEST = 3
_ROWS = 12  # rows of a part at least
_MOST_ROWS = 240  # rows of a part that are used at most: more add nothing new
# Gauss-Newton steps: the turn found so far is applied exactly and the fit repeated, for large turns
_TURNS = 4
_EPSILON = 2.0**-52  # of a double: twice the largest rounding
# of doubles, in a drift: 9 in a sum of squares, 10 in h, which is subtracted from another
_ROUNDINGS = 10
# parts of the run; the largest error up to the end of each is a point of the fitted power of time
_ENVELOPES = 40


class Worst(NamedTuple):
    """One number of a candidate: its time in s and column, the truth, what it says, and their difference."""

    t: float
    component: str
    expected: float
    got: float
    difference: float


@dataclass(frozen=True, repr=False)
class SwingErrors:
    """Turn of the swing plane in radians (positive from east to north) and delay in s, for each part of the run."""

    turn: Array
    delay: Array

    def __repr__(self) -> str:
        return f"SwingErrors(largest_turn={self.largest_turn}, largest_delay={self.largest_delay})"

    @property
    def largest_turn(self) -> float | None:
        """Largest turn in radians; None if there were too few rows to fit."""
        return float(np.abs(self.turn).max()) if len(self.turn) else None

    @property
    def largest_delay(self) -> float | None:
        """Largest delay in s; None if there were too few rows to fit."""
        return float(np.abs(self.delay).max()) if len(self.delay) else None


@dataclass(frozen=True, repr=False)
class TrajectoryErrors:
    """A candidate's errors at its own times.

    Attributes:
        t: times in s, shape (rows,).
        components: candidate minus truth per column that the candidate has, in m or m/s.
        position: distance from the truth in m over the position columns that the candidate has,
            shape (rows,); if it has transits alone, the truth's |vx|/ω there, by which the motion
            has to be off.
        truth: at those times.
        bound_m: bound of the error of the truth at these times, in m.
        amplitude_m: the truth's largest distance from the vertical in m, the scale of the digits.
        speed_m_s: the truth's largest speed in m/s, the scale of the digits of velocities.
    """

    t: Array
    components: dict[str, Array]
    position: Array
    truth: Dense
    bound_m: float
    amplitude_m: float
    speed_m_s: float

    def __repr__(self) -> str:
        return f"TrajectoryErrors({counted(len(self.t), 'row')}, max_m={self.max_m:.2g}, rms_m={self.rms_m:.2g})"

    @property
    def max_m(self) -> float:
        """Largest position error in m."""
        return float(self.position.max())

    @property
    def rms_m(self) -> float:
        """Root mean square of the position errors in m."""
        top = self.max_m
        return top * math.sqrt(float(np.mean((self.position / top) ** 2))) if top else 0.0

    @property
    def end_m(self) -> float:
        """Position error at the last row in m."""
        return float(self.position[-1])

    @property
    def digits(self) -> float:
        """-log10 of the largest position error over the amplitude.

        An error below the truth's bound counts as it.
        """
        return -math.log10(max(self.max_m, self.bound_m) / self.amplitude_m)

    @property
    def scd(self) -> float | None:
        """Significant correct digits: -log10 of the largest relative error of any component at the end.

        As in the Test Set for IVP Solvers (Mazzia and Magherini); a component whose truth is 0
        within its bound is left out.
        """
        return self._digits_at_the_end(0.0, 0.0)

    @property
    def mescd(self) -> float | None:
        """Mixed error significant correct digits: -log10 of max |error| / (a + |truth|) over components at the end.

        As in the Test Set for IVP Solvers, where a is atol/rtol; here a is the amplitude, and for
        velocities the largest speed.
        """
        return self._digits_at_the_end(self.amplitude_m, self.speed_m_s)

    def _digits_at_the_end(self, added_m: float, added_m_s: float) -> float | None:
        """Return -log10 of the largest |error| / (added + |truth|) of any component at the last row.

        A truth within its bound counts as 0, and a smaller error than the bound as the bound.
        """
        if "x" not in self.components:
            return None
        ratios: list[float] = []
        for i, name in enumerate(COLUMNS):
            if name not in self.components:
                continue
            is_position = i < 3
            bound = self.bound_m
            if not is_position:
                bound *= self.speed_m_s / self.amplitude_m
            size = added_m if is_position else added_m_s
            truth = abs(float(self.truth.states[-1, i]))
            if truth > bound:
                size += truth
            error = max(abs(float(self.components[name][-1])), bound)
            if size and error:
                ratios.append(error / size)
        return -math.log10(max(ratios)) if ratios else None

    @property
    def worst(self) -> tuple[int, str]:
        """Row and component of the largest error in position."""
        row = int(np.argmax(self.position))
        names = [name for name in self.components if name in POSITION] or [*self.components]
        return row, max(names, key=lambda name: abs(float(self.components[name][row])))

    @property
    def growth_exponent(self) -> float | None:
        """Exponent p of error ∝ t^p, fitted to the errors above the truth's bound.

        None if there are too few rows.
        """
        above = (self.t > 0) & (self.position > self.bound_m)
        if above.sum() < 4 or self.t[above][-1] < 4 * self.t[above][0]:
            return None
        return power_of_time(self.t[above], self.position[above], _ENVELOPES)

    def swing(self, rest: tuple[float, float]) -> SwingErrors:
        """Fit the turn of the swing plane and the delay.

        `rest` is x, y of the rest position in m.
        """
        if "x" not in self.components:
            return SwingErrors(*np.empty((2, 0)))
        error = np.column_stack([self.components["x"], self.components["y"]])
        return swing_errors(self.truth.states, error, rest)


def trajectory_errors(
    candidate: Candidate, truth: Dense, golden: Golden | Solution
) -> TrajectoryErrors:
    """Subtract the truth, evaluated at the candidate's times, from the candidate.

    Args:
        candidate: the trajectory, each number a double and its low part.
        truth: at the candidate's times.
        golden: dataset or solution of the truth; the scales are those of its whole grid, whatever
            the candidate has.
    """
    # the truth is known at the double t; the candidate's row belongs to t + t_low
    t_low = candidate.low.get("t", np.zeros(1))
    slopes = np.column_stack(rates([*truth.states.T], constants_in_double(golden.scene.exact)))
    components = _components(candidate, truth, slopes * t_low[:, None])
    bound_m = truth.bound_m + _linearization_bound_m(slopes, t_low)

    reach_m = max(_reach(golden.x, golden.y), _reach(truth.states[:, 0], truth.states[:, 1]))
    amplitude_m = reach_m or float(golden.scene.exact.length)
    speed_m_s = max(
        float(np.linalg.norm((golden.vx, golden.vy, golden.vz), axis=0).max()),
        float(np.linalg.norm(truth.states.T[3:], axis=0).max()),
    )
    if candidate.positions:
        offsets = [components[name] for name in POSITION if name in components]
        position = np.linalg.norm(offsets, axis=0)
    else:
        position = np.abs(components["vx"]) / (swing_rate(golden.scene, speed_m_s) or math.inf)
    return TrajectoryErrors(
        candidate.t, components, position, truth, bound_m, amplitude_m, speed_m_s
    )


def _components(candidate: Candidate, truth: Dense, later: Array) -> dict[str, Array]:
    """Return candidate minus truth of each column.

    `later` is what the truth changes by up to the candidate's times.
    """
    components = {}
    for i, name in enumerate(COLUMNS):
        if name in candidate.columns:
            low = candidate.low.get(name, 0.0) - truth.low[:, i] - later[:, i]
            # the difference of doubles that agree so far is exact
            components[name] = candidate.columns[name] - truth.states[:, i] + low
    return components


def _linearization_bound_m(slopes: Array, t_low: Array) -> float:
    """Return a bound of what taking the truth as linear over t_low leaves out, in m.

    This is a t_low²/2 (doubled, as a changes meanwhile), and the rounding of v, v t_low and two
    sums with it.
    """
    speeds = np.linalg.norm(slopes[:, :3], axis=1)
    pulls = np.linalg.norm(slopes[:, 3:], axis=1)
    return float((pulls * t_low**2 + 2 * _EPSILON * speeds * np.abs(t_low)).max())


def _reach(x: Array, y: Array) -> float:
    """Return the largest distance from the vertical in m."""
    return float(np.hypot(x, y).max())


def swing_rate(scene: Scene, speed_m_s: float) -> float:
    """Return the rate in rad/s by which an error of vx becomes one of position: of small swings, or of a faster bob."""
    k = constants_in_double(scene.exact)
    return max(math.sqrt(math.hypot(k.pull[1], k.pull[2])), speed_m_s / float(k.length))


def drifts(candidate: Candidate, scene: Scene) -> dict[str, float]:
    """Return the largest |h - h(first row)| (m²/s²; needs velocities and no drag) and the largest ||r| - l| (m).

    Columns are taken as doubles. A drift below the rounding of that computation counts as 0.
    """
    columns = candidate.columns
    k = constants_in_double(scene.exact)
    if "z" not in columns:
        return {}
    n = tuple(columns[name] / k.length for name in POSITION)
    square = n[0] ** 2 + n[1] ** 2 + n[2] ** 2
    # |n| - 1 without cancellation
    stretch = (square - 1) / (np.sqrt(square) + 1)
    reach = math.sqrt(float(square.max()))
    largest = {"length_m": _resolved(stretch * k.length, reach * k.length)}
    if all(name in columns for name in VELOCITY) and not scene.exact.drag:
        v = tuple(columns[name] / k.length for name in VELOCITY)
        h = energy(n, v, k)
        speed = math.sqrt(float((v[0] ** 2 + v[1] ** 2 + v[2] ** 2).max()))
        pull = math.hypot(*k.pull)
        # the terms of h at their largest
        terms = (speed**2 + (float(k.rate) * reach) ** 2) / 2 + pull * reach
        largest["h_m2_s2"] = _resolved(h - h[0], terms * k.length**2)
    return largest


def _resolved(differences: Array, scale: float) -> float:
    """Return the largest of differences of numbers of this scale, 0 if rounding alone may be as large."""
    largest = float(np.abs(differences).max())
    return largest if largest > _ROUNDINGS * _EPSILON * scale else 0.0


def swing_errors(truth: Array, error: Array, rest: tuple[float, float]) -> SwingErrors:
    """Fit turn and delay of a candidate, part by part.

    Args:
        truth: x, y, z, vx, vy, vz in m and m/s, shape (rows, 6).
        error: candidate minus truth in x and y, shape (rows, 2), in m.
        rest: x and y of the rest position in m.
    """
    if len(truth) < _FEWEST:
        return SwingErrors(*np.empty((2, 0)))
    count = max(1, min(_BLOCKS, len(truth) // _ROWS))
    fits = []
    for part in np.array_split(np.arange(len(truth)), count):
        stride = math.ceil(len(part) / _MOST_ROWS)
        sample = part[::stride]
        fits.append(_fit(truth[sample], error[sample], rest))
    return SwingErrors(*np.array(fits).T)


def _fit(truth: Array, error: Array, rest: tuple[float, float]) -> tuple[float, float]:
    """Return turn in radians and delay in s of one part."""
    u = truth[:, :2] - np.array(rest)
    rate = truth[:, 3:5]

    def residuals(unknowns: Array) -> tuple[Array, Callable[[], Array]]:
        turn, delay = unknowns.tolist()
        # written so that nothing cancels
        sin = np.sin(turn)
        cos_minus_1 = -2 * np.sin(turn / 2) ** 2
        change = np.column_stack(
            [cos_minus_1 * u[:, 0] - sin * u[:, 1], sin * u[:, 0] + cos_minus_1 * u[:, 1]]
        )
        turned = u + change
        by_turn = np.column_stack([-turned[:, 1], turned[:, 0]])
        slopes = np.stack([by_turn.ravel(), -rate.ravel()], axis=1)
        return (error - change + delay * rate).ravel(), lambda: slopes

    (turn, delay), _ = gauss_newton(residuals, np.zeros(2), steps=_TURNS, gain=1.0)
    return float(turn), float(delay)


def entry(name: str, value: str, remark: str = "") -> str:
    """Return a line of a score: what it is, how much, and a remark."""
    return f"  {name:19} {value}{f'  ({remark})' if remark else ''}"
