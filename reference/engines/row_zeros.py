"""The zeros found in a row, guarded: what they say of its transits, or passages of a section, and highest points.

A root finder such as heyoka's may lose a zero. A single one shows in the directions, which have to alternate from the
release to the end. Of two close together the rate itself tells, at samples of the run: between two of them it may dip
through zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from ..model.algebra import add, cross, dot, minus, plus, scale, subtract
from ..model.constants import Constants
from ..model.formulations import FORMULATIONS
from ..numbers.precision import Array
from .batch_interface import CLOSE_PAIR, DOUBTFUL, LEAST_BEND, Outcomes, PlumbAxes, Rows

MODEL = FORMULATIONS["momentum"]
TRANSIT, HEIGHT = 0, 1  # kinds of zeros: of xdot or a section's form, and of the rate of the height
RISE = (0, 0, 0, 0, 0, 1, 0)  # the form of that rate
FINER = 16  # parts of the time between two samples, where a form may dip to zero there
# of a swing's period after the release: there heyoka may report the zero at the release
QUIET = 1e-4
# of a radian of the swing, as a zero of the height's rate was found: else its series tells little
MOST_LATE = 1e-3


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
        """Return the motion in a state; of a small swing the rates of the height keep their digits."""
        n, momentum = (state[0], state[1], state[2]), (state[3], state[4], state[5])
        rates = MODEL.derivatives((*n, *momentum), k, np)
        v, torque = (rates[0], rates[1], rates[2]), (rates[3], rates[4], rates[5])
        return cls(n, v, add(cross(torque, n), cross(subtract(momentum, k.turn), v)))

    def form(self, form: Any) -> tuple[Any, Any]:
        """Return a form, as `PlumbAxes.forms` gives it, and its rate."""
        a, b, n = form[:3], form[3:6], (self.n[0], self.n[1], self.n[2] + 1)
        return minus(plus(dot(a, n), dot(b, self.v)), form[6]), plus(dot(a, self.v), dot(b, self.a))

    def earlier(self, by: Array) -> Self:
        """Return the motion a little earlier than at its times, n'' as it is."""
        return type(self)(
            subtract(self.n, scale(by, self.v)), subtract(self.v, scale(by, self.a)), self.a
        )

    def __getitem__(self, chosen: Any) -> Self:
        """Return the motion at some of its times."""
        return type(self)(
            *(tuple(part[chosen] for part in vector) for vector in (self.n, self.v, self.a))
        )


@dataclass(frozen=True)
class RowRelease:
    """The release of a row: quantities that follow from its inputs before it is solved.

    Attributes:
        length: of the cord, in m.
        end: of the span, in s.
        rate: of a small swing, in rad/s.
        quiet: seconds after the release in which a zero is that of the release, if it has one by the exact inputs.
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
        """Return what is known of a row whose motion at the release is given, and in these axes the form."""
        rate, multiplicity, rising = (
            np.sqrt(axes.size.high[row]),
            rows.zeros_at_release[row],
            rows.rising[row],
        )
        turn = (0, axes.turn[0].high[row], axes.turn[1].high[row])
        x, p, u = motion.n
        east = (motion.v[0], motion.a[0], -2 * cross(turn, motion.a)[0], -x, -turn[2] * p)[
            multiplicity
        ]
        return cls(
            length=rows.length[row, 0],
            end=rows.t_end[row, 0],
            rate=rate,
            quiet=QUIET * 2 * np.pi / (rate + axes.speed[row]),
            still=bool(rows.still[row]),
            forms={TRANSIT: form, HEIGHT: RISE},
            zero={TRANSIT: multiplicity > 0, HEIGHT: rising == 0},
            # at rest on the plumb line the bob can but rise
            signs={
                TRANSIT: rows.leaves[row] or np.sign(east),
                HEIGHT: rising or np.sign(motion.a[2]) or 1,
            },
            angle=np.arctan2(np.hypot(x, p), -u),
        )

    def after(self, zeros: RowZeros, kind: int) -> RowZeros:
        """Return the zeros of a kind in the span, without that of the release, which it reports at 1e-17 s or so."""
        has_none = self.still and kind == TRANSIT
        least = np.inf if has_none else self.quiet if self.zero[kind] else 0.0
        return zeros[(zeros.times > least) & (zeros.times <= self.end)]


