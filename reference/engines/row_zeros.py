"""Transits, passages of a section and highest points of a row, from the zeros that were found, with guards.

A root finder such as heyoka's may lose a zero. A single one that is lost shows in the directions,
which have to alternate from the release to the end. Two close together show in samples of the form:
between two of them it may dip through zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from ..model.algebra import add, cross, dot, minus, plus, scale, subtract
from ..model.constants import Constants
from ..model.formulations import FORMULATIONS
from ..numbers.precision import Array
from .batch_interface import CLOSE_PAIR, DOUBTFUL, LEAST_BEND, Outcomes, PlumbAxes, Rows

MODEL = FORMULATIONS["momentum"]
# kinds of zeros
TRANSIT = 0  # of xdot, or of a section's form
HEIGHT = 1  # of the rate of the height
_RISE = (0, 0, 0, 0, 0, 1, 0)  # the form of that rate
_FINER = 16  # parts of the time between two samples, where a form may dip to zero there
# of a swing's period after the release: there heyoka may report the zero at the release
_QUIET = 1e-4
# of a radian of the swing: how far Newton's step may move a zero of the height's rate
_MOST_LATE = 1e-3


@dataclass(frozen=True)
class RowZeros:
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
class RowMotion:
    """Position n over l, n' and n'' in the axes of the plumb line, each three numbers or arrays."""

    n: Any
    v: Any
    a: Any

    @classmethod
    def of(cls, state: Any, k: Constants) -> Self:
        """Return the motion in a state; the height's rates of a small swing keep their digits."""
        n = (state[0], state[1], state[2])
        momentum = (state[3], state[4], state[5])
        rates = MODEL.derivatives((*n, *momentum), k, np)
        v = (rates[0], rates[1], rates[2])
        torque = (rates[3], rates[4], rates[5])
        a = add(cross(torque, n), cross(subtract(momentum, k.turn), v))
        return cls(n, v, a)

    def form(self, form: Any) -> tuple[Any, Any]:
        """Return a form, as `PlumbAxes.forms` gives it, and its rate."""
        a = form[:3]
        b = form[3:6]
        d = form[6]
        n = (self.n[0], self.n[1], self.n[2] + 1)
        value = minus(plus(dot(a, n), dot(b, self.v)), d)
        rate = plus(dot(a, self.v), dot(b, self.a))
        return value, rate

    def earlier(self, by: Array) -> Self:
        """Return the motion slightly before its times, with n'' unchanged."""
        n = subtract(self.n, scale(by, self.v))
        v = subtract(self.v, scale(by, self.a))
        return type(self)(n, v, self.a)

    def __getitem__(self, chosen: Any) -> Self:
        """Return the motion at some of its times."""
        n = tuple(part[chosen] for part in self.n)
        v = tuple(part[chosen] for part in self.v)
        a = tuple(part[chosen] for part in self.a)
        return type(self)(n, v, a)


