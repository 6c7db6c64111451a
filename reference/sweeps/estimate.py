"""How large the error of a row is: from a second run of another order, with every constant and start moved by an ulp.

`columns_of` makes the columns of rows from results and errors: no value without its error.

Both runs round differently everywhere, the constants included, so that their difference is of the size of the error.
It may be smaller by chance: therefore the factor, and a least difference, what half an ulp in the constants may do.
Where errors have grown to many ulps, or where the bob has the energy to rise to the pivot and they may grow, they point
one way, and the two may cancel. There a third run is moved the other way, and the factor is larger.

`pytest --long tests/campaigns/test_sweeps.py -k error` holds 3,500 random rows of 600 s, 500 of them over the top or
beyond the horizontal, against limbs at 110 bits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..engines.batch_interface import LEAST_BEND, OK, STOPPED, XDOT, Batch, Outcomes, Rows, RunOptions
from ..model.sections import direction_of
from ..numbers.precision import Array
from .parquet import COLUMNS, STATE_COLUMNS, Column, section_columns

FACTOR = 16.0
WILD_FACTOR = 64.0  # where there are three runs
LEAST_ULPS = 4.0  # of the cord length: the two runs may agree by chance
GOLDEN = (np.sqrt(5.0) - 1) / 2
HALF_ULP = 2.0**-53  # of a number just above 1, relative
GROWN = 1e-12  # of the cord length: an estimate above it takes the third run
OFFSETS = 3.0  # of the rest position from the plumb line; see `_unsure_of_highest`
SWAYS = 2.0 / 3.0  # over cos² of a cone's angle, of Ω/ω sin² of it: how far the Coriolis force sways the cone
LATE = 0.25  # of half a swing or turn: transits and highest points that may be as far off have no frequency
HEIGHT = FACTOR * LEAST_ULPS * HALF_ULP  # what rounding may do to a height over the cord length
DEGREES_PER_HOUR = np.degrees(1.0) * 3600
MOVED, MOVED_BACK = (RunOptions(transits=False, apsides=False, moved=way) for way in (1, -1))
PASSAGES = RunOptions(apsides=False, times=True, form=True)


@dataclass(frozen=True)
class Errors:
    """Estimated errors, shape (n,); NaN where there is no such number.

    Attributes:
        position: of the position at t_end, in m.
        velocity: of the velocity at t_end and at the transits, in m/s.
        transit: of the worst transit's time, in s.
        frequency, swing: of both frequencies, in Hz.
        precession: in degrees an hour.
        angle: of the largest angle, in degrees.
        undecided: where the number of transits hangs on these errors.
        unsure_of_highest: where that of highest points does.
    """

    position: Array
    velocity: Array
    transit: Array
    frequency: Array
    swing: Array
    precession: Array
    angle: Array
    undecided: Array
    unsure_of_highest: Array


def judged(engine: Batch, rows: Rows, run: Outcomes) -> tuple[Errors, Any]:
    """Return the errors of a run, and which rows stop where they are moved: at least one more run, by its engine."""
    moved = engine.solve(rows, MOVED)
    estimated, stopped = errors(rows, run, moved), moved.fate == STOPPED
    n, V, pull = rows.n[..., 0], rows.V[..., 0], rows.pull[..., 0]
    reaches_the_pivot = (V * V).sum(axis=1) / 2 >= (n * pull).sum(axis=1)
    wild = ~(estimated.position <= GROWN * rows.length[:, 0]) | reaches_the_pivot
    grown = np.flatnonzero(~stopped & wild)
    if not len(grown):
        return estimated, stopped
    back = engine.solve(rows[grown], MOVED_BACK)
    rate, state = rows.rate[grown, None], moved.state.copy()
    gaps = [np.abs(other - run.state[grown]) for other in (state[grown], back.state)]
    near, far = (np.linalg.norm(rate * gap[:, :3], axis=1) + np.linalg.norm(gap[:, 3:], axis=1) for gap in gaps)
    state[grown[far > near]] = back.state[far > near]
    stopped[grown] |= back.fate == STOPPED
    return errors(rows, run, replace(moved, state=state), np.where(wild, WILD_FACTOR, FACTOR)), stopped


def errors(rows: Rows, run: Outcomes, moved: Outcomes, factor: Array | float = FACTOR) -> Errors:
    """Return the errors of a run, from the run that was moved, and what their difference is multiplied by."""
    length, rate = rows.length[:, 0], rows.rate
    gap = run.state - moved.state
    position, velocity = np.linalg.norm(gap[:, :3], axis=1), np.linalg.norm(gap[:, 3:], axis=1)
    ulp = LEAST_ULPS * np.spacing(length) + _of_constants(rows)
    speed = np.linalg.norm(run.state[:, 3:], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        # where a swing is late its position tells at the lowest point, its velocity at the highest
        position = factor * np.fmax(position, np.fmax(np.where(rate > 0, velocity / rate, 0.0), ulp))
        velocity = factor * np.fmax(velocity, np.fmax(rate * position / factor, LEAST_ULPS * np.spacing(speed)))
        transit, undecided = _of_zeros(rows, run, position, velocity)
        span = run.t_last - run.t_first
        share = (run.transits - 1) * transit / span
        swing, precession = _of_swing(rows, run, position, velocity)
    return Errors(
        position=position,
        velocity=velocity,
        transit=transit,
        frequency=np.where((run.transits > 1) & (share < LATE), share / span, np.nan),
        swing=swing,
        precession=precession,
        # the height, which rounds to about an ulp, tells little of an angle next to the top
        angle=np.degrees(position / length + np.fmin(HEIGHT * np.tan(run.largest_angle / 2), np.sqrt(2 * HEIGHT))),
        undecided=undecided,
        unsure_of_highest=_unsure_of_highest(rows, run, position, velocity),
    )


def _of_constants(rows: Rows) -> Array:
    """Return how far constants that are off by half an ulp may turn a swing in the whole span, in m."""
    rate = rows.rate
    reach = np.fmin(_fastest(rows) / rate, 1.0)
    turned: Array = rows.length[:, 0] * reach * rate * rows.t_end[:, 0] * HALF_ULP
    return np.where(rate > 0, turned, 0.0)


def _fastest(rows: Rows) -> Array:
    """Return a speed over l, seen in axes that do not turn, that no row exceeds: all its energy at the lowest point."""
    n, V, pull, rate = rows.n[..., 0], rows.V[..., 0], rows.pull[..., 0], rows.rate
    above = np.fmax(1 - (n * pull).sum(axis=1) / rate**2, 0.0)  # of the release over the lowest point
    return np.asarray(rate * np.sqrt(2 * above) + np.linalg.norm(V, axis=1))


def _of_swing(rows: Rows, run: Outcomes, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Return the errors of the swing's frequency and of the precession.

    With u the height of the bob over l, u' is wrong at a highest point by the velocity's error times sin θ, and where
    the bob passes, by its speed times the position's error; that over u'' is how late the point is, and the bob turns
    about the plumb line meanwhile. Over the top, sin θ may be next to nothing, and u'' is not.
    """
    length, rate, turn = rows.length[:, 0], rows.rate, np.linalg.norm(rows.turn[..., 0], axis=1)
    shrunk = np.exp(-rows.drag[:, 0] * rows.t_end[:, 0] / 2)  # amplitude at the end, over the largest
    highest = np.sin(run.largest_angle)
    sine = np.fmin(highest, np.sin(np.fmin(run.largest_angle, np.pi / 2)) * shrunk)
    weakest = rate * np.sqrt(run.least_fall * run.least_bend)  # u'' over sin θ
    # a point that is not high passes no faster than on a cone, seen from the Earth: seldom as fast as the energy allows
    low, round_, offset = run.largest_angle < np.pi / 4, 2 * (rate + 2 * turn), 2 * turn**2 / rate
    fastest = _fastest(rows) + turn
    passing = np.where(low, round_ / weakest + offset / run.least_fall, fastest / run.least_fall)
    slow = velocity * np.fmin(1 / weakest, 1 / run.least_fall)
    late = (slow + passing * position) / length + np.spacing(run.apsis_last)
    turned = position / (length * sine) + np.where(low, round_ + offset / sine, fastest / highest) * late
    return of_swing(run, late, turned)


