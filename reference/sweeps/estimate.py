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

from ..engines.batch_interface import OK, STOPPED, XDOT, Batch, Outcomes, Rows, RunOptions
from ..model.sections import direction_of
from ..numbers.precision import Array
from .highest_points import (
    DEGREES_PER_HOUR,
    LATE,
    errors_of_swing,
    fastest_of,
    swing_and_precession,
    unsure_of_highest,
)
from .parquet import COLUMNS, STATE_COLUMNS, Column, section_columns

FACTOR = 16.0
WILD_FACTOR = 64.0  # where there are three runs
LEAST_ULPS = 4.0  # of the cord length: the two runs may agree by chance
HALF_ULP = 2.0**-53  # of a number just above 1, relative
GROWN = 1e-12  # of the cord length: an estimate above it takes the third run
HEIGHT = FACTOR * LEAST_ULPS * HALF_ULP  # what rounding may do to a height over the cord length
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
    near, far = (
        np.linalg.norm(rate * gap[:, :3], axis=1) + np.linalg.norm(gap[:, 3:], axis=1)
        for gap in gaps
    )
    state[grown[far > near]] = back.state[far > near]
    stopped[grown] |= back.fate == STOPPED
    return errors(
        rows, run, replace(moved, state=state), np.where(wild, WILD_FACTOR, FACTOR)
    ), stopped


def errors(rows: Rows, run: Outcomes, moved: Outcomes, factor: Array | float = FACTOR) -> Errors:
    """Return the errors of a run, from the run that was moved, and what their difference is multiplied by."""
    length, rate = rows.length[:, 0], rows.rate
    gap = run.state - moved.state
    position, velocity = np.linalg.norm(gap[:, :3], axis=1), np.linalg.norm(gap[:, 3:], axis=1)
    ulp = LEAST_ULPS * np.spacing(length) + _of_constants(rows)
    speed = np.linalg.norm(run.state[:, 3:], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        # where a swing is late its position tells at the lowest point, its velocity at the highest
        position = factor * np.fmax(
            position, np.fmax(np.where(rate > 0, velocity / rate, 0.0), ulp)
        )
        velocity = factor * np.fmax(
            velocity, np.fmax(rate * position / factor, LEAST_ULPS * np.spacing(speed))
        )
        transit, undecided = _of_zeros(rows, run, position, velocity)
        span = run.t_last - run.t_first
        share = (run.transits - 1) * transit / span
        swing, precession = errors_of_swing(rows, run, position, velocity)
    return Errors(
        position=position,
        velocity=velocity,
        transit=transit,
        frequency=np.where((run.transits > 1) & (share < LATE), share / span, np.nan),
        swing=swing,
        precession=precession,
        # the height, which rounds to about an ulp, tells little of an angle next to the top
        angle=np.degrees(
            position / length + np.fmin(HEIGHT * np.tan(run.largest_angle / 2), np.sqrt(2 * HEIGHT))
        ),
        undecided=undecided,
        unsure_of_highest=unsure_of_highest(rows, run, position, velocity),
    )


def _of_constants(rows: Rows) -> Array:
    """Return how far constants that are off by half an ulp may turn a swing in the whole span, in m."""
    rate = rows.rate
    reach = np.fmin(fastest_of(rows) / rate, 1.0)
    turned: Array = rows.length[:, 0] * reach * rate * rows.t_end[:, 0] * HALF_ULP
    return np.where(rate > 0, turned, 0.0)


def _of_zeros(
    rows: Rows, run: Outcomes, position: Array, velocity: Array, vertical: bool = False
) -> tuple[Array, Array]:
    """Return the error of the worst transit's time, and where one may lie beyond the end, or a close pair be none.

    Of a section likewise, from how wrong its form may be; `vertical` says that it is the rate of the height, of which
    a velocity's error is the part along the sphere, and a position's turns the velocity.
    """
    length, speed = rows.length[:, 0], np.linalg.norm(run.state[:, 3:], axis=1)
    form, state = rows.form[..., 0], run.state
    value = (
        (form[:, :3] * state[:, :3]).sum(axis=1)
        + (form[:, 3:6] * state[:, 3:]).sum(axis=1)
        - form[:, 6] * length
    )
    of_place, of_velocity = (np.linalg.norm(part, axis=1) for part in (form[:, :3], form[:, 3:6]))
    fastest = rows.rate + np.fmax(speed / length, np.linalg.norm(rows.V[..., 0], axis=1))
    sine = np.where(run.largest_angle < np.pi / 2, np.sin(run.largest_angle), 1.0)
    off, bend = of_place * position + of_velocity * velocity, fastest**2 * length * sine
    bend = np.fmin(
        bend * (of_place + of_velocity * fastest), bend_of_pairs(rows, run.largest_angle)
    )
    if vertical:
        passing = fastest_of(rows) + np.linalg.norm(rows.turn[..., 0], axis=1)
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
    known = (
        (rows.form[..., 0] == XDOT).all(axis=1)
        & (angle < np.pi / 6)
        & (rows.rate > 30 * (turn + rows.drag[:, 0]))
    )
    return np.where(known, 16 * turn * rows.rate**2 * rows.length[:, 0] * np.sin(angle), np.nan)


def passages(
    engine: Batch, word: str, rows: Rows, run: Outcomes, errors: Errors
) -> tuple[dict[str, Any], Any]:
    """Return the columns of a section by its engine, and in which rows its passages are not decided.

    The rows are those with its form; run and errors are of those without.
    """
    zeros = replace(engine.solve(rows, PASSAGES), largest_angle=run.largest_angle)
    error, undecided = _of_zeros(
        rows, zeros, errors.position, errors.velocity, direction_of(word) != 0
    )
    columns, unknown = passages_listed(
        word, error, zeros.transit_row, zeros.transit_t, zeros.transit_direction
    )
    return columns, (zeros.fate != OK) | ~np.isfinite(rows.form).all(
        axis=(1, 2)
    ) | undecided | unknown


def passages_listed(
    word: str, error: Array, row: Any, t: Array, direction: Any
) -> tuple[dict[str, Any], Any]:
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
        return _stated(
            {column.name: values for column, values in zip(columns, arrays, strict=True)}, columns
        )


def columns_of(rows: Rows, run: Outcomes, errors: Errors) -> tuple[dict[str, Any], Any]:
    """Return the columns by name, and in which rows a number has no error: there neither stands."""
    span = run.t_last - run.t_first
    with np.errstate(divide="ignore", invalid="ignore"):
        swing, precession = swing_and_precession(run)
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
            "swing_hz": swing,
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
        error = columns[error_name] + np.spacing(
            np.max(np.abs([columns[name] for name in names]), axis=0)
        )
        none = ~np.isfinite(error)
        unknown = unknown | none & np.isfinite([columns[name] for name in names]).any(axis=0)
        columns |= {name: np.where(none, np.nan, columns[name]) for name in names}
        columns[error_name] = np.where(none, np.nan, error)
    return columns, unknown
