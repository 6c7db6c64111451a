"""Frequency and precession of a swing from its highest points, as intervals that follow from their bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from ..model.start import Start
from ..numbers.precision import GUARD_BITS, to_fraction, to_mpf
from ..numbers.table import Table
from ..scenes.inputs import Inputs

CERTAIN = 1e-6  # of a right angle: how near to it the turn from one highest point to the next may come
HOUR = 3600

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


def swing_of(table: Table, inputs: Inputs) -> Swing | None:
    """Return the swing from all highest points of a run, `columns.SECTION` with bounds; None with fewer than two."""
    count = len(table)
    if count < 2:
        return None
    (first, *_, last), (first_bound, *_, last_bound) = table.exact("t"), table.bound("t")
    span = last - first
    spans = span - first_bound - last_bound, span + first_bound + last_bound
    if spans[0] <= 0:
        return None
    hz = Fraction(count - 1, 2) / spans[1], Fraction(count - 1, 2) / spans[0]
    turn = _turn(table, inputs)
    if turn is None:
        return Swing(hz, None)
    products = [angle / time for angle in turn for time in spans]
    return Swing(hz, (min(products) * HOUR, max(products) * HOUR))


def _turn(table: Table, inputs: Inputs) -> Ends | None:
    """Return the turn from the first highest point to the last in degrees."""
    start = Start.of(inputs, table.bits + GUARD_BITS)
    ctx, (_, north, up) = start.ctx, start.k.pull
    strength = ctx.sqrt(north**2 + up**2)
    columns = [list(zip(table.exact(name), table.bound(name), strict=True)) for name in ("x", "y", "z")]
    angles, errors = [], []
    for (x, dx), (y, dy), (z, dz) in zip(*columns, strict=True):
        east, aside = (to_mpf(q, ctx) for q in (x, y)), to_mpf(z, ctx)
        x_, y_ = east
        p = (north * aside - up * y_) / strength  # up is below 0: along the meridian, northwards
        off, wide = dx + dy + dz, to_fraction(ctx.hypot(x_, p))
        if wide <= 2 * off:
            return None
        angles.append(ctx.atan2(p, x_))
        errors.append(2 * off / wide + Fraction(1, 1 << table.bits))
    halves = 0
    for (a, b), (e, f) in zip(pairwise(angles), pairwise(errors), strict=True):
        turned = float(b - a) / math.pi
        halves += round(turned)
        if abs(turned - round(turned)) + float(e + f) > 0.5 - CERTAIN:
            return None
    whole, most = to_fraction((angles[-1] - angles[0] - halves * ctx.pi) * 180 / ctx.pi), 60 * (errors[0] + errors[-1])
    return whole - most, whole + most