@dataclass(frozen=True)
class RowRelease:
    """The release of a row: quantities that follow from its inputs before it is solved.

    Attributes:
        length: of the cord, in m.
        end: of the span, in s.
        rate: of a small swing, in rad/s.
        quiet: seconds after the release in which a zero is that of the release, if it has one by
            the exact inputs.
        still: whether xdot is zero at all times by the exact inputs.
        forms: whose zeros are sought, of each kind.
        zero: of each kind of form, whether it is exactly zero at the release.
        signs: of each kind of form just after the release.
        angle: from the plumb line, in rad.
    """

    length: float
    end: float
    rate: float
    quiet: float
    still: bool
    forms: dict[int, Any]
    zero: dict[int, bool]
    signs: dict[int, float]
    angle: float

    @classmethod
    def of(cls, rows: Rows, axes: PlumbAxes, row: int, motion: RowMotion, form: Any) -> Self:
        """Build from rows and their plumb axes.

        Args:
            rows: the rows.
            axes: their axes.
            row: the number of this one.
            motion: at its release.
            form: whose zeros are the transits, in these axes.
        """
        rate = np.sqrt(axes.size.high[row])
        multiplicity = rows.zeros_at_release[row]
        rising = rows.rising[row]
        x, p, u = motion.n
        turn = (0, axes.turn[0].high[row], axes.turn[1].high[row])
        # by the multiplicity of the zero: a number with the sign of xdot just after the release
        leaving = (motion.v[0], motion.a[0], -2 * cross(turn, motion.a)[0], -x, -turn[2] * p)
        return cls(
            length=rows.length[row, 0],
            end=rows.t_end[row, 0],
            rate=rate,
            quiet=_QUIET * 2 * np.pi / (rate + axes.speed[row]),
            still=bool(rows.still[row]),
            forms={TRANSIT: form, HEIGHT: _RISE},
            zero={TRANSIT: multiplicity > 0, HEIGHT: rising == 0},
            signs={
                TRANSIT: rows.leaves[row] or np.sign(leaving[multiplicity]),
                HEIGHT: rising or np.sign(motion.a[2]) or 1,  # at rest the bob can only rise
            },
            angle=np.arctan2(np.hypot(x, p), -u),
        )

    def after(self, zeros: RowZeros, kind: int) -> RowZeros:
        """Return the zeros of a kind in the span, without that of the release.

        heyoka reports that one at 1e-17 s or so.
        """
        least = 0.0
        if self.still and kind == TRANSIT:
            least = np.inf
        elif self.zero[kind]:
            least = self.quiet
        return zeros[(zeros.times > least) & (zeros.times <= self.end)]


@dataclass(frozen=True)
class FoundZeros:
    """The zeros of one kind that were found in a row, and the motion at them.

    Attributes:
        kind: `TRANSIT` or `HEIGHT`.
        release: the row's release.
        zeros: the zeros.
        at: the motion at them.
    """

    kind: int
    release: RowRelease
    zeros: RowZeros
    at: RowMotion

    @property
    def form(self) -> Any:
        """The form whose zeros they are."""
        return self.release.forms[self.kind]

    @property
    def signs(self) -> Array:
        """Signs of the form just after the release and after each zero, shape (zeros + 1,)."""
        return np.append(self.release.signs[self.kind], self.zeros.directions)


@dataclass(frozen=True)
class Samples:
    """A row's motion at times from the release to the end."""

    times: Array
    motion: RowMotion

    def lost(self, found: FoundZeros) -> bool:
        """Return whether zeros may have been missed."""
        signs = found.signs
        if not (signs[:-1] * signs[1:] < 0).all():
            return True
        expected = signs[np.searchsorted(found.zeros.times, self.times[1:])]
        values, _ = self.motion.form(found.form)
        if not (values[1:] * expected > 0).all():
            return True
        starts, _ = self._dips(found)
        return bool(starts.size)

    def finer(self, found: FoundZeros) -> Array:
        """Return the times of samples, with additional ones where the form may reach zero."""
        starts, ends = self._dips(found)
        between = np.linspace(starts, ends, _FINER + 1)[1:-1]
        return np.union1d(self.times, between)

    def _dips(self, found: FoundZeros) -> tuple[Array, Array]:
        """Return neighbours among samples and zeros between which a form may dip through zero.

        The cubic through the values and slopes there says how low the minimum between them is, but
        for its error: that of u' = A sin 2ωt is below A (2ωh)⁴/384.
        """
        # many names, as each is a quantity of one formula
        release = found.release
        zeros = found.zeros
        values, slopes = self.motion.form(found.form)
        _, slopes_at_zeros = found.at.form(found.form)
        tolerance = np.abs(values).max()  # A

        # samples and zeros in the order of time
        times = np.append(self.times, zeros.times)
        order = np.argsort(times, kind="stable")
        times = times[order]
        values = np.append(values, 0 * zeros.times)[order]
        slopes = np.append(slopes, slopes_at_zeros)[order]
        is_zero = order >= len(self.times)
        sign = found.signs[np.cumsum(is_zero)[:-1]]  # between neighbours

        # the cubic between neighbours, of s from 0 to 1, with the sign that makes it positive
        length = np.diff(times)
        left = sign * values[:-1]
        right = sign * values[1:]
        left_slope = sign * slopes[:-1] * length
        right_slope = sign * slopes[1:] * length
        if release.zero[found.kind]:
            left[0] = 0
            left_slope[0] = max(left_slope[0], 0)
        between = 3 * (right - left) - left_slope - right_slope
        root = np.sqrt(between**2 - left_slope * right_slope)
        s = left_slope / (left_slope - between - root)  # of the minimum
        least = (1 - s) ** 2 * ((1 + 2 * s) * left + s * left_slope)
        least = least + s**2 * ((3 - 2 * s) * right - (1 - s) * right_slope)

        error = tolerance * (2 * release.rate * length) ** 4 / 384
        may_dip = (s > 0) & (s < 1) & (least < error)
        return times[:-1][may_dip], times[1:][may_dip]


