"""Errors of the analytic approximations against the reference: position and swing plane over time, single numbers.

Two errors are measured: `error_m`, the largest distance between the approximate and the true bob up
to a time, and `plane_error_arcsec`, the largest difference of the swing planes
(`observed.swing_plane`), each about its own rest position: the direction that somebody who believes
the approximation would draw on the floor.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from reference import FoucaultError, Scene, trajectory
from reference.numbers.precision import Array
from reference.status import Status

from ..approximations import Motion, quantities
from ..observed.swing_plane import Gauge, gauge_of
from .row import failure

# s: 20 s and 12000 s as in the paper's figure 3, an hour, and a day
TIMES = (20.0, 3600.0, 12000.0, 86400.0)
_PER_SWING = 16  # samples in a period
_SWINGS = 100  # where nothing swings, the span is sampled as if it held this many periods
_MOST = 500_000  # samples at most; a motion of very many swings gets fewer than _PER_SWING in each
_ARCSEC = 180 * 3600 / np.pi


@dataclass(frozen=True)
class TimeRow:
    """Largest errors from the release up to time t in s.

    None where one does not exist: `reason` says why.
    """

    approximation: str
    t: float
    error_m: float | None
    plane_error_arcsec: float | None
    status: Status = Status.OK
    reason: str = ""


@dataclass(frozen=True)
class QuantityRow:
    """An approximate number beside the reference's."""

    approximation: str
    value: str | None
    truth: str | None
    unit: str
    relative_error: float | None
    status: Status = Status.OK
    reason: str = ""


class ReferenceMotion:
    """The reference's motion of a scene on a fine grid, with which approximations are compared.

    Args:
        scene: to be approximated.
        t_end: end in s, above 0; the grid has 16 times in a period, and holds `marks` exactly.
        marks: further times in s.
    """

    def __init__(self, scene: Scene, t_end: float, marks: Iterable[float] = ()) -> None:
        self.scene = scene
        self.gauge = gauge_of(scene)
        period = t_end / _SWINGS if self.gauge is None else min(self.gauge.period, t_end)
        fine = np.arange(0.0, t_end, max(period / _PER_SWING, t_end / _MOST))
        within = [t for t in marks if 0 <= t <= t_end]
        self.times: Array = np.unique(np.concatenate((fine, [t_end], within)))
        self.rows = trajectory(scene, self.times)
        self.plane = self._plane(self.gauge, self.rows)

    def errors(self, motion: Motion) -> dict[str, Array]:
        """Return the largest errors of an approximation since the release at each time of the grid, by their names.

        They are `error_m`, and `plane_error_arcsec`, which is NaN as long as one of the two swings
        has no plane.

        Raises:
            FoucaultError: the approximation does not apply, or fails.
        """
        rows = motion.trajectory(self.scene, self.times)
        gauge = self.gauge if motion.rest is None else gauge_of(self.scene, motion.rest(self.scene))
        position = np.linalg.norm(rows.T[:3] - self.rows.T[:3], axis=0)
        turned = self._plane(gauge, rows) - self.plane
        plane = np.abs(turned - np.pi * np.round(turned / np.pi)) * _ARCSEC
        return {
            "error_m": np.maximum.accumulate(position),
            "plane_error_arcsec": np.fmax.accumulate(plane),
        }

    def largest(self, motion: Motion, marks: Sequence[float]) -> list[TimeRow]:
        """Return the largest errors of an approximation up to each of some times in s."""
        try:
            errors = self.errors(motion)
        except FoucaultError as error:
            return [TimeRow(motion.id, t, None, None, *failure(error)) for t in marks]
        places = np.searchsorted(self.times, np.array(marks) * (1 + 1e-12), side="right") - 1
        positions = errors["error_m"][places].tolist()
        planes = errors["plane_error_arcsec"][places].tolist()
        return [
            TimeRow(motion.id, t, position, None if np.isnan(plane) else plane)
            for t, position, plane in zip(marks, positions, planes, strict=True)
        ]

    def _plane(self, gauge: Gauge | None, rows: Array) -> Array:
        return np.full(len(rows), np.nan) if gauge is None else gauge.swing_plane(rows)


def error_table(
    scene: Scene, chosen: Iterable[Motion], t_end: float, times: Sequence[float] = TIMES
) -> list[TimeRow]:
    """Return the errors of approximations of the motion up to each of `times` before t_end, and up to t_end.

    Args:
        scene: to be approximated.
        chosen: the approximations.
        t_end: in s.
        times: in s.
    """
    marks = [*(t for t in times if t < t_end), t_end]
    truth = ReferenceMotion(scene, t_end, marks)
    return [row for motion in chosen for row in truth.largest(motion, marks)]


def quantity_table(scene: Scene) -> list[QuantityRow]:
    """Return approximate numbers beside the true ones, to 15 digits: frequency, and so on."""
    rows = []
    truth_of = cache(lambda truth: truth(scene))
    for approximation in quantities().values():
        name = approximation.id
        unit = approximation.unit
        try:
            value = approximation.value(scene)
            truth = value.context.mpf(truth_of(approximation.truth))
        except FoucaultError as error:
            rows.append(QuantityRow(name, None, None, unit, None, *failure(error)))
            continue
        relative_error = float(abs(value / truth - 1)) if truth else None
        printed = str(value.context.nstr(value, 15))
        printed_truth = str(value.context.nstr(truth, 15))
        rows.append(QuantityRow(name, printed, printed_truth, unit, relative_error))
    return rows
