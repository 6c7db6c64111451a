"""The zeros found in a row, guarded: what they say of its transits and highest points.

A root finder such as heyoka's may lose a zero. A single one shows in the directions, which have to alternate from the
release to the end. Of two close together the rate itself tells, at samples of the run: between two of them it may dip
through zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from ..model.algebra import add, cross, subtract
from ..model.constants import Constants
from ..model.formulations import FORMULATIONS
from ..numbers.precision import Array
from .batch_interface import CLOSE_PAIR, DOUBTFUL, LEAST_BEND, Outcomes, PlumbAxes, Rows

MODEL = FORMULATIONS["momentum"]
TRANSIT, HEIGHT = 0, 1  # kinds of zeros: of xdot, and of the rate of the height over the plumb line
QUIET = 1e-4  # of a swing's period after the release: there heyoka may report the zero at the release
INSIDE = np.arange(1, 8)[:, None] / 8  # of an interval between two samples


@dataclass(frozen=True)
class Zeros:
    """Times of the zeros of a rate, increasing, and its signs after them."""

    times: Array
    directions: Array

    @classmethod
    def of(cls, pairs: Sequence[float]) -> Self:
        """Return zeros from a list of a time, its direction, the next time and so on."""
        times, directions = np.array(pairs, dtype=np.float64).reshape(-1, 2).T
        order = np.argsort(times, kind="stable")
        return cls(times[order], directions[order])

    def __getitem__(self, chosen: Any) -> Self:
        """Return some of the zeros."""
        return type(self)(self.times[chosen], self.directions[chosen])


@dataclass(frozen=True)
class Motion:
    """Position n over l, n' and n'' in the axes of the plumb line, each three numbers or arrays."""

    n: Any
    v: Any
    a: Any

    @classmethod
    def of(cls, state: Any, k: Constants) -> Self:
        """Return the motion in a state; of a small swing the rates of the height keep their digits."""
        n, momentum = (state[0], state[1], state[2]), (state[3], state[4], state[5])
        rates = MODEL.derivatives((*n, *momentum), k, np)
        v, torque = (rates[0], rates[1], rates[2]), (rates[3], rates[4], rates[5])
        return cls(n, v, add(cross(torque, n), cross(subtract(momentum, k.turn), v)))

    def __getitem__(self, chosen: Any) -> Self:
        """Return the motion at some of its times."""
        return type(self)(*(tuple(part[chosen] for part in vector) for vector in (self.n, self.v, self.a)))


@dataclass(frozen=True)
class Release:
    """The release of a row: quantities that follow from its inputs before it is solved.

    Attributes:
        length: of the cord, in m.
        end: of the span, in s.
        rate: of a small swing, in rad/s.
        quiet: seconds after the release in which a zero is that of the release, if it has one by the exact inputs.
        still: whether xdot is zero at all times by the exact inputs.
        zero: of each kind of rate, whether it is exactly zero at the release.
        signs: of each kind of rate just after the release.
        angle: from the plumb line, in rad.
    """

    length: float
    end: float
    rate: float
    quiet: float
    still: bool
    zero: tuple[bool, bool]
    signs: tuple[float, float]
    angle: float

    @classmethod
    def of(cls, rows: Rows, axes: PlumbAxes, row: int, motion: Motion) -> Self:
        """Return what is known of a row whose motion at the release is given."""
        rate, multiplicity, rising = np.sqrt(axes.size.high[row]), rows.zeros_at_release[row], rows.rising[row]
        turn = (0, axes.turn[0].high[row], axes.turn[1].high[row])
        x, p, u = motion.n
        east = (motion.v[0], motion.a[0], -2 * cross(turn, motion.a)[0], -x, -turn[2] * p)[multiplicity]
        return cls(
            length=rows.length[row, 0],
            end=rows.t_end[row, 0],
            rate=rate,
            quiet=QUIET * 2 * np.pi / (rate + axes.speed[row]),
            still=bool(rows.still[row]),
            zero=(multiplicity > 0, rising == 0),
            signs=(np.sign(east), rising or np.sign(motion.a[2]) or 1),  # at rest on the plumb line it can but rise
            angle=np.arctan2(np.hypot(x, p), -u),
        )

    def after(self, zeros: Zeros, kind: int) -> Zeros:
        """Return the zeros of a kind in the span, without that of the release, which it reports at 1e-17 s or so."""
        none = self.still and kind == TRANSIT
        least = np.inf if none else self.quiet if self.zero[kind] else 0.0
        return zeros[(zeros.times > least) & (zeros.times <= self.end)]


