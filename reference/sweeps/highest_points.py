"""Frequency and precession of rows in double, from their highest points, and how far both may be off.

Exact numbers of one solved scene: solver/swing.py.
"""

from __future__ import annotations

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

HIGHEST = "highest"  # the section that tells the swing
# of half a swing or turn: transits and highest points that may be as far off have no frequency
LATE = 0.25
OFFSETS = 3.0  # of the rest position from the plumb line; see `unsure_of_highest`
# over cos² of a cone's angle, of Ω/ω sin² of it: how far the Coriolis force sways the cone
SWAYS = 2.0 / 3.0
GOLDEN = (np.sqrt(5.0) - 1) / 2
SOON = 1e-4  # of a radian of the swing after the release
DEGREES_PER_HOUR = np.degrees(1.0) * 3600


def swing_and_precession(run: Outcomes) -> tuple[Array, Array]:
    """Return frequency in Hz and precession in degrees an hour of rows; NaN with fewer than two highest points."""
    span = run.apsis_last - run.apsis_first
    return (run.apsides - 1) / (2 * span), run.turn / span * DEGREES_PER_HOUR


def errors_of_swing(
    rows: Rows, run: Outcomes, position: Array, velocity: Array
) -> tuple[Array, Array]:
    """Return the errors of the swing's frequency and of the precession.

    With u the height of the bob over l, u' is wrong at a highest point by the velocity's error times sin θ, and where
    the bob passes, by its speed times the position's error; that over u'' is how late the point is, and the bob turns
    about the plumb line meanwhile. Over the top, sin θ may be next to nothing, and u'' is not.
    """
    length, rate, turn = rows.length[:, 0], rows.rate, np.linalg.norm(rows.turn[..., 0], axis=1)
    # amplitude at the end, over the largest
    shrunk = np.exp(-rows.drag[:, 0] * rows.t_end[:, 0] / 2)
    highest = np.sin(run.largest_angle)
    sine = np.fmin(highest, np.sin(np.fmin(run.largest_angle, np.pi / 2)) * shrunk)
    weakest = rate * np.sqrt(run.least_fall * run.least_bend)  # u'' over sin θ
    # a point that is not high passes no faster than on a cone, seen from the Earth: seldom as fast as the energy allows
    low, round_, offset = run.largest_angle < np.pi / 4, 2 * (rate + 2 * turn), 2 * turn**2 / rate
    fastest = fastest_of(rows) + turn
    passing = np.where(low, round_ / weakest + offset / run.least_fall, fastest / run.least_fall)
    slow = velocity * np.fmin(1 / weakest, 1 / run.least_fall)
    late = (slow + passing * position) / length + np.spacing(run.apsis_last)
    turned = (
        position / (length * sine) + np.where(low, round_ + offset / sine, fastest / highest) * late
    )
    return errors_of_highest(run, late, turned)


def errors_of_highest(run: Outcomes, late: Array, turned: Array) -> tuple[Array, Array]:
    """Return the errors of frequency and precession of highest points that may be so late, in s, and turned, in rad.

    Both are NaN where a point may be so late that it cannot be counted, that of precession where it cannot be followed.
    """
    span, gaps = run.apsis_last - run.apsis_first, run.apsides - 1
    counted = (gaps > 0) & (gaps * late < LATE * span)
    drift = np.where(
        turned < LATE * np.pi, 2 * turned / span + np.abs(run.turn) * 2 * late / span**2, np.nan
    )
    return np.where(counted, gaps * late / span**2, np.nan), np.where(
        counted, drift * DEGREES_PER_HOUR, np.nan
    )


