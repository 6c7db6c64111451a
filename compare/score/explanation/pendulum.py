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
from reference.engines.variants import Variants
from reference.model.constants import Constants
from reference.precision import Array

NAMES = (
    "turn_x", "turn_y", "turn_z", "pull_x", "pull_y", "pull_z", "drag", "x", "y", "vx", "vy", "length", "gradient",
    "point_mass",
)  # fmt: skip
STEPS = 8  # Gauss-Newton steps in one window at most
HOPELESS = 0.05  # of the amplitude: what leaves more in a window is not followed to the next
WINDOWS = 8.0  # each window is so many times longer than the one before


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
        turn, pull, drag = theta[0:3], theta[3:6], float(theta[6])
        x, y, vx, vy = theta[7:11]
        length, gradient, point = theta[11:14]
        pointing = point * abs(pull[2]) * length / self.radius if self.radius else 0.0
        own = [gradient * part for part in self.square]
        k = Constants(
            length=float(length),
            turn=tuple(float(part) for part in turn),
            pull=tuple(float(part) for part in pull),
            centrifugal=(own[0] - pointing, own[1] - pointing, own[2], own[3] + 2 * pointing),
            drag=drag,
        )
        below = length * length - x * x - y * y
        rate = float(np.abs(turn).max()) + abs(drag) + math.sqrt(float(np.abs(pull).max()))
        if not below > 0 or not np.isfinite(theta).all() or rate > self.fastest:
            return np.full((len(times), columns), np.nan)
        z = -math.sqrt(below)
        start = np.array([x, y, z, vx, vy, -(x * vx + y * vy) / z]) / length
        lead = times[0] != 0
        try:
            states = self.model.run(start, np.concatenate([[0.0], times]) if lead else times, k)
        except (FoucaultError, ValueError, ArithmeticError):
            return np.full((len(times), columns), np.nan)
        found: Array = states[int(lead) :, :columns]
        return found

    def slopes(self, theta: Array, times: Array, columns: int, free: Sequence[int], scales: Array) -> Array:
        """Return d rows / d theta times `scales`, by central differences, shape (times * columns, free)."""
        found = []
        for i in free:
            ahead, behind = theta.copy(), theta.copy()
            nudge = 1e-5 * scales[i]
            ahead[i] += nudge
            behind[i] -= nudge
            high, low = self.rows(ahead, times, columns), self.rows(behind, times, columns)
            found.append(((high - low) / (2e-5)).ravel())
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
    pendulum: Pendulum, times: Array, rows: Array, guess: Array, scales: Array, free: tuple[int, ...], noise: float
) -> Fit | None:
    """Fit the free numbers by Gauss-Newton, the span growing; None if nothing fits even the first rows."""
    theta, columns = guess.copy(), rows.shape[1]
    ends = [len(times)]
    span = times[-1]
    while span > 0 and ends[-1] > 24:
        span /= WINDOWS
        ends.append(max(16, int(np.searchsorted(times, span)) + 1))
    result = None
    for count in sorted(set(ends)):
        t, seen = times[:count], rows[:count]
        last, slopes = math.inf, None
        for _ in range(STEPS):
            left = (seen - pendulum.rows(theta, t, columns)).ravel()
            size = float(np.linalg.norm(left)) / math.sqrt(count)
            if not math.isfinite(size):
                return result
            if size > last:  # the last step made it worse: take half of it
                theta = theta - change / 2
                change = change / 2
                last *= 1.001
                continue
            settled = size < noise or size > 0.7 * last
            last = size
            if slopes is None or not settled:
                fresh = slopes is None or size > 1e-4 * float(np.abs(seen).max())
                if fresh:
                    slopes = pendulum.slopes(theta, t, columns, free, scales)
                    if not np.isfinite(slopes).all():
                        return result
                    norms = np.linalg.norm(slopes, axis=0)
                    norms[norms == 0] = 1
            if settled and _:
                break
            step = np.linalg.lstsq(slopes / norms, left, rcond=1e-9)[0] / norms
            change = np.zeros_like(theta)
            change[list(free)] = step * scales[list(free)]
            theta = theta + change
        if slopes is None or last > HOPELESS * float(np.abs(seen[:, :2]).max()):
            return result
        result = Fit(theta, last, free, slopes / scales[list(free)] / math.sqrt(count))
    return result
