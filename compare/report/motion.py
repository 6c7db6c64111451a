"""A motion as pictures show it: lines that follow the bob, the swing plane, the transits.

It comes from a golden dataset, or from a candidate's rows alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from reference import FoucaultError, Golden, Scene, Solution, trajectory
from reference.numbers.columns import STATE
from reference.numbers.precision import Array

from ..candidates.candidate import Candidate
from ..observed.swing_plane import Gauge, gauge_of

# that are drawn, spread over the span, where the rows lie too far apart to be a line themselves
SWINGS = 9
POINTS = 40  # of one swing
COARSE = 3  # rows farther apart than this many of these points are no line
WIDE = -0.7  # height over the cord length, above which a swing is shown on its sphere
# of the cord length: what moves less, by the rounding of its release, has no swing
AT_REST = 2.0**-128
_WINDOW = 24  # rows of a candidate whose longest axis gives the swing plane's direction
_BENT = 0.5  # a step differs from the one before by less than this part of it where rows are a line
# where the shorter axis is longer than this part of the longer one, an ellipse has no clear direction
_FLAT = 0.5


@dataclass(frozen=True)
class PicturedMotion:
    """A motion as pictures show it.

    Attributes:
        name: of the dataset or the file.
        length: of the cord in m; 0 if it is not known.
        t: times of the rows in s, shape (rows,).
        rows: x, y, z in m, shape (rows, 3); z is NaN where it is not known.
        line: x, y, z in m of points that follow the bob, shape (points, 3); a row of NaN ends each of several lines;
            empty where the rows lie too far apart.
        swings: how many single swings the line shows; 0 if it shows the whole motion.
        plane_t, plane: times in s and azimuth of the swing plane in degrees, from east to north, modulo 180.
        transit_t, transit_x, directions: transits in s, x there in m, and +1 where xdot goes from - to +.
    """

    name: str
    length: float
    t: Array = field(repr=False)
    rows: Array = field(repr=False)
    line: Array = field(repr=False)
    swings: int
    plane_t: Array = field(repr=False)
    plane: Array = field(repr=False)
    transit_t: Array = field(repr=False)
    transit_x: Array = field(repr=False)
    directions: Array = field(repr=False)

    @property
    def wide(self) -> bool:
        """True if the swing is too wide to be shown from above alone."""
        return bool(self.length) and bool((self.rows[:, 2] > WIDE * self.length).any())

    @classmethod
    def of_golden(cls, golden: Golden | Solution, until: float = np.inf) -> PicturedMotion:
        """Take a motion from a golden dataset or a solution, up to a time in s.

        One run in double fills the line in between far rows.
        """
        name = golden.manifest.id if isinstance(golden, Golden) else golden.scene.id
        t, transits = golden.t[golden.t <= until], golden.transits
        states, seen = (
            np.column_stack([golden.grid[column][: len(t)] for column in STATE]),
            transits["t"] <= until,
        )
        length = float(golden.scene.exact.length)
        gauge = _gauge(golden) if np.ptp(states[:, :3], axis=0).max() > AT_REST * length else None
        line, swings = _line(golden.scene, t, states, gauge)
        plane = (
            np.full(len(states), np.nan) if gauge is None else np.degrees(gauge.swing_plane(states))
        )
        swinging = np.isfinite(plane)
        return cls(
            name, length, t, states[:, :3], line, swings, t[swinging], plane[swinging],
            transits["t"][seen], transits["x"][seen], np.array(golden.directions, int)[seen],
        )  # fmt: skip

    @classmethod
    def of_candidate(cls, candidate: Candidate) -> PicturedMotion:
        """Take a motion from a candidate's rows; its swing plane is the longest axis of the rows around each time."""
        x, y = candidate.columns["x"], candidate.columns["y"]
        z = candidate.columns.get("z", np.full(len(x), np.nan))
        rows = np.column_stack([x, y, z])
        length = float(np.sqrt((rows**2).sum(axis=1)).max()) if "z" in candidate.columns else 0.0
        plane_t, plane = _axes(candidate.t, rows)
        nothing = np.empty(0)
        return cls(
            candidate.name, length, candidate.t, rows, rows if _is_line(rows) else rows[:0], 0, plane_t, plane,
            nothing, nothing, nothing,
        )  # fmt: skip


def _gauge(golden: Golden | Solution) -> Gauge | None:
    """Return what measures the swing, or None where the bob does not swing but creeps back to rest."""
    gauge = gauge_of(golden.scene)
    return gauge if gauge and golden.scene.exact.drag < 2 * gauge.omega else None


def _line(scene: Scene, t: Array, states: Array, gauge: Gauge | None) -> tuple[Array, int]:
    """Return the points of the line, shape (points, 3), and how many single swings they are."""
    if gauge is None or t[1] * POINTS <= COARSE * gauge.period:
        return states[:, :3], 0
    swing = np.linspace(0.0, gauge.period, POINTS + 1)
    end = float(t[-1]) - gauge.period
    starts = (
        np.linspace(0.0, end, SWINGS)
        if end > SWINGS * gauge.period
        else np.arange(0.0, end, gauge.period)
    )
    times = starts[:, None] + swing
    try:
        points = trajectory(scene, np.unique(times))
    except FoucaultError:
        return states[:, :3], 0
    of_each = points[np.searchsorted(np.unique(times), times), :3]
    apart = np.concatenate([of_each, np.full((len(starts), 1, 3), np.nan)], axis=1)
    return apart.reshape(-1, 3), len(starts)


def _is_line(rows: Array) -> bool:
    """Return whether rows lie so close together that a line through them follows the bob."""
    steps = np.diff(rows[:, :2], axis=0)
    lengths = np.hypot(*steps.T)
    bends = np.hypot(*np.diff(steps, axis=0).T)
    return len(bends) > 0 and float(np.median(bends)) <= _BENT * float(np.median(lengths))


def _axes(t: Array, rows: Array) -> tuple[Array, Array]:
    """Return times and azimuths in degrees of the longest axis of the rows, window by window."""
    parts = np.array_split(np.arange(len(t)), max(1, len(t) // _WINDOW))
    times, angles = [], []
    for part in parts:
        about = rows[part, :2] - rows[:, :2].mean(axis=0)
        sizes, axes = np.linalg.eigh(about.T @ about)
        if len(part) > 2 and sizes[0] <= _FLAT**2 * sizes[1] and sizes[1] > 0:
            times.append(float(t[part].mean()))
            angles.append(float(np.degrees(np.arctan2(axes[1, 1], axes[0, 1]))))
    return np.array(times), (np.array(angles) + 90) % 180 - 90