@dataclass(frozen=True)
class Samples:
    """A row's motion at times from the release to the end, at equal distances; `at` gives it at others, increasing."""

    times: Array
    motion: Motion
    at: Callable[[Array], Motion]

    def lost(self, zeros: Zeros, sign: float, axis: int) -> bool:
        """Return whether a zero of n' along an axis is not among the zeros; `sign` is its sign after the release."""
        signs = np.concatenate([[sign], zeros.directions, [np.sign(self.motion.v[axis][-1])]])
        alternate = (signs[:-2] * signs[1:-1] < 0).all() and signs[-1] == signs[-2]
        return not alternate or self._dips(zeros, axis)

    def _dips(self, zeros: Zeros, axis: int) -> bool:
        """Return whether n' along an axis goes through zero and back between two samples without zeros between them.

        The cubic through values and slopes says where that may be; there n' itself is asked, and the parabola there.
        """
        rate, slope = self.motion.v[axis], self.motion.a[axis] * self.times[1]
        towards, away = rate * slope < 0, rate * slope > 0
        dips = np.flatnonzero((rate[:-1] * rate[1:] > 0) & towards[:-1] & away[1:])
        dips = dips[np.diff(np.searchsorted(zeros.times, self.times[[dips, dips + 1]]), axis=0)[0] == 0]
        (left, right), (before, after), s = rate[[dips, dips + 1]], slope[[dips, dips + 1]], INSIDE
        cubic = (1 - s) ** 2 * ((1 + 2 * s) * left + s * before) + s**2 * ((3 - 2 * s) * right - (1 - s) * after)
        height = cubic * np.sign(left)
        low = np.flatnonzero(height.min(axis=0) < 0)
        if not len(low):
            return False
        lowest = self.at(self.times[dips[low]] + INSIDE[np.argmin(height[:, low], axis=0), 0] * self.times[1])
        bend = (after - before)[low]
        least = lowest.v[axis] - (lowest.a[axis] * self.times[1]) ** 2 / (2 * bend)
        return bool((least * left[low] <= 0).any())


def describe_transits(
    outcomes: Outcomes, row: int, release: Release, zeros: Zeros, at: Motion, samples: Samples
) -> None:
    """Fill in a row's transits: the zeros, and the motion at them."""
    t, ax = zeros.times, at.a[0]
    if samples.lost(zeros, release.signs[TRANSIT], 0) or (np.sign(ax) != zeros.directions).any():
        outcomes.fate[row] = DOUBTFUL
    outcomes.transits[row] = len(t)
    if len(t):
        outcomes.t_first[row], outcomes.t_last[row] = t[0], t[-1]
        outcomes.least_ax[row] = np.abs(ax).min() * release.length
        outcomes.close_pairs[row] = np.count_nonzero(np.diff(t) < CLOSE_PAIR * 2 * np.pi / release.rate)


def describe_highest_points(
    outcomes: Outcomes, row: int, release: Release, zeros: Zeros, at: Motion, samples: Samples
) -> None:
    """Fill in a row's highest points, the zeros at which the height begins to fall, and its largest angle."""
    high = zeros.directions < 0
    t, fall, (x, p, u) = zeros.times[high], -at.a[2][high], (part[high] for part in at.n)
    across = np.hypot(x, p)
    east, north, up = (part[-1] for part in samples.motion.n)
    ends = max(release.angle, np.arctan2(np.hypot(east, north), -up))
    outcomes.largest_angle[row] = np.max(np.arctan2(across, -u), initial=ends)
    bend = np.min(fall / (release.rate * across) ** 2, initial=np.inf)
    if not (len(t) and release.rate and bend >= LEAST_BEND):
        return
    if samples.lost(zeros, release.signs[HEIGHT], 2):
        outcomes.fate[row] = DOUBTFUL
        return
    azimuth = np.arctan2(p, x)
    outcomes.apsides[row], outcomes.least_bend[row], outcomes.least_fall[row] = len(t), bend, fall.min()
    outcomes.apsis_first[row], outcomes.apsis_last[row] = t[0], t[-1]
    outcomes.turn[row] = azimuth[-1] - azimuth[0] - np.pi * np.sum(np.round(np.diff(azimuth) / np.pi))
