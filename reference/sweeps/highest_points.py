"""Frequency and precession of rows from their highest points, and estimates of their errors.

Intervals for one solved scene: solver/swing.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from ..engines.batch_interface import LEAST_BEND, Outcomes, PlumbAxes, Rows, turned
from ..engines.row_zeros import RowMotion
from ..model.algebra import add, cross
from ..model.constants import Constants
from ..numbers.columns import POSITION, SECTION, STATE
from ..numbers.double_double import DoubleDouble
from ..numbers.precision import Array
from ..numbers.table import Table
from ..solver.solution import Solution

HIGHEST = "highest"  # the section from which the swing follows
# of half a swing, or of half a turn: with larger errors of times or azimuths there is no frequency,
# or no precession
LATE = 0.25
DEGREES_PER_HOUR = np.degrees(1.0) * 3600
_OFFSETS = 3.0  # of the rest position from the plumb line; see `_may_come_in_pairs`
_SWAYS = (
    2.0 / 3.0
)  # over cos² of a cone's angle, of Ω/ω sin² of it: how far the Coriolis force sways the cone
_GOLDEN = (np.sqrt(5.0) - 1) / 2
_SOON = (
    1e-4  # of a radian of the swing: a highest point so soon after the release may be the release
)


def swing_and_precession(run: Outcomes) -> tuple[Array, Array]:
    """Return frequency in Hz and precession in degrees an hour; NaN without two highest points."""
    span = run.apsis_last - run.apsis_first
    return (run.apsides - 1) / (2 * span), run.turn / span * DEGREES_PER_HOUR


def errors_of_swing(
    rows: Rows, run: Outcomes, position: Array, velocity: Array
) -> tuple[Array, Array]:
    """Estimate the errors of the swing's frequency in Hz and of the precession in degrees an hour.

    Let u be the height of the bob over l. At a highest point u' is wrong by the velocity's error
    times sin θ, and by the speed at which the bob passes times the position's error. Divided by u''
    this is the error of the point's time, in which the bob turns about the plumb line. Over the top
    sin θ may be almost 0, while u'' is not.

    Args:
        rows: the rows.
        run: their results.
        position: error of the position, in m.
        velocity: error of the velocity, in m/s.
    """
    length = rows.length[:, 0]
    rate = rows.rate
    turn = np.linalg.norm(rows.turn[..., 0], axis=1)
    weakest = rate * np.sqrt(run.least_fall * run.least_bend)  # u'' over sin θ
    highest_sine = np.sin(run.largest_angle)
    least_sine = _least_sine(rows, run)

    # Below 45° the bob passes a highest point no faster than on a cone, as seen from the Earth.
    # Above, its energy bounds the speed; the bob seldom reaches this bound.
    is_low = run.largest_angle < np.pi / 4
    cone_rate = 2 * (rate + 2 * turn)
    offset_rate = 2 * turn**2 / rate
    fastest = fastest_of(rows) + turn

    passing = np.where(
        is_low,
        cone_rate / weakest + offset_rate / run.least_fall,
        fastest / run.least_fall,
    )
    of_velocity = velocity * np.fmin(1 / weakest, 1 / run.least_fall)
    time_error = (of_velocity + passing * position) / length + np.spacing(run.apsis_last)

    turn_rate = np.where(is_low, cone_rate + offset_rate / least_sine, fastest / highest_sine)
    azimuth_error = position / (length * least_sine) + turn_rate * time_error
    return _errors_of_highest(run, time_error, azimuth_error)


def _least_sine(rows: Rows, run: Outcomes) -> Array:
    """Return sin θ at the lowest of the highest points, which drag lets shrink until the end."""
    shrunk = np.exp(-rows.drag[:, 0] * rows.t_end[:, 0] / 2)
    at_end = np.sin(np.fmin(run.largest_angle, np.pi / 2)) * shrunk
    return np.asarray(np.fmin(np.sin(run.largest_angle), at_end))


def _errors_of_highest(
    run: Outcomes, time_error: Array, azimuth_error: Array
) -> tuple[Array, Array]:
    """Return the errors of frequency in Hz and precession in degrees an hour.

    `time_error` in s and `azimuth_error` in rad are those of each highest point. Both results are
    NaN where the times are too uncertain to count the points. The error of the precession is NaN
    too where the azimuths are too uncertain to follow the swing plane.
    """
    span = run.apsis_last - run.apsis_first
    gaps = run.apsides - 1
    is_counted = (gaps > 0) & (gaps * time_error < LATE * span)
    is_followed = azimuth_error < LATE * np.pi

    frequency_error = gaps * time_error / span**2
    drift_error = 2 * azimuth_error / span + np.abs(run.turn) * 2 * time_error / span**2
    drift_error = np.where(is_followed, drift_error, np.nan)
    return (
        np.where(is_counted, frequency_error, np.nan),
        np.where(is_counted, drift_error * DEGREES_PER_HOUR, np.nan),
    )


def unsure_of_highest(rows: Rows, run: Outcomes, position: Array, velocity: Array) -> Array:
    """Return the rows whose number of highest points is uncertain; the errors are in m and m/s."""
    has_points = run.apsides > 0
    at_end = has_points & _may_be_highest_at_end(rows, run, position, velocity)
    # the bend consists of two squares, each wrong by twice the relative error of the position
    least_bend_m = LEAST_BEND * rows.length[:, 0] * np.sin(run.largest_angle)
    no_cone = ~has_points & (4 * position >= least_bend_m)
    return np.asarray(at_end | _may_come_in_pairs(rows, run) | no_cone)


def _may_be_highest_at_end(rows: Rows, run: Outcomes, position: Array, velocity: Array) -> Array:
    """Return where a highest point may lie on either side of the end: the bob may rise or fall."""
    length = rows.length[:, 0]
    down = _down(rows)
    n = run.state[:, :3] / length[:, None]
    v = run.state[:, 3:]
    sine = np.linalg.norm(np.cross(n, down), axis=1) + position / length
    speed = np.linalg.norm(v, axis=1)
    fall_error = velocity * sine + speed * position / length
    return np.asarray(np.abs((v * down).sum(axis=1)) <= fall_error)


def _may_come_in_pairs(rows: Rows, run: Outcomes) -> Array:
    """Return where pairs of highest points may come and go without being seen.

    Highest points are seen from the plumb line, which is off the middle of the swing by some d,
    since the centrifugal force moves the rest position. An orbit with semi-axes a and b has two
    highest points a turn if it is seen from inside the ellipse's evolute, and one if from outside;
    d < a - b is inside. On the evolute the bend at a highest point times its distance is at most
    (3ad - d²)/(a + d) < 3d: above 3d no pair comes or goes.

    On a cone of angle θ the Coriolis force sways the angle by cos φ as well, by 2/3 Ω/ω_c sin²
    θ/cos² θ with ω_c² = ω²/cos θ. The same holds with this added to d, times ω_c²/ω². Of θ the
    largest angle is known, and the spin s ω about the line: from s² = sin⁴ θ/cos θ follows that cos
    θ is above 1/(1 + s²) or above the golden section.
    """
    down = _down(rows)
    turn = rows.turn[..., 0]
    sway = np.linalg.norm(np.cross(turn, down), axis=1) / rows.rate**2
    offset = np.abs((turn * down).sum(axis=1)) * sway
    spin = np.abs((np.cross(rows.n[..., 0], rows.V[..., 0]) * down).sum(axis=1))

    by_spin = np.fmin(_GOLDEN, rows.rate**2 / (rows.rate**2 + spin**2))
    least_cosine = np.fmax(np.cos(run.largest_angle), by_spin)
    bend = np.where(run.apsides > 0, run.least_bend, 1) * np.sin(run.largest_angle)
    return np.asarray(bend < _OFFSETS * (offset + _SWAYS * sway * spin / least_cosine**2))


def _down(rows: Rows) -> Array:
    """Return the unit vector along c, down the plumb line, shape (n, 3)."""
    return np.asarray(rows.pull[..., 0] / rows.rate[:, None] ** 2)


def fastest_of(rows: Rows) -> Array:
    """Return a bound of the speed over l in axes that do not turn, in 1/s: at the lowest point."""
    n = rows.n[..., 0]
    V = rows.V[..., 0]
    pull = rows.pull[..., 0]
    # height of the release over the lowest point
    height = np.fmax(1 - (n * pull).sum(axis=1) / rows.rate**2, 0.0)
    return np.asarray(rows.rate * np.sqrt(2 * height) + np.linalg.norm(V, axis=1))


@dataclass(frozen=True)
class SolvedPoints:
    """The highest points of a single row that the solver solved, in the axes of the plumb line.

    The arrays `azimuth` to `fall` hold the release, the highest points after it, and the end.

    Attributes:
        rows: the row.
        table: times and states of the highest points, with their bounds; empty if they were not
            asked for.
        decided: whether these are all highest points.
        length: of the cord in m.
        azimuth: about the plumb line, from east to north, in rad.
        across: distance from the plumb line over l.
        angle: from the plumb line, in rad.
        rise: rate of the height over l, u', in 1/s.
        fall: -u'', in 1/s².
    """

    rows: Rows
    table: Table
    decided: bool
    length: float
    azimuth: Array
    across: Array
    angle: Array
    rise: Array
    fall: Array

    @classmethod
    def of(cls, solution: Solution, rows: Rows) -> Self:
        """Return the highest points of a solution, whose constants and release are `rows`."""
        section = solution.sections.get(HIGHEST)
        table = section.table if section else Table(SECTION, 0, [])
        motion = _motion(solution, rows, table)
        x, p, u = motion.n
        across = np.hypot(x, p)
        return cls(
            rows=rows,
            table=table,
            decided=section is not None and not section.possible,
            length=float(solution.scene.exact.length),
            azimuth=np.arctan2(p, x),
            across=across,
            angle=np.arctan2(across, -u),
            rise=motion.v[2],
            fall=-motion.a[2],
        )

    @property
    def is_bent(self) -> Array:
        """Whether the bob clearly falls from each point instead of circling on a cone."""
        return np.asarray(self.fall > LEAST_BEND * (self.rows.rate * self.across) ** 2)

    @property
    def release_counts(self) -> bool:
        """Whether the first highest point cannot be distinguished from the release.

        By the exact inputs the bob rises there. The release then counts as that point.
        """
        soon = _SOON / self.rows.rate
        slow = abs(self.rise[0]) < soon * self.fall[0]
        another = self.table["t"][:1] < 2 * soon
        return bool(self.rows.rising[0] > 0 and slow and not another.any())

    def fill(self, run: Outcomes) -> None:
        """Fill in the largest angle, and the highest points if they are decided and the motion is not conical."""
        run.largest_angle[0] = self.angle.max()
        first = 0 if self.release_counts else 1
        times = np.append(0.0, self.table["t"])[first:]
        if not (self.decided and len(times) and self.is_bent[first:-1].all()):
            return
        azimuth = self.azimuth[first:-1]
        half_turns = np.round(np.diff(azimuth) / np.pi)
        run.apsides[0] = len(times)
        run.apsis_first[0] = times[0]
        run.apsis_last[0] = times[-1]
        run.turn[0] = azimuth[-1] - azimuth[0] - np.pi * np.sum(half_turns)
        run.same_side[0] = np.count_nonzero(half_turns % 2 == 0)

    def errors_of_swing(self, run: Outcomes) -> tuple[Array, Array]:
        """Return the errors of frequency in Hz and precession in degrees an hour."""
        time_bounds = np.array(self.table.bound("t"), float)
        time_error = np.max(time_bounds, initial=0) + np.spacing(run.apsis_last)
        turns = self._position_bounds / (self.across[1:-1] * self.length)
        azimuth_error = np.max(turns, initial=0) + np.spacing(2 * np.pi)
        return _errors_of_highest(run, time_error, azimuth_error)

    def error_of_angle(self, run: Outcomes, grid_error: Array) -> Array:
        """Return the error of the largest angle in rad; NaN where a higher point may be missing.

        The time of a grazing highest point has no bound, and neither has its position. Then the
        angle has the error of the grid's positions, `grid_error` in m, shape (1,).
        """
        largest = np.max(self._position_bounds, initial=grid_error[0])
        error_m = np.where(largest < self.length, largest, grid_error)
        error = error_m / self.length + np.spacing(run.largest_angle)
        is_complete = self.decided or not self.is_bent.any()
        return np.where(is_complete, error, np.nan)

    @property
    def _position_bounds(self) -> Array:
        """Bounds on the errors of the highest points' positions, in m."""
        bounds = [np.array(self.table.bound(name), float) for name in POSITION]
        return np.asarray(np.linalg.norm(bounds, axis=0))


def _motion(solution: Solution, rows: Rows, points: Table) -> RowMotion:
    """Return the motion at release, highest points and end, in the axes of the plumb line."""
    length = solution.scene.exact.length
    grid = solution.grid
    states = []
    for name in STATE:
        at_grid = grid.exact(name)
        values = (at_grid[0], *points.exact(name), at_grid[-1])
        states.append(DoubleDouble.of(value / length for value in values))

    axes = PlumbAxes.of(rows)
    vectors = []
    for east, north, up in (states[:3], states[3:]):
        along, height = turned(north, up, axes.sin, axes.cos)
        vectors.append((east.high, along.high, height.high))
    n, v = vectors

    turn = (0, axes.turn[0].high, axes.turn[1].high)
    k = Constants(turn=turn, pull=(0, 0, -axes.size.high), drag=rows.drag[:, 0])
    momentum = cross(n, add(v, cross(turn, n)))
    return RowMotion.of([*n, *momentum], k)
