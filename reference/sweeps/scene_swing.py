"""Period and precession of a scene in double precision: what `foucault show` prints."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import UnreachableError
from ..model.start import Start
from ..scenes.scene import AnyScene, Scene, as_scene
from ..solver.swing import (
    FAST,
    HOUR,
    LEAN,
    NO_SWING,
    ONE_SIDE,
    SMALL,
    creeps_in_words,
    offset,
    turns_too_far,
)
from .part import highest_on_one_side, solve_part
from .request import Settings, request

_MOST_SWINGS = 10_000  # that are followed
_PRECISION_BITS = 96  # of the plumb line and the rest position
_SETTINGS = Settings(want=("frequency", "precession", "amplitude"))


@dataclass(frozen=True)
class EstimatedSwing:
    """Period and precession of a scene with estimated errors. For proofs: `Solution.swing`.

    Attributes:
        over_s: the time in s over which period and precession are averaged.
        period_s: time of a swing to and fro, in s.
        period_error_s: estimated error of the period, in s.
        precession_deg_per_h: turn of the swing plane about the plumb line, east to north; None
            where `reason` says why.
        precession_error_deg_per_h: estimated error of the precession.
        reason: why there is no precession; "" if there is one.
    """

    over_s: str
    period_s: float
    period_error_s: float
    precession_deg_per_h: float | None
    precession_error_deg_per_h: float
    reason: str = ""

    @property
    def full_turn_h(self) -> float | None:
        """Hours in which the plane turns once, whichever way; None where it may not turn at all."""
        if self.precession_deg_per_h is None or self.may_stand_still:
            return None
        return 360 / abs(self.precession_deg_per_h)

    @property
    def full_turn_error_h(self) -> float | None:
        """The error of `full_turn_h` in hours."""
        if self.full_turn_h is None or self.precession_deg_per_h is None:
            return None
        return self.full_turn_h * self.precession_error_deg_per_h / abs(self.precession_deg_per_h)

    @property
    def may_stand_still(self) -> bool:
        """Whether the precession is at most as large as its error."""
        rate = self.precession_deg_per_h
        return rate is not None and not abs(rate) > self.precession_error_deg_per_h


def swing(scene: AnyScene) -> EstimatedSwing:
    """Return period and precession of a scene over its run, or its first 10,000 swings.

    Raises:
        InputError: a field of the scene is wrong.
        UnreachableError: the bob does not swing to and fro, or double precision does not decide it.
    """
    scene = first_swings(scene)
    start = Start.of(scene.exact, _PRECISION_BITS)
    one_row = request(scene, [f"site.latitude={scene.site.latitude}"], settings=_SETTINGS)
    columns = solve_part(one_row, range(1), promote=None).columns
    row = {name: values[0] for name, values in columns.items()}
    hz = float(row["swing_hz"])
    if not hz > 0:
        if scene.exact.creeps:
            raise UnreachableError(creeps_in_words(scene))
        raise UnreachableError(row["reason"] or NO_SWING)

    span_s = float(scene.run.t_end)
    smallest_m = _smallest_amplitude_m(start, float(row["max_angle_deg"]), span_s)
    offset_rad = offset(start, smallest_m)
    if offset_rad > 1:
        raise UnreachableError(LEAN)
    too_fast = turns_too_far(start, 0.5 / hz)
    if not too_fast and highest_on_one_side(one_row):
        raise UnreachableError(ONE_SIDE)

    precession = float(row["precession_deg_per_h"])
    turned_rad = math.radians(abs(precession)) * span_s / HOUR
    reason = ""
    if too_fast:
        reason = FAST
    elif offset_rad > turned_rad:
        reason = SMALL
    return EstimatedSwing(
        over_s=scene.run.t_end,
        period_s=1 / hz,
        period_error_s=float(row["swing_error_hz"]) / hz**2,
        precession_deg_per_h=None if reason else precession,
        precession_error_deg_per_h=float(row["precession_error_deg_per_h"]),
        reason=reason,
    )


def first_swings(scene: AnyScene) -> Scene:
    """Return a scene that lasts for 10,000 swings at most.

    Raises:
        InputError: a field of the scene is wrong.
    """
    scene = as_scene(scene)
    start = Start.of(scene.exact, _PRECISION_BITS)
    longest_s = _MOST_SWINGS * 2 * math.pi / start.fastest_rate
    if scene.exact.t_end <= longest_s:
        return scene
    return scene.with_values({"run.t_end": f"{longest_s:.4g}"})


def _smallest_amplitude_m(start: Start, largest_deg: float, span_s: float) -> float:
    """Return the distance of the last highest point from the lowest one, in m: drag shrinks it."""
    chord = 2 * math.sin(math.radians(largest_deg) / 2)
    shrunk = math.exp(-float(start.k.drag) * span_s / 2)
    return float(start.k.length) * chord * shrunk
