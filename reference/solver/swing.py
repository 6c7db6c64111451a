"""Frequency and precession of a solved scene, as intervals, from its highest points.

Those of samples: compare/observed/swing_plane.py; of a sweep's rows: sweeps/highest_points.py.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

from ..errors import UnreachableError
from ..model.start import Start
from ..numbers.precision import GUARD_BITS, to_fraction, to_mpf
from ..scenes.inputs import Inputs

# of a right angle: how near to it the turn from one highest point to the next may come
CERTAIN = 1e-6
# times as far as the rest position is off the plumb line is where a swing's highest points are its ends
CLEAR = 16
HOUR = 3600
# Why there is no swing, no precession or no full turn
NO_SWING = "it has no two highest points: the bob does not swing to and fro, or the run ends before"
LEAN = (
    f"its last swing is less than {CLEAR} times as wide as the rest position is off the plumb line"
)
NO_SECTION = "the section highest was not asked for, from which the swing follows"
UNDECIDED = "it is not decided which of its points are the highest"
ONE_SIDE = (
    "highest points that follow one another lie on one side: they are not the ends of a swing"
)
FAST = "the site may turn by a right angle and more from one highest point to the next: nobody can tell which way"
SMALL = "the plane turns by less than it may seem to, since the rest position is off the plumb line"
LOST = "the plane may turn so far from one highest point to the next that nobody can follow it"
# a little more than π/3, and than a radian in degrees
ARC, DEGREES = Fraction(21, 20), Fraction(573, 10)

Ends = tuple[Fraction, Fraction]


class Seen(NamedTuple):
    """A highest point as it is seen along the plumb line.

    Attributes:
        azimuth: in radians.
        off: how far off the point may be across the line, in m.
        wide: its distance from the line, in m.
        far: its distance from the line's lower end on the sphere, in m.
    """

    azimuth: Any
    off: Any
    wide: Any
    far: Any


@dataclass(frozen=True)
class Swing:
    """Intervals over the highest points after the release; at the level enclosed they are proven.

    Attributes:
        hz: swings a second: half of the highest points a second, from the first to the last.
        precession: their turn about the plumb line, east to north, in degrees an hour; None where they turn by less
            than they may be off, or one so far to the next, up to the half turn between sides, that none can follow it.
        reason: why there is no precession.
    """

    hz: Ends
    precession: Ends | None
    reason: str = ""

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


def swing_of(
    points: Sequence[Sequence[Ends]], inputs: Inputs, bits: int, lean: Fraction = Fraction(0)
) -> Swing | None:
    """Return the swing from the highest points of a run, or None; arguments are those of `swing_or_reason`."""
    swing = swing_or_reason(points, inputs, bits, lean)
    return swing if isinstance(swing, Swing) else None


def swing_or_reason(
    points: Sequence[Sequence[Ends]], inputs: Inputs, bits: int, lean: Fraction = Fraction(0)
) -> Swing | str:
    """Return the swing from the highest points of a run, or a sentence that says why there is none.

    There is none with fewer than two, where their times overlap, and where they are not the ends of a swing: it is too
    small beside how far the rest position is off the plumb line (`offset`), or two on one side follow one another.

    Args:
        points: intervals of t, x, y and z of each, in s and m.
        inputs: those of the scene, about whose plumb line they turn.
        bits: that angles are computed with.
        lean: how far unit vectors across the plumb line are from the scene's, at most, where other inputs move it.
    """
    if len(points) < 2:
        return NO_SWING
    if points[-1][0][0] <= points[0][0][1]:
        return UNDECIDED
    start = Start.of(inputs, bits + GUARD_BITS)
    seen = [_seen(point, start, lean) for _, *point in points]
    off = offset(start, min(point.far for point in seen))
    if off > 1:
        return LEAN
    (first, last), half = (points[i][0] for i in (0, -1)), Fraction(len(points) - 1, 2)
    spans = last[0] - first[1], last[1] - first[0]
    hz = half / spans[1], half / spans[0]
    if turns_too_far(start, max(b[0][1] - a[0][0] for a, b in pairwise(points))):
        return Swing(hz, None, FAST)
    if any(count % 2 == 0 for count in _halves(seen)):
        return ONE_SIDE
    turn = _turn(seen, start.ctx, bits)
    if turn is None:
        return Swing(hz, None, LOST)
    if 2 * Fraction(off) * DEGREES > abs(turn[0] + turn[1]):
        return Swing(hz, None, SMALL)
    rates = [angle / span * HOUR for angle in turn for span in spans]
    return Swing(hz, (min(rates), max(rates)))


def left_out(reason: str, still: bool) -> dict[str, str]:
    """Return why a swing has no precession or no full turn, by their names in a document.

    Args:
        reason: why there is no precession, "" if there is one.
        still: whether the precession may be 0.
    """
    if reason:
        return dict.fromkeys(("precession_deg_per_h", "full_turn_h"), reason)
    return {"full_turn_h": "the plane may not turn at all"} if still else {}


def left_out_texts(reasons: dict[str, str]) -> list[str]:
    """Return what `left_out` gives as words of a line."""
    groups = {
        reason: [name for name in reasons if reasons[name] == reason] for reason in reasons.values()
    }
    return [f"no {' and no '.join(names)} ({reason})" for reason, names in groups.items()]


def offset(start: Start, far: Any) -> float:
    """Return how far a swing's highest points may lie from its ends, in radians of azimuth; above 1: anywhere.

    They are farthest along the plumb line at the pivot. The rest position, about which the bob swings, is off this
    line, as the centrifugal force at the bob is another.

    Args:
        start: of the scene.
        far: least distance of a highest point from the lowest one, in m.
    """
    with suppress(UnreachableError):
        return float(CLEAR * start.lean * start.k.length / far) if far else math.inf
    return 0.0


def turns_too_far(start: Start, seconds: Any) -> bool:
    """Return whether the site's rotation may turn a swing by a right angle or more from one highest point to the next.

    Then nobody can tell which way it turned.
    """
    return float(abs(start.k.rate)) * float(seconds) >= math.pi / 2


def _seen(point: Sequence[Ends], start: Start, lean: Fraction) -> Seen:
    ctx, (_, north, up) = start.ctx, start.k.pull
    strength = ctx.sqrt(north**2 + up**2)
    x, y, z = (to_mpf((low + high) / 2, ctx) for low, high in point)
    dx, dy, dz = (to_mpf((high - low) / 2, ctx) for low, high in point)
    p = (north * z - up * y) / strength  # up is below 0: along the meridian, northwards
    dp = (abs(north) * dz + abs(up) * dy) / strength + to_mpf(lean, ctx) * (
        abs(y) + dy + abs(z) + dz
    )
    wide, drop = ctx.hypot(x, p), start.k.length - (north * y + up * z) / strength
    return Seen(ctx.atan2(p, x), ctx.hypot(dx, dp), wide, ctx.hypot(wide, drop))


def _halves(seen: Sequence[Seen]) -> list[int]:
    """Return by how many half turns each point is from the one before; even ones are on its side."""
    return [round(float(b.azimuth - a.azimuth) / math.pi) for a, b in pairwise(seen)]


def _turn(seen: Sequence[Seen], ctx: Any, bits: int) -> Ends | None:
    """Return the turn from the first highest point to the last in degrees; None where it cannot be followed."""
    if any(point.wide <= 2 * point.off for point in seen):
        return None
    angles, halves = [point.azimuth for point in seen], _halves(seen)
    # asin s <= (π/3) s up to 1/2
    errors = [to_fraction(point.off / point.wide) * ARC + Fraction(1, 1 << bits) for point in seen]
    for (a, b), (e, f), half in zip(pairwise(angles), pairwise(errors), halves, strict=True):
        if abs(float(b - a) / math.pi - half) + float(e + f) > 0.5 - CERTAIN:
            return None
    whole = to_fraction((angles[-1] - angles[0] - sum(halves) * ctx.pi) * 180 / ctx.pi)
    most = DEGREES * (errors[0] + errors[-1])
    return whole - most, whole + most