def of_swing(run: Outcomes, late: Array, turned: Array) -> tuple[Array, Array]:
    """Return the errors of frequency and precession of highest points that may be so late, in s, and turned, in rad.

    Both are NaN where a point may be so late that it cannot be counted, that of precession where it cannot be followed.
    """
    span, gaps = run.apsis_last - run.apsis_first, run.apsides - 1
    counted = (gaps > 0) & (gaps * late < LATE * span)
    drift = np.where(turned < LATE * np.pi, 2 * turned / span + np.abs(run.turn) * 2 * late / span**2, np.nan)
    return np.where(counted, gaps * late / span**2, np.nan), np.where(counted, drift * DEGREES_PER_HOUR, np.nan)


def _of_zeros(
    rows: Rows, run: Outcomes, position: Array, velocity: Array, vertical: bool = False
) -> tuple[Array, Array]:
    """Return the error of the worst transit's time, and where one may lie beyond the end, or a close pair be none.

    Of a section likewise, from how wrong its form may be; `vertical` says that it is the rate of the height, of which
    a velocity's error is the part along the sphere, and a position's turns the velocity.
    """
    length, speed = rows.length[:, 0], np.linalg.norm(run.state[:, 3:], axis=1)
    form, state = rows.form[..., 0], run.state
    value = (form[:, :3] * state[:, :3]).sum(axis=1) + (form[:, 3:6] * state[:, 3:]).sum(axis=1) - form[:, 6] * length
    of_place, of_velocity = (np.linalg.norm(part, axis=1) for part in (form[:, :3], form[:, 3:6]))
    fastest = rows.rate + np.fmax(speed / length, np.linalg.norm(rows.V[..., 0], axis=1))
    sine = np.where(run.largest_angle < np.pi / 2, np.sin(run.largest_angle), 1.0)
    off, bend = of_place * position + of_velocity * velocity, fastest**2 * length * sine
    bend = np.fmin(bend * (of_place + of_velocity * fastest), bend_of_pairs(rows, run.largest_angle))
    if vertical:
        passing = _fastest(rows) + np.linalg.norm(rows.turn[..., 0], axis=1)
        off, bend = of_velocity * (sine * velocity + passing * position), 8 * sine * bend
    pair = (run.close_pairs > 0) & (run.least_ax**2 < 4 * bend * off)
    undecided: Array = ~rows.still & ((np.abs(value) <= off) | pair)
    return off / run.least_ax + np.spacing(run.t_last), undecided