def describe_transits(outcomes: Outcomes, row: int, found: FoundZeros, samples: Samples) -> None:
    """Fill in a row's transits: the zeros, and the motion at them."""
    t = found.zeros.times
    _, ax = found.at.form(found.form)
    if samples.lost(found) or (np.sign(ax) != found.zeros.directions).any():
        outcomes.fate[row] = DOUBTFUL
    outcomes.transits[row] = len(t)
    if len(t):
        outcomes.t_first[row] = t[0]
        outcomes.t_last[row] = t[-1]
        outcomes.least_ax[row] = np.abs(ax).min() * found.release.length
        close_s = CLOSE_PAIR * 2 * np.pi / found.release.rate
        outcomes.close_pairs[row] = np.count_nonzero(np.diff(t) < close_s)


def describe_highest_points(
    outcomes: Outcomes, row: int, found: FoundZeros, samples: Samples
) -> None:
    """Fill in a row's highest points and its largest angle.

    Highest points are the zeros at which the height begins to fall.

    The height's rate is a product: a small swing's, whose steps are long, is known worse by its own
    series, in which the zeros were found, than by the motion, which is as exact as the step. One
    step of Newton's method goes from the ones to the others; of u' = A sin 2ωt it leaves a third of
    the cube of what 2ωt was.
    """
    release = found.release
    at = found.at
    is_high = found.zeros.directions < 0
    x, p, u = (part[is_high] for part in at.n)
    across = np.hypot(x, p)
    initial = max(release.angle, _angle_at_the_end(samples))
    outcomes.largest_angle[row] = np.max(np.arctan2(across, -u), initial=initial)

    fall = -at.a[2][is_high]
    bend = np.min(fall / (release.rate * across) ** 2, initial=np.inf)
    if not (len(fall) and release.rate and bend >= LEAST_BEND):
        return
    late = at.v[2] / at.a[2]
    zeros = RowZeros(found.zeros.times - late, found.zeros.directions)
    close = (np.abs(late) * release.rate < _MOST_LATE).all()
    if samples.lost(replace(found, zeros=zeros)) or not close:
        outcomes.fate[row] = DOUBTFUL
        return

    t = zeros.times[is_high]
    outcomes.apsides[row] = len(t)
    outcomes.least_bend[row] = bend
    outcomes.least_fall[row] = fall.min()
    outcomes.apsis_first[row] = t[0]
    outcomes.apsis_last[row] = t[-1]
    _describe_turn(outcomes, row, at.earlier(late)[is_high])


def _angle_at_the_end(samples: Samples) -> float:
    """Return the angle from the plumb line at the end of the span, in radians."""
    x, p, u = (part[-1] for part in samples.motion.n)
    return float(np.arctan2(np.hypot(x, p), -u))


def _describe_turn(outcomes: Outcomes, row: int, highest: RowMotion) -> None:
    """Fill in how far the swing plane turned, and how many highest points lie on the side of the one before."""
    x, p, _ = highest.n
    azimuth = np.arctan2(p, x)
    half_turns = np.round(np.diff(azimuth) / np.pi)
    outcomes.turn[row] = azimuth[-1] - azimuth[0] - np.pi * np.sum(half_turns)
    outcomes.same_side[row] = np.count_nonzero(half_turns % 2 == 0)
