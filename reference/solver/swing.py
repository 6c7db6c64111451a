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
from ..scenes.scene import Scene

# of a right angle: how near to it the turn from one highest point to the next may come
_CERTAIN = 1e-6
# highest points are the ends of a swing this many times as wide as the rest position is off the
# line
_CLEAR = 16
HOUR = 3600
# Why there is no swing, no precession or no full turn
NO_SWING = "it has fewer than two highest points: the bob does not swing to and fro, or the run is too short"
LEAN = (
    f"its last swing is less than {_CLEAR} times as wide as the rest position is off the plumb line"
)
NO_SECTION = "it needs the section highest, which the scene does not ask for"
UNDECIDED = "it is not decided which of its points are the highest"
ONE_SIDE = "successive highest points lie on the same side: they are not the ends of a swing"
FAST = (
    "the site may turn by a right angle or more from one highest point to the next: "
    "the direction cannot be determined"
)
SMALL = "the plane turns by less than it may seem to, since the rest position is off the plumb line"
_LOST = "the plane may turn too far from one highest point to the next to be followed"
_ARC = Fraction(21, 20)  # a little more than π/3
_DEGREES = Fraction(573, 10)  # a little more than a radian in degrees


_Point = Sequence[tuple[Fraction, Fraction]]  # intervals of coordinates


class Ends(NamedTuple):
    """The exact ends of an interval."""

    low: Fraction
    high: Fraction


class _Apsis(NamedTuple):
    """A highest point as it is seen along the plumb line.

    Attributes:
        azimuth: in radians.
        error_m: how far off the point may be across the line.
        width_m: its distance from the line.
        distance_m: its distance from the line's lower end on the sphere.
    """

    azimuth: Any
    error_m: Any
    width_m: Any
    distance_m: Any


@dataclass(frozen=True)
class Swing:
    """Intervals over the highest points after the release; at the level enclosed they are proven.

    Attributes:
        hz: swings a second: half of the highest points a second, from the first to the last.
        precession: their turn about the plumb line, east to north, in degrees an hour; None where
            they turn by less than they may be off, or one so far to the next, up to the half turn
            between sides, that none can follow it.
        reason: why there is no precession.
    """

    hz: Ends
    precession: Ends | None
    reason: str = ""

    @property
    def period(self) -> Ends:
        """Time of a swing to and fro in s."""
        return Ends(1 / self.hz.high, 1 / self.hz.low)

    @property
    def full_turn(self) -> Ends | None:
        """Hours in which the plane turns once, either way; None where the precession may be 0."""
        if self.precession is None or self.precession.low <= 0 <= self.precession.high:
            return None
        low, high = sorted(360 / abs(rate) for rate in self.precession)
        return Ends(low, high)

    def near(self, other: Swing | None, far: Fraction) -> Swing:
        """Return this swing with its precession cut to the values that differ from another's by at most `far`."""
        if self.precession is None or other is None or other.precession is None:
            return self
        low = max(self.precession.low, other.precession.low - far)
        high = min(self.precession.high, other.precession.high + far)
        return replace(self, precession=Ends(low, high))


def swing_of(
    points: Sequence[_Point], inputs: Inputs, bits: int, lean: Fraction = Fraction(0)
) -> Swing | None:
    """Return the swing of `swing_or_reason`, or None."""
    swing = swing_or_reason(points, inputs, bits, lean)
    return swing if isinstance(swing, Swing) else None


def swing_or_reason(
    points: Sequence[_Point], inputs: Inputs, bits: int, lean: Fraction = Fraction(0)
) -> Swing | str:
    """Return the swing from the highest points of a run, or a sentence that says why there is none.

    There is none with fewer than two, where their times overlap, and where they are not the ends of
    a swing: it is too small beside how far the rest position is off the plumb line (`offset`), or
    two on one side follow one another.

    Args:
        points: intervals of t, x, y and z of each, in s and m.
        inputs: those of the scene, about whose plumb line they turn.
        bits: that angles are computed with.
        lean: how far unit vectors across the plumb line are from the scene's, at most, where other
            inputs move it.
    """
    if len(points) < 2:
        return NO_SWING
    first_low, first_high = points[0][0]
    last_low, last_high = points[-1][0]
    if last_low <= first_high:
        return UNDECIDED
    start = Start.of(inputs, bits + GUARD_BITS)
    apses = _apses(points, start, lean)
    offset_rad = offset(start, min(apsis.distance_m for apsis in apses))
    if offset_rad > 1:
        return LEAN

    swings = Fraction(len(points) - 1, 2)
    spans = (last_low - first_high, last_high - first_low)
    hz = Ends(swings / spans[1], swings / spans[0])
    if turns_too_far(start, _longest_gap(points)):
        return Swing(hz, None, FAST)
    half_turns = _half_turns(apses)
    if any(count % 2 == 0 for count in half_turns):
        return ONE_SIDE

    turn = _turn(apses, half_turns, start.ctx, bits)
    if turn is None:
        return Swing(hz, None, _LOST)
    # both ends may be off by the offset; the middle of the turn is half the sum
    if 2 * Fraction(offset_rad) * _DEGREES > abs(turn.low + turn.high):
        return Swing(hz, None, SMALL)
    return Swing(hz, _rate(turn, spans))