def bend_of_pairs(rows: Rows, angle: Array) -> Array:
    """Return a bound of |d²xdot/dt²| between two close transits of swings up to an angle; NaN where it is not known.

    With T the force along the cord over l, x'' = Coriolis - x T. Let M be the bound and h < π/(2ω) the time between the
    transits: |xdot| <= M h²/8 there, and x'' is zero somewhere, so that |x| <= 2Ω|v|/T + M h³/8. Below 30° T is within
    0.86 and 1.56 ω², |T'| <= 0.45 ω³, |v| <= 1.1 ω l sin θ and |a| <= 1.2 ω² l sin θ, so that three quarters of M at
    most come from M itself, and the rest is the Coriolis force's: M < 16 Ω ω² l sin θ.
    """
    turn = np.linalg.norm(rows.turn[..., 0], axis=1)
    known = (rows.form[..., 0] == XDOT).all(axis=1) & (angle < np.pi / 6) & (rows.rate > 30 * (turn + rows.drag[:, 0]))
    return np.where(known, 16 * turn * rows.rate**2 * rows.length[:, 0] * np.sin(angle), np.nan)


def passages(engine: Batch, word: str, rows: Rows, run: Outcomes, errors: Errors) -> tuple[dict[str, Any], Any]:
    """Return the columns of a section by its engine, and in which rows its passages are not decided.

    The rows are those with its form; run and errors are of those without.
    """
    zeros = replace(engine.solve(rows, PASSAGES), largest_angle=run.largest_angle)
    error, undecided = _of_zeros(rows, zeros, errors.position, errors.velocity, direction_of(word) != 0)
    columns, unknown = passages_listed(word, error, zeros.transit_row, zeros.transit_t, zeros.transit_direction)
    return columns, (zeros.fate != OK) | ~np.isfinite(rows.form).all(axis=(1, 2)) | undecided | unknown


