"""A spherical pendulum with a free vector Ω and a free pull: fitted to files that no linear model explains.

Its numbers are those of `theta`: what a program computes with, whatever it calls them. Their best values, and how
sharply the file determines each (`slopes`), are read by `readings`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reference import FoucaultError
from reference.engines.trajectory import Variants
from reference.model.constants import Constants
from reference.numbers.precision import Array

from ...observed.least_squares import best_change

NAMES = (
    "turn_x", "turn_y", "turn_z", "pull_x", "pull_y", "pull_z", "drag", "x", "y", "vx", "vy", "length", "gradient",
    "point_mass",
)  # fmt: skip
STEPS = 16  # Gauss-Newton steps in one window at most
DAMPING = (0.0, 1e-7, 1e-5, 1e-3)  # of steps, after each that fails
SEEN = 1e-6  # of the amplitude: how far a nudge moves the rows, for differences that are linear and not noise
WIDTHS = np.array([1e4] * 3 + [1.0] * 3 + [1.0] + [1.0] * 5 + [3.0] * 2)  # in scales: how far a number may be off
HOPELESS = 0.05  # of the amplitude: what leaves more in a window is not followed to the next
WINDOWS = 8.0  # ratio of the lengths of one window and the one before


@dataclass(frozen=True)
class Pendulum:
    """The spherical pendulum of a `theta`, in the units of the file.

    Attributes:
        model: runs it.
        radius: distance to the centre of a point mass, for its gradient, in m.
        square: xx, yy, yz, zz of the centrifugal force's gradient with gradient = 1, in 1/s².
        fastest: sum of rates in 1/s beyond which nothing is run.
    """

    model: Variants
    radius: float
    square: tuple[float, float, float, float]
    fastest: float = math.inf

    def rows(self, theta: Array, times: Array, columns: int) -> Array:
        """Return x, y (and z) in m, shape (times, columns); NaN where no such motion exists."""
        rate = float(np.abs(theta[0:3]).max()) + abs(theta[6]) + math.sqrt(float(np.abs(theta[3:6]).max()))
        reached = theta[11] ** 2 > theta[7] ** 2 + theta[8] ** 2
        if not reached or not np.isfinite(theta).all() or rate > self.fastest:
            return np.full((len(times), columns), np.nan)
        lead = times[0] != 0
        try:
            span = np.concatenate([[0.0], times]) if lead else times
            states = self.model.run(self.start(theta).tolist(), span, self.constants(theta))
        except (FoucaultError, ValueError, ArithmeticError):
            return np.full((len(times), columns), np.nan)
        found: Array = states[int(lead) :, :columns]
        return found

    def constants(self, theta: Array) -> Constants:
        """Return the constants of the force."""
        length, gradient, point = theta[11:14]
        pointing = point * abs(theta[5]) * length / self.radius if self.radius else 0.0
        own = [gradient * part for part in self.square]
        return Constants(
            length=float(length),
            turn=(float(theta[0]), float(theta[1]), float(theta[2])),
            pull=(float(theta[3]), float(theta[4]), float(theta[5])),
            centrifugal=(own[0] - pointing, own[1] - pointing, own[2], own[3] + 2 * pointing),
            drag=float(theta[6]),
        )

    def start(self, theta: Array) -> Array:
        """Return position and velocity of the release over the length, below the suspension and along the sphere."""
        x, y, vx, vy = theta[7:11]
        z = -math.sqrt(theta[11] ** 2 - x * x - y * y)
        return np.asarray(np.array([x, y, z, vx, vy, -(x * vx + y * vy) / z]) / theta[11])

    def slopes(self, theta: Array, times: Array, columns: int, scales: Array, nudges: Array) -> Array:
        """Return d rows / d theta times `scales`, by differences of `nudges` scales, shape (times * columns, 14)."""
        base = self.rows(theta, times, columns)
        found = []
        for i in range(len(NAMES)):
            ahead = theta.copy()
            ahead[i] += nudges[i] * scales[i]
            found.append(((self.rows(ahead, times, columns) - base) / nudges[i]).ravel())
        return np.column_stack(found)


@dataclass(frozen=True)
class Fit:
    """The best theta of a family, what is left, and how the rows answer to each number.

    Attributes:
        theta: the best values, as `NAMES`.
        rest: root mean square of what is left, in m.
        free: indices of the numbers that were fitted.
        slopes: d rows / d theta for these, over sqrt(rows), so that |slopes @ change| is a root mean square in m.
    """

    theta: Array
    rest: float
    free: tuple[int, ...]
    slopes: Array


def fit_pendulum(
    pendulum: Pendulum, times: Array, rows: Array, guesses: Sequence[Array], scales: Array, noise: float
) -> Fit | None:
    """Fit theta by Gauss-Newton from the best of some guesses, the span growing; None if nothing fits all rows.

    A number that the rows do not determine stays near its guess: it is held there as loosely as `WIDTHS` says.
    """
    ends, span = [len(times)], float(times[-1])
    while span > 0 and ends[-1] > 24:
        span /= WINDOWS
        ends.append(max(16, int(np.searchsorted(times, span)) + 1))
    first, *longer = sorted(set(ends))
    small = np.full(len(NAMES), 1e-6)
    fits = [_in_window(pendulum, times[:first], rows[:first], guess, guess, scales, noise, small) for guess in guesses]
    found, guess = min(zip(fits, guesses, strict=True), key=lambda one: one[0].rest)
    size = float(np.abs(rows[:, :2]).max())
    for count in longer:
        if not found.rest <= HOPELESS * float(np.abs(rows[:count, :2]).max()):
            return None
        answers = np.linalg.norm(found.slopes * scales, axis=0) * WINDOWS
        nudges = np.clip(SEEN * size / np.maximum(answers, 1e-300), 1e-13, 1e-2)
        found = _in_window(pendulum, times[:count], rows[:count], found.theta, guess, scales, noise, nudges)
    return found if found.rest <= HOPELESS * float(np.abs(rows[:, :2]).max()) else None


def _in_window(
    pendulum: Pendulum,
    times: Array,
    rows: Array,
    theta: Array,
    guess: Array,
    scales: Array,
    noise: float,
    nudges: Array,
) -> Fit:
    """Return the best fit of a window: slopes are kept while they serve, a step that fails is tried again, damped."""
    columns, root = rows.shape[1], math.sqrt(len(times))
    slopes, fresh, damping = None, False, list(DAMPING)
    best, least = theta, math.inf
    kept = np.zeros(rows.size)
    for _ in range(STEPS):
        left = (rows - pendulum.rows(theta, times, columns)).ravel()
        size = float(np.linalg.norm(left)) / root
        stuck = not size < 0.5 * least
        if size < least:
            best, least, kept = theta, size, left
        if least < noise:
            break
        if slopes is None or (stuck and not fresh):
            slopes, fresh = pendulum.slopes(best, times, columns, scales, nudges), True
        elif not stuck:
            fresh = False
        elif len(damping) == 1:
            break
        else:
            damping.pop(0)
        if not np.isfinite(slopes).all():
            least = math.inf
            break
        hold = max(noise, 1e-3 * least) * root
        theta = best + scales * _step(slopes, kept, (best - guess) / scales, hold, damping[0])
    if slopes is None:
        slopes = pendulum.slopes(best, times, columns, scales, nudges)
    return Fit(best, least, tuple(range(len(NAMES))), slopes / scales / root)


def _step(slopes: Array, left: Array, off: Array, noise: float, damping: float) -> Array:
    """Return the change of theta in scales that least squares ask for, each number held near its guess."""
    holds = noise / WIDTHS
    return best_change(np.vstack([slopes, np.diag(holds)]), np.concatenate([left, -holds * off]), damping)
