"""A motion as pictures show it: its path, swing plane and transits.

The motion is a golden dataset, a solution, or the rows of a candidate.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from reference import FoucaultError, Golden, Scene, Solution, trajectory
from reference.numbers.columns import STATE
from reference.numbers.precision import Array

from ..candidates.candidate import Candidate
from ..observed.swing_plane import Gauge, gauge_of

# Rows that are too far apart for a line are replaced by this many single swings, spread over the
# span.
SWINGS = 9
POINTS = 40  # per swing
MOST = 1200  # points of a line
_STRAIGHT = 0.002  # part of the path's size: a curve within this of its chord is drawn as the chord
_COARSE = 3  # rows farther apart than this many of these points are not joined to a line
_WIDE = -0.7  # z over cord length; a bob that rises above it is shown on its sphere
_AT_REST = 2.0**-128  # motion below this part of the cord length is rounding, not a swing
_WINDOW = 24  # rows of a candidate whose longest axis is the swing plane
_BENT = 0.5  # rows form a line if successive steps differ by less than this part of a step
_FLAT = 0.5  # a path whose axes have a larger ratio than this has no clear direction


@dataclass(frozen=True)
class PicturedMotion:
    """What pictures show of a motion.

    Attributes:
        name: name of the dataset or the file.
        length: cord length in m; 0 if unknown.
        t: times of the rows in s, shape (rows,).
        rows: x, y, z in m, shape (rows, 3); z is NaN where unknown.
        line: x, y, z in m of a curve along the path, shape (points, 3). A row of NaN separates
            single swings. Empty if the rows are too far apart.
        controls: x, y, z in m of the control point of the quadratic curve from each point of the
            line to the next, shape (points, 3). NaN where the line is straight.
        swings: number of single swings in the line; 0 if it shows the whole motion.
        plane_t: times in s of `plane`.
        plane: azimuth of the swing plane in degrees, from east to north, modulo 180.
        transit_t: times of the transits in s.
        transit_x: x at the transits in m.
        directions: +1 where xdot changes from - to +, otherwise -1.
    """

    name: str
    length: float
    t: Array = field(repr=False)
    rows: Array = field(repr=False)
    line: Array = field(repr=False)
    controls: Array = field(repr=False)
    swings: int
    plane_t: Array = field(repr=False)
    plane: Array = field(repr=False)
    transit_t: Array = field(repr=False)
    transit_x: Array = field(repr=False)
    directions: Array = field(repr=False)

    @property
    def wide(self) -> bool:
        """True if the swing is too wide to be shown from above alone."""
        return bool(self.length) and bool((self.rows[:, 2] > _WIDE * self.length).any())

    @classmethod
    def of_golden(cls, golden: Golden | Solution, until: float = np.inf) -> PicturedMotion:
        """Return the motion of a golden dataset or a solution, up to a time in s.

        If its rows are too far apart for a line, single swings are computed in double precision.
        """
        t = golden.t[golden.t <= until]
        states = np.column_stack([golden.grid[column][: len(t)] for column in STATE])
        positions = states[:, :3]
        length = float(golden.scene.exact.length)

        moves = np.ptp(positions, axis=0).max() > _AT_REST * length
        gauge = _gauge(golden) if moves else None
        line, controls, swings = _line(golden.scene, t, states, gauge)
        if gauge is None:
            plane = np.full(len(states), np.nan)
        else:
            plane = np.degrees(gauge.swing_plane(states))
        swinging = np.isfinite(plane)

        transits = golden.transits
        shown = transits["t"] <= until
        return cls(
            name=golden.manifest.id if isinstance(golden, Golden) else golden.scene.id,
            length=length,
            t=t,
            rows=positions,
            line=line,
            controls=controls,
            swings=swings,
            plane_t=t[swinging],
            plane=plane[swinging],
            transit_t=transits["t"][shown],
            transit_x=transits["x"][shown],
            directions=np.array(golden.directions, int)[shown],
        )

    @classmethod
    def of_candidate(cls, candidate: Candidate) -> PicturedMotion:
        """Return the motion of a candidate; its swing plane is the longest axis of nearby rows."""
        columns = candidate.columns
        unknown = np.full(len(columns["x"]), np.nan)
        rows = np.column_stack([columns["x"], columns["y"], columns.get("z", unknown)])
        length = float(np.sqrt((rows**2).sum(axis=1)).max()) if "z" in columns else 0.0
        line = thinned(rows, MOST) if _is_line(rows) else rows[:0]
        plane_t, plane = _axes(candidate.t, rows)
        return cls(
            name=candidate.name,
            length=length,
            t=candidate.t,
            rows=rows,
            line=line,
            controls=np.full_like(line, np.nan),
            swings=0,
            plane_t=plane_t,
            plane=plane,
            transit_t=np.empty(0),
            transit_x=np.empty(0),
            directions=np.empty(0),
        )


def _gauge(golden: Golden | Solution) -> Gauge | None:
    """Return the gauge of the swing plane.

    None if drag is so strong that the bob does not swing.
    """
    gauge = gauge_of(golden.scene)
    return gauge if gauge and golden.scene.exact.drag < 2 * gauge.omega else None


def thinned(values: Array, most: int) -> Array:
    """Return at most `most` rows, evenly spread, the first and the last among them."""
    if len(values) <= most:
        return values
    return np.asarray(values[np.linspace(0, len(values) - 1, most).round().astype(int)])


def _line(scene: Scene, t: Array, states: Array, gauge: Gauge | None) -> tuple[Array, Array, int]:
    """Return the points and the control points of the line, and how many single swings it shows."""
    if gauge is None or t[1] * POINTS <= _COARSE * gauge.period:
        return *_through(t, states), 0
    swing = np.linspace(0.0, gauge.period, POINTS + 1)
    last_start = float(t[-1]) - gauge.period
    if last_start > SWINGS * gauge.period:
        starts = np.linspace(0.0, last_start, SWINGS)
    else:
        starts = np.arange(0.0, last_start, gauge.period)

    times, index = np.unique(starts[:, None] + swing, return_inverse=True)
    try:
        points = trajectory(scene, times)[:, :3]
    except FoucaultError:
        return *_through(t, states), 0
    lines = points[index.reshape(len(starts), -1)]
    gaps = np.full((len(starts), 1, 3), np.nan)
    line = np.concatenate([lines, gaps], axis=1).reshape(-1, 3)
    return line, np.full_like(line, np.nan), len(starts)


def _through(t: Array, states: Array) -> tuple[Array, Array]:
    """Return the points of a line through states, and its control points.

    A quadratic curve has one control point, for which its two tangents need not agree: it is the
    mean of the points that half a step leads to along the velocities at both ends. A curve that the
    eye cannot tell from its chord has none.
    """
    states = thinned(states, MOST)
    half_s = np.diff(thinned(t, MOST))[:, None] / 2
    position = states[:, :3]
    velocity = states[:, 3:]
    ahead = position[:-1] + half_s * velocity[:-1]
    back = position[1:] - half_s * velocity[1:]
    controls = (ahead + back) / 2

    chord_middles = (position[:-1] + position[1:]) / 2
    # a quadratic curve goes half as far from its chord as its control point
    heights = np.linalg.norm(controls - chord_middles, axis=1) / 2
    # the length of the cord would hide what is bent in a small swing
    size = np.abs(position[:, :2]).max()
    controls[heights <= _STRAIGHT * size] = np.nan
    # no curve begins at the last point
    return position, np.concatenate([controls, np.full((1, 3), np.nan)])


def _is_line(rows: Array) -> bool:
    """Return whether the rows are so close together that a line through them follows the path."""
    steps = np.diff(rows[:, :2], axis=0)
    lengths = np.hypot(*steps.T)
    bends = np.hypot(*np.diff(steps, axis=0).T)
    return len(bends) > 0 and float(np.median(bends)) <= _BENT * float(np.median(lengths))


def _axes(t: Array, rows: Array) -> tuple[Array, Array]:
    """Return times in s and azimuths in degrees of the longest axis in each window of rows."""
    windows = np.array_split(np.arange(len(t)), max(1, len(t) // _WINDOW))
    centre = rows[:, :2].mean(axis=0)
    times = []
    angles = []
    for window in windows:
        offsets = rows[window, :2] - centre
        sizes, axes = np.linalg.eigh(offsets.T @ offsets)
        if len(window) > 2 and sizes[0] <= _FLAT**2 * sizes[1] and sizes[1] > 0:
            times.append(float(t[window].mean()))
            angles.append(float(np.degrees(np.arctan2(axes[1, 1], axes[0, 1]))))
    return np.array(times), (np.array(angles) + 90) % 180 - 90