def unsure_of_highest(rows: Rows, run: Outcomes, position: Array, velocity: Array) -> Array:
    """Return where a highest point may lie on either side of the end, or where pairs of them may come and go unseen.

    Highest points are seen from the plumb line, which is off the middle of the swing by some d: at rest by the
    centrifugal force. From inside the ellipse's evolute an orbit with semi-axes a, b shows two a turn, from outside
    one, and d < a - b is inside. There the bend at the highest, times its distance, is at most (3ad - d²)/(a + d),
    below 3d, so that 3d tell the ones from the others. On a cone of angle θ the Coriolis force sways the angle by
    cos φ as well, by 2/3 Ω/ω_c sin² θ/cos² θ, ω_c² = ω²/cos θ, and the same holds with this added to d, times
    ω_c²/ω². Of θ are known the largest angle and the spin s ω about the line: with s² = sin⁴ θ/cos θ, cos θ is above
    1/(1 + s²) or the golden section. And a cone is one only where the error of its bend leaves it so.
    """
    length, down = rows.length[:, 0], rows.pull[..., 0] / rows.rate[:, None] ** 2
    n, v = run.state[:, :3] / length[:, None], run.state[:, 3:]
    sine, speed = (
        np.linalg.norm(np.cross(n, down), axis=1) + position / length,
        np.linalg.norm(v, axis=1),
    )
    at_end = np.abs((v * down).sum(axis=1)) <= velocity * sine + speed * position / length
    turn, has_apsides, lean = rows.turn[..., 0], run.apsides > 0, np.sin(run.largest_angle)
    across = np.linalg.norm(np.cross(turn, down), axis=1) / rows.rate**2
    offset = np.abs((turn * down).sum(axis=1)) * across
    spun = np.abs((np.cross(rows.n[..., 0], rows.V[..., 0]) * down).sum(axis=1))
    upright = np.fmax(
        np.cos(run.largest_angle), np.fmin(GOLDEN, rows.rate**2 / (rows.rate**2 + spun**2))
    )
    near = np.where(has_apsides, run.least_bend, 1) * lean < OFFSETS * (
        offset + SWAYS * across * spun / upright**2
    )
    # of two squares, each twice its relative error
    round_ = ~has_apsides & (4 * position >= LEAST_BEND * length * lean)
    return np.asarray(has_apsides & at_end | near | round_)


def fastest_of(rows: Rows) -> Array:
    """Return a speed over l, seen in axes that do not turn, that no row exceeds: all its energy at the lowest point."""
    n, V, pull, rate = rows.n[..., 0], rows.V[..., 0], rows.pull[..., 0], rows.rate
    # of the release over the lowest point
    above = np.fmax(1 - (n * pull).sum(axis=1) / rate**2, 0.0)
    return np.asarray(rate * np.sqrt(2 * above) + np.linalg.norm(V, axis=1))


def note_highest_points(
    run: Outcomes, rows: Rows, solution: Solution, position: Array
) -> tuple[Array, Array, Array]:
    """Fill in the highest points and the largest angle, also of release and end; return the errors of what they tell.

    These are those of frequency and precession, as in `Errors`, and of the angle in rad. Where a highest point grazes,
    its time has no bound, and its angle that of the grid, `position` in m. One so soon after the release that no digit
    tells it, as the exact inputs do, counts as the release. On a cone, which has none, release and end tell the angle.
    """
    section, grid, axes = solution.sections.get(HIGHEST), solution.grid, PlumbAxes.of(rows)
    decided, points = (
        section and not section.possible,
        section.table if section else Table(SECTION, 0, []),
    )
    length, turn = solution.scene.exact.length, (0, axes.turn[0].high, axes.turn[1].high)
    states = [
        DoubleDouble.of(
            q / length for q in (grid.exact(name)[0], *points.exact(name), grid.exact(name)[-1])
        )
        for name in STATE
    ]
    n, v = (
        (east.high, *(part.high for part in turned(north, up, axes.sin, axes.cos)))
        for east, north, up in (states[:3], states[3:])
    )
    k = Constants(turn=turn, pull=(0, 0, -axes.size.high), drag=rows.drag[:, 0])
    motion = RowMotion.of([*n, *cross(n, add(v, cross(turn, n)))], k)
    (x, p, u), fall = motion.n, -motion.a[2]
    across, azimuth = np.hypot(x, p), np.arctan2(p, x)
    run.largest_angle[0] = np.arctan2(across, -u).max()
    t, soon = np.append(0.0, points["t"]), SOON / rows.rate
    unresolved = (
        rows.rising[0] > 0
        and abs(motion.v[2][0]) < soon * fall[0]
        and not (t[1:2] < 2 * soon).any()
    )
    high = slice(0 if unresolved else 1, -1)
    t, azimuth = t[high.start :], azimuth[high]
    bent = fall > LEAST_BEND * (rows.rate * across) ** 2
    if decided and len(t) and bent[high].all():
        run.apsides[0], run.apsis_first[0], run.apsis_last[0] = len(t), t[0], t[-1]
        half_turns = np.round(np.diff(azimuth) / np.pi)
        run.turn[0] = azimuth[-1] - azimuth[0] - np.pi * np.sum(half_turns)
        run.same_side[0] = np.count_nonzero(half_turns % 2 == 0)
    late = np.max(np.array(points.bound("t"), float), initial=0) + np.spacing(run.apsis_last)
    off = np.linalg.norm([np.array(points.bound(name), float) for name in POSITION], axis=0)
    aside = np.max(off / (across[1:-1] * float(length)), initial=0) + np.spacing(2 * np.pi)
    reach = np.max(off, initial=position[0])
    leaning = np.where(reach < length, reach, position) / float(length) + np.spacing(
        run.largest_angle
    )
    return *errors_of_highest(run, late, aside), np.where(
        decided or not bent.any(), leaning, np.nan
    )