def passages_listed(word: str, error: Array, row: Any, t: Array, direction: Any) -> tuple[dict[str, Any], Any]:
    """Return the columns of a section, and where a number has no error, from the error of each row's times.

    `row`, `t` and `direction` are those of every zero of its form, ordered by row and time.
    """
    kept = direction * direction_of(word) >= 0
    row, t, direction = row[kept], t[kept], direction[kept]
    count = np.bincount(row, minlength=len(error))
    first = np.cumsum(count) - count
    same = direction == direction[first[row]]
    alike = np.bincount(row[same], minlength=len(error))
    start = np.where(count > 0, np.append(t, np.nan)[first], np.nan)
    end = np.append(t[same], np.nan)[np.cumsum(alike) - 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        interval = np.where(alike > 1, (end - start) / (alike - 1), np.nan)
        apart = np.where(error < LATE * interval / 2, 2 * error / (alike - 1), np.nan)
        columns, arrays = section_columns([word]), (count, start, error, interval, apart)
        return _stated({column.name: values for column, values in zip(columns, arrays, strict=True)}, columns)


def _unsure_of_highest(rows: Rows, run: Outcomes, position: Array, velocity: Array) -> Array:
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
    sine, speed = np.linalg.norm(np.cross(n, down), axis=1) + position / length, np.linalg.norm(v, axis=1)
    at_end = np.abs((v * down).sum(axis=1)) <= velocity * sine + speed * position / length
    turn, has_apsides, lean = rows.turn[..., 0], run.apsides > 0, np.sin(run.largest_angle)
    across = np.linalg.norm(np.cross(turn, down), axis=1) / rows.rate**2
    offset = np.abs((turn * down).sum(axis=1)) * across
    spun = np.abs((np.cross(rows.n[..., 0], rows.V[..., 0]) * down).sum(axis=1))
    upright = np.fmax(np.cos(run.largest_angle), np.fmin(GOLDEN, rows.rate**2 / (rows.rate**2 + spun**2)))
    near = np.where(has_apsides, run.least_bend, 1) * lean < OFFSETS * (offset + SWAYS * across * spun / upright**2)
    # of two squares, each twice its relative error
    round_ = ~has_apsides & (4 * position >= LEAST_BEND * length * lean)
    return np.asarray(has_apsides & at_end | near | round_)


def columns_of(rows: Rows, run: Outcomes, errors: Errors) -> tuple[dict[str, Any], Any]:
    """Return the columns by name, and in which rows a number has no error: there neither stands."""
    span, swings = run.t_last - run.t_first, run.apsis_last - run.apsis_first
    with np.errstate(divide="ignore", invalid="ignore"):
        precession = run.turn / swings * DEGREES_PER_HOUR  # 0/0 of a single point, and so below
        vertical = -rows.turn[:, 2, 0] * DEGREES_PER_HOUR
        columns = {
            "steps": run.steps,
            "transits": run.transits,
            "close_pairs": run.close_pairs,
            "t_first_s": run.t_first,
            "t_last_s": run.t_last,
            "transit_error_s": errors.transit,
            "frequency_hz": (run.transits - 1) / (2 * span),
            "frequency_error_hz": errors.frequency,
            "swing_hz": (run.apsides - 1) / (2 * swings),
            "swing_error_hz": errors.swing,
            "precession_deg_per_h": precession,
            "precession_error_deg_per_h": errors.precession,
            "precession_ratio": precession / vertical,
            "precession_ratio_error": errors.precession / np.abs(vertical),
            **dict(zip(STATE_COLUMNS, run.state.T, strict=True)),
            "position_error_m": errors.position,
            "velocity_error_m_s": errors.velocity,
            "max_angle_deg": np.degrees(run.largest_angle),
            "max_angle_error_deg": errors.angle,
        }
        return _stated(columns, COLUMNS)


def _stated(columns: dict[str, Any], described: Sequence[Column]) -> tuple[dict[str, Any], Any]:
    """Return columns, each error an ulp of its numbers larger, and where a number has none: there neither stands."""
    unknown: Any = False
    for error_name in {column.error for column in described if column.error}:
        names = [column.name for column in described if column.error == error_name]
        error = columns[error_name] + np.spacing(np.max(np.abs([columns[name] for name in names]), axis=0))
        none = ~np.isfinite(error)
        unknown = unknown | none & np.isfinite([columns[name] for name in names]).any(axis=0)
        columns |= {name: np.where(none, np.nan, columns[name]) for name in names}
        columns[error_name] = np.where(none, np.nan, error)
    return columns, unknown