def _apses(points: Sequence[_Point], start: Start, lean: Fraction) -> list[_Apsis]:
    """Return the highest points as seen along the plumb line."""
    return [_apsis(position, start, lean) for _, *position in points]


def _rate(turn: Ends, spans_s: tuple[Fraction, Fraction]) -> Ends:
    """Return the rate of a turn within the shortest and the longest time, per hour."""
    rates = [angle / span_s * HOUR for angle in turn for span_s in spans_s]
    return Ends(min(rates), max(rates))


def _longest_gap(points: Sequence[_Point]) -> Fraction:
    """Return the longest time between neighbours that their intervals allow, in s."""
    return max(later[0][1] - earlier[0][0] for earlier, later in pairwise(points))


def creeps_in_words(scene: Scene) -> str:
    """Return why a bob whose drag is too large for a swing has no period; see `Inputs.creeps`."""
    inputs = scene.exact
    most = 2 * math.sqrt(inputs.gravity / inputs.length)
    return (
        f"The bob creeps back to rest without swinging: drag {scene.pendulum.drag} 1/s is at least "
        f"2 sqrt(g/l) = {most:.3g} 1/s."
    )


def left_out(reason: str, still: bool) -> dict[str, str]:
    """Return the reasons why a swing has no precession or no full turn, by their names in a document.

    Args:
        reason: why there is no precession, "" if there is one.
        still: whether the precession may be 0.
    """
    if reason:
        return dict.fromkeys(("precession_deg_per_h", "full_turn_h"), reason)
    return {"full_turn_h": "the plane may not turn at all"} if still else {}


def offset(start: Start, far: Any) -> float:
    """Return a bound on the distance of a swing's highest points from its ends, in radians of azimuth.

    Above 1 they may lie anywhere.

    They are farthest along the plumb line at the pivot. The rest position, about which the bob
    swings, is off this line, as the centrifugal force at the bob is another.

    Args:
        start: of the scene.
        far: least distance of a highest point from the lowest one, in m.
    """
    with suppress(UnreachableError):  # no rest position
        lean = start.lean
        return float(_CLEAR * lean * start.k.length / far) if far else math.inf
    return 0.0


def turns_too_far(start: Start, seconds: Any) -> bool:
    """Return whether the site may turn a swing by a right angle between highest points.

    Then nobody can tell which way it turned.
    """
    return float(abs(start.k.rate)) * float(seconds) >= math.pi / 2


def _apsis(position: _Point, start: Start, lean: Fraction) -> _Apsis:
    """Return a highest point as seen along the plumb line, from the intervals of x, y and z."""
    # many names, as each is a quantity of one formula
    ctx = start.ctx
    x, y, z = (to_mpf((low + high) / 2, ctx) for low, high in position)
    dx, dy, dz = (to_mpf((high - low) / 2, ctx) for low, high in position)
    _, north, up = start.k.pull
    strength = ctx.sqrt(north**2 + up**2)

    # p lies along the meridian, northwards; up is below 0
    p = (north * z - up * y) / strength
    dp = (abs(north) * dz + abs(up) * dy) / strength
    dp += to_mpf(lean, ctx) * (abs(y) + dy + abs(z) + dz)
    width = ctx.hypot(x, p)
    drop = start.k.length - (north * y + up * z) / strength
    return _Apsis(
        azimuth=ctx.atan2(p, x),
        error_m=ctx.hypot(dx, dp),
        width_m=width,
        distance_m=ctx.hypot(width, drop),
    )


def _half_turns(apses: Sequence[_Apsis]) -> list[int]:
    """Return how many half turns lie between neighbours: an even number on one side."""
    turns = [later.azimuth - earlier.azimuth for earlier, later in pairwise(apses)]
    return [round(float(turn) / math.pi) for turn in turns]


def _turn(apses: Sequence[_Apsis], half_turns: Sequence[int], ctx: Any, bits: int) -> Ends | None:
    """Return the turn from the first highest point to the last in degrees, an interval.

    None where it cannot be followed.
    """
    if any(apsis.width_m <= 2 * apsis.error_m for apsis in apses):
        return None
    # asin s <= (π/3) s up to 1/2
    errors = [
        to_fraction(apsis.error_m / apsis.width_m) * _ARC + Fraction(1, 1 << bits)
        for apsis in apses
    ]
    azimuths = [apsis.azimuth for apsis in apses]
    for i, half_turn in enumerate(half_turns):
        turn = float(azimuths[i + 1] - azimuths[i]) / math.pi - half_turn
        if abs(turn) + float(errors[i] + errors[i + 1]) > 0.5 - _CERTAIN:
            return None

    radians = azimuths[-1] - azimuths[0] - sum(half_turns) * ctx.pi
    degrees = to_fraction(radians * 180 / ctx.pi)
    error = _DEGREES * (errors[0] + errors[-1])
    return Ends(degrees - error, degrees + error)
