"""Frequency and precession of a solved scene, from its highest points: intervals that follow from their bounds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

from ..model.start import Start
from ..numbers.precision import GUARD_BITS, to_fraction, to_mpf
from ..scenes.inputs import Inputs

CERTAIN = 1e-6  # of a right angle: how near to it the turn from one highest point to the next may come
HOUR = 3600
ARC, DEGREES = Fraction(21, 20), Fraction(573, 10)  # a little more than π/3, and than a radian in degrees

Ends = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Swing:
    """Intervals over the highest points after the release; at the level enclosed they are proven.

    Attributes:
        hz: swings a second: half of the highest points a second, from the first to the last.
        precession: their turn about the plumb line, east to north, in degrees an hour; None where one turns so far to
            the next, up to the half turn between the two sides, that it cannot be followed.
    """

    hz: Ends
    precession: Ends | None

    @property
    def period(self) -> Ends:
        """Time of a swing to and fro in s."""
        return 1 / self.hz[1], 1 / self.hz[0]

    @property
    def full_turn(self) -> Ends | None:
        """Hours in which the plane turns once, whichever way; None where the precession may be 0."""
        if self.precession is None or self.precession[0] <= 0 <= self.precession[1]:
            return None
        low, high = sorted(360 / abs(rate) for rate in self.precession)
        return low, high

    def near(self, other: Swing | None, far: Fraction) -> Swing:
        """Return this swing with the part of its precession that is at most `far` from another's."""
        if self.precession is None or other is None or other.precession is None:
            return self
        (low, high), (least, most) = self.precession, other.precession
        return replace(self, precession=(max(low, least - far), min(high, most + far)))


def swing_of(points: Sequence[Sequence[Ends]], inputs: Inputs, bits: int, lean: Fraction = Fraction(0)) -> Swing | None:
    """Return the swing from the highest points of a run; None with fewer than two, or where their times overlap.

    Args:
        points: intervals of t, x, y and z of each, in s and m.
        inputs: those of the scene, about whose plumb line they turn.
        bits: that angles are computed with.
        lean: how far unit vectors across the plumb line are from the scene's, at most, where other inputs move it.
    """
    if len(points) < 2 or points[-1][0][0] <= points[0][0][1]:
        return None
    (first, last), half = (points[i][0] for i in (0, -1)), Fraction(len(points) - 1, 2)
    spans = last[0] - first[1], last[1] - first[0]
    hz, turn = (half / spans[1], half / spans[0]), _turn(points, inputs, bits, lean)
    if turn is None:
        return Swing(hz, None)
    rates = [angle / span * HOUR for angle in turn for span in spans]
    return Swing(hz, (min(rates), max(rates)))


def _turn(points: Sequence[Sequence[Ends]], inputs: Inputs, bits: int, lean: Fraction) -> Ends | None:
    """Return the turn from the first highest point to the last in degrees."""
    start = Start.of(inputs, bits + GUARD_BITS)
    ctx, (_, north, up) = start.ctx, start.k.pull
    strength = ctx.sqrt(north**2 + up**2)
    angles, errors = [], []
    for _, *point in points:
        x, y, z = (to_mpf((low + high) / 2, ctx) for low, high in point)
        dx, dy, dz = (to_mpf((high - low) / 2, ctx) for low, high in point)
        p = (north * z - up * y) / strength  # up is below 0: along the meridian, northwards
        dp = (abs(north) * dz + abs(up) * dy) / strength + to_mpf(lean, ctx) * (abs(y) + dy + abs(z) + dz)
        off, wide = ctx.hypot(dx, dp), ctx.hypot(x, p)
        if wide <= 2 * off:
            return None
        angles.append(ctx.atan2(p, x))
        errors.append(to_fraction(off / wide) * ARC + Fraction(1, 1 << bits))  # asin s <= (π/3) s up to 1/2
    halves = 0
    for (a, b), (e, f) in zip(pairwise(angles), pairwise(errors), strict=True):
        turned = float(b - a) / math.pi
        halves += round(turned)
        if abs(turned - round(turned)) + float(e + f) > 0.5 - CERTAIN:
            return None
    whole = to_fraction((angles[-1] - angles[0] - halves * ctx.pi) * 180 / ctx.pi)
    most = DEGREES * (errors[0] + errors[-1])
    return whole - most, whole + most