@dataclass(frozen=True)
class Samples:
    """A row's motion at times from the release to the end."""

    times: Array
    motion: RowMotion

    def lost(self, zeros: RowZeros, at: RowMotion, release: RowRelease, kind: int) -> bool:
        """Return whether zeros of a kind may not be among those that were found; `at` is the motion at these."""
        signs = np.concatenate([[release.signs[kind]], zeros.directions])
        expected = signs[np.searchsorted(zeros.times, self.times[1:])]
        alternate = (signs[:-1] * signs[1:] < 0).all()
        alternate = (
            alternate and (self.motion.form(release.forms[kind])[0][1:] * expected > 0).all()
        )
        return not (alternate and not self._dips(zeros, at, release, kind)[0].size)

    def finer(self, zeros: RowZeros, at: RowMotion, release: RowRelease, kind: int) -> Array:
        """Return the times of samples, with more of them where the form of a kind may dip to zero."""
        return np.union1d(
            self.times, np.linspace(*self._dips(zeros, at, release, kind), FINER + 1)[1:-1]
        )

    def _dips(
        self, zeros: RowZeros, at: RowMotion, release: RowRelease, kind: int
    ) -> tuple[Array, Array]:
        """Return the neighbours among samples and zeros between which a form may go through zero and back.

        The cubic through the values and slopes there says how low the minimum between them is, but for its error: that
        of u' = A sin 2ωt is below A (2ωh)⁴/384.
        """
        signs, times = (
            np.append(release.signs[kind], zeros.directions),
            np.append(self.times, zeros.times),
        )
        order = np.argsort(times, kind="stable")
        rate, slope = self.motion.form(release.forms[kind])
        sign, most = signs[np.cumsum(order >= len(rate))[:-1]], np.abs(rate).max()
        times = times[order]
        length = np.diff(times)
        rate = np.concatenate([rate, 0 * zeros.times])[order]
        slope = np.concatenate([slope, at.form(release.forms[kind])[1]])[order]
        left, right, before, after = sign * [
            rate[:-1],
            rate[1:],
            slope[:-1] * length,
            slope[1:] * length,
        ]
        if release.zero[kind]:
            left[0], before[0] = 0, max(before[0], 0)
        between = 3 * (right - left) - before - after
        s = before / (before - between - np.sqrt(between**2 - before * after))
        least = (1 - s) ** 2 * ((1 + 2 * s) * left + s * before) + s**2 * (
            (3 - 2 * s) * right - (1 - s) * after
        )
        may = (s > 0) & (s < 1) & (least < most * (2 * release.rate * length) ** 4 / 384)
        return times[:-1][may], times[1:][may]


def describe_transits(
    outcomes: Outcomes,
    row: int,
    release: RowRelease,
    zeros: RowZeros,
    at: RowMotion,
    samples: Samples,
) -> None:
    """Fill in a row's transits: the zeros, and the motion at them."""
    t, (_, ax) = zeros.times, at.form(release.forms[TRANSIT])
    if samples.lost(zeros, at, release, TRANSIT) or (np.sign(ax) != zeros.directions).any():
        outcomes.fate[row] = DOUBTFUL
    outcomes.transits[row] = len(t)
    if len(t):
        outcomes.t_first[row], outcomes.t_last[row] = t[0], t[-1]
        outcomes.least_ax[row] = np.abs(ax).min() * release.length
        outcomes.close_pairs[row] = np.count_nonzero(
            np.diff(t) < CLOSE_PAIR * 2 * np.pi / release.rate
        )


def describe_highest_points(
    outcomes: Outcomes,
    row: int,
    release: RowRelease,
    zeros: RowZeros,
    at: RowMotion,
    samples: Samples,
) -> None:
    """Fill in a row's highest points, the zeros at which the height begins to fall, and its largest angle.

    The height's rate is a product: a small swing's, whose steps are long, is known worse by its own series, in which
    the zeros were found, than by the motion, which is as exact as the step. One step of Newton's method goes from the
    ones to the others; of u' = A sin 2ωt it leaves a third of the cube of what 2ωt was.
    """
    high = zeros.directions < 0
    t, fall, (x, p, u) = zeros.times[high], -at.a[2][high], (part[high] for part in at.n)
    across = np.hypot(x, p)
    east, north, up = (part[-1] for part in samples.motion.n)
    ends = max(release.angle, np.arctan2(np.hypot(east, north), -up))
    outcomes.largest_angle[row] = np.max(np.arctan2(across, -u), initial=ends)
    bend = np.min(fall / (release.rate * across) ** 2, initial=np.inf)
    if not (len(t) and release.rate and bend >= LEAST_BEND):
        return
    late = at.v[2] / at.a[2]
    zeros = RowZeros(zeros.times - late, zeros.directions)
    if (
        samples.lost(zeros, at, release, HEIGHT)
        or not (np.abs(late) * release.rate < MOST_LATE).all()
    ):
        outcomes.fate[row] = DOUBTFUL
        return
    t, (x, p, _) = zeros.times[high], at.earlier(late)[high].n
    azimuth = np.arctan2(p, x)
    outcomes.apsides[row], outcomes.least_bend[row], outcomes.least_fall[row] = (
        len(t),
        bend,
        fall.min(),
    )
    outcomes.apsis_first[row], outcomes.apsis_last[row] = t[0], t[-1]
    half_turns = np.round(np.diff(azimuth) / np.pi)
    outcomes.turn[row] = azimuth[-1] - azimuth[0] - np.pi * np.sum(half_turns)
    outcomes.same_side[row] = np.count_nonzero(half_turns % 2 == 0)
