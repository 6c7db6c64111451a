"""Estimates of the errors of rows, from a second run.

It has another order, and every constant and start number is moved by an ulp.
`columns_of` turns results and their errors into columns: no value without its error.

Both runs round differently everywhere, the constants included, so that their difference is of the
size of the error. It may be smaller by chance: hence the factor, and a least difference, which is
what half an ulp in the constants may do. Errors that have grown to many ulps point in one
direction, and so may those of a bob with enough energy to rise to the pivot: the errors of the two
runs may cancel. Then a third run is moved the other way, and the factor is larger.

`pytest --long tests/campaigns/test_sweeps.py -k error` compares 3,500 random rows of 600 s, 500 of
them over the top or beyond the horizontal, with limbs at 110 bits.
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
from .parquet import COLUMNS, STATE_COLUMNS, ParquetColumn, section_columns

_FACTOR = 16.0
_WILD_FACTOR = 64.0  # where there are three runs
_LEAST_ULPS = 4.0  # of the cord length: the two runs may agree by chance
_HALF_ULP = 2.0**-53  # of a number just above 1, relative
_GROWN = 1e-12  # of the cord length: an estimate above it takes the third run
_HEIGHT = _FACTOR * _LEAST_ULPS * _HALF_ULP  # what rounding may do to a height over the cord length
MOVED = RunOptions(transits=False, apsides=False, moved=1)
_MOVED_BACK = RunOptions(transits=False, apsides=False, moved=-1)
SECTION_RUN = RunOptions(apsides=False, times=True, form=True)


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
        undecided: where the number of transits depends on these errors.
        unsure_of_highest: where the number of highest points does.
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


@dataclass(frozen=True)
class SectionPassages:
    """The zeros of a section's form in several rows, ordered by row and time.

    Attributes:
        row: in which row each is, from 0.
        t: its time in s.
        direction: 1 where the form grows, else -1.
    """

    row: Any
    t: Array
    direction: Any

    def __getitem__(self, chosen: Any) -> SectionPassages:
        """Return some of the passages."""
        return SectionPassages(self.row[chosen], self.t[chosen], self.direction[chosen])


def errors_by_moved_runs(engine: Batch, rows: Rows, run: Outcomes) -> tuple[Errors, Any]:
    """Return the errors of a run, estimated from one or two perturbed runs, and the rows where one of these stopped."""
    moved = engine.solve(rows, MOVED)
    estimated = errors(rows, run, moved)
    stopped = moved.fate == STOPPED
    wild = _is_wild(rows, estimated)
    again = np.flatnonzero(~stopped & wild)
    if not len(again):
        return estimated, stopped

    back = engine.solve(rows[again], _MOVED_BACK)
    stopped[again] |= back.fate == STOPPED
    moved = _farthest(rows, run, moved, back, again)
    return errors(rows, run, moved, np.where(wild, _WILD_FACTOR, _FACTOR)), stopped


def _is_wild(rows: Rows, estimated: Errors) -> Array:
    """Return where the errors may cancel: they have grown, or the bob can reach the pivot."""
    n = rows.n[..., 0]
    V = rows.V[..., 0]
    pull = rows.pull[..., 0]
    reaches_the_pivot = (V * V).sum(axis=1) / 2 >= (n * pull).sum(axis=1)
    is_small = estimated.position <= _GROWN * rows.length[:, 0]
    return np.asarray(~is_small | reaches_the_pivot)


def _farthest(rows: Rows, run: Outcomes, moved: Outcomes, back: Outcomes, again: Any) -> Outcomes:
    """Return the moved run, with the states of `back` where these are farther from the run's.

    `back` was moved the other way; it has the rows `again` alone.
    """
    rate = rows.rate[again, None]
    state = moved.state.copy()

    def distance(other: Array) -> Array:
        gap = np.abs(other - run.state[again])
        in_position = np.linalg.norm(rate * gap[:, :3], axis=1)
        in_velocity = np.linalg.norm(gap[:, 3:], axis=1)
        return np.asarray(in_position + in_velocity)

    is_farther = distance(back.state) > distance(state[again])
    state[again[is_farther]] = back.state[is_farther]
    return replace(moved, state=state)


def errors(rows: Rows, run: Outcomes, moved: Outcomes, factor: Array | float = _FACTOR) -> Errors:
    """Return estimated errors of a run: its difference from the perturbed run times a factor."""
    length = rows.length[:, 0]
    rate = rows.rate
    gap = run.state - moved.state
    position_gap = np.linalg.norm(gap[:, :3], axis=1)
    velocity_gap = np.linalg.norm(gap[:, 3:], axis=1)
    speed = np.linalg.norm(run.state[:, 3:], axis=1)
    least_gap = _LEAST_ULPS * np.spacing(length) + _of_constants(rows)
    with np.errstate(divide="ignore", invalid="ignore"):
        # an error of the phase shows in the position at the lowest point, and in the velocity at
        # the highest
        phase_gap = np.where(rate > 0, velocity_gap / rate, 0.0)
        position_error = factor * np.fmax(position_gap, np.fmax(phase_gap, least_gap))
        least_velocity_gap = np.fmax(
            rate * position_error / factor, _LEAST_ULPS * np.spacing(speed)
        )
        velocity_error = factor * np.fmax(velocity_gap, least_velocity_gap)

        transit, undecided = _errors_of_zeros(rows, run, position_error, velocity_error)
        span = run.t_last - run.t_first
        share = (run.transits - 1) * transit / span
        swing, precession = errors_of_swing(rows, run, position_error, velocity_error)
    # a height rounds to about an ulp, which says little about an angle next to the top
    rounding = np.fmin(_HEIGHT * np.tan(run.largest_angle / 2), np.sqrt(2 * _HEIGHT))
    return Errors(
        position=position_error,
        velocity=velocity_error,
        transit=transit,
        frequency=np.where((run.transits > 1) & (share < LATE), share / span, np.nan),
        swing=swing,
        precession=precession,
        angle=np.degrees(position_error / length + rounding),
        undecided=undecided,
        unsure_of_highest=unsure_of_highest(rows, run, position_error, velocity_error),
    )


def _of_constants(rows: Rows) -> Array:
    """Return how far half an ulp of the constants may move the bob in the whole span, in m."""
    rate = rows.rate
    reach = np.fmin(fastest_of(rows) / rate, 1.0)
    moved_m: Array = rows.length[:, 0] * reach * rate * rows.t_end[:, 0] * _HALF_ULP
    return np.where(rate > 0, moved_m, 0.0)


def _errors_of_zeros(
    rows: Rows,
    run: Outcomes,
    position_error: Array,
    velocity_error: Array,
    vertical: bool = False,
) -> tuple[Array, Array]:
    """Return the error of the worst zero's time in s, and where the number of zeros is undecided.

    It is where a zero may lie beyond the end, or where a close pair of zeros may not exist.

    Args:
        rows: the rows, with the form whose zeros the run has: that of xdot, or of a section.
        run: the results.
        position_error: in m.
        velocity_error: in m/s.
        vertical: whether the form is the rate of the height.
    """
    if vertical:
        form_error = _error_of_climbing(rows, run, position_error, velocity_error)
    else:
        form_error = _error_of_form(rows, position_error, velocity_error)

    may_cross_the_end = np.abs(_form_at_end(rows, run)) <= form_error
    bend = _bend_of_form(rows, run, vertical)
    may_not_exist = (run.close_pairs > 0) & (run.least_ax**2 < 4 * bend * form_error)
    undecided: Array = ~rows.still & (may_cross_the_end | may_not_exist)
    return form_error / run.least_ax + np.spacing(run.t_last), undecided


def _form_at_end(rows: Rows, run: Outcomes) -> Array:
    """Return the value of the rows' form at the end, in m/s for that of xdot."""
    form = rows.form[..., 0]
    of_position = (form[:, :3] * run.state[:, :3]).sum(axis=1)
    of_velocity = (form[:, 3:6] * run.state[:, 3:]).sum(axis=1)
    value: Array = of_position + of_velocity - form[:, 6] * rows.length[:, 0]
    return value


def _sizes_of_form(rows: Rows) -> tuple[Array, Array]:
    """Return the norms of the form's coefficients of the position and of the velocity."""
    form = rows.form[..., 0]
    return np.linalg.norm(form[:, :3], axis=1), np.linalg.norm(form[:, 3:6], axis=1)


def _error_of_form(rows: Rows, position_error: Array, velocity_error: Array) -> Array:
    """Return the error of the form's value."""
    position_size, velocity_size = _sizes_of_form(rows)
    return position_size * position_error + velocity_size * velocity_error


def _error_of_climbing(
    rows: Rows, run: Outcomes, position_error: Array, velocity_error: Array
) -> Array:
    """Return the error of the form that is the rate of the height.

    It contains only the part of the velocity's error along the sphere; but an error of the position
    turns the velocity.
    """
    _, velocity_size = _sizes_of_form(rows)
    turning_rate = fastest_of(rows) + np.linalg.norm(rows.turn[..., 0], axis=1)
    error: Array = velocity_size * (
        _largest_sine(run) * velocity_error + turning_rate * position_error
    )
    return error


def _bend_of_form(rows: Rows, run: Outcomes, vertical: bool) -> Array:
    """Return a bound of the second derivative of the form between two close zeros."""
    length = rows.length[:, 0]
    position_size, velocity_size = _sizes_of_form(rows)
    speed = np.linalg.norm(run.state[:, 3:], axis=1)
    fastest = rows.rate + np.fmax(speed / length, np.linalg.norm(rows.V[..., 0], axis=1))
    sine = _largest_sine(run)
    bend = fastest**2 * length * sine * (position_size + velocity_size * fastest)
    bend = np.fmin(bend, bend_of_pairs(rows, run.largest_angle))
    if vertical:
        bend = 8 * sine * bend
    return np.asarray(bend)


def _largest_sine(run: Outcomes) -> Array:
    """Return the largest sine of the angle that the bob has reached."""
    return np.where(run.largest_angle < np.pi / 2, np.sin(run.largest_angle), 1.0)


def bend_of_pairs(rows: Rows, angle: Array) -> Array:
    """Return a bound of |d²xdot/dt²| between two close transits of swings up to an angle.

    It is NaN where no bound is known.

    With T the force along the cord over l, x'' = Coriolis - x T. Let M be the bound and h < π/(2ω)
    the time between the transits: |xdot| <= M h²/8 there, and x'' is zero somewhere, so that |x| <=
    2Ω|v|/T + M h³/8. Below 30° T is within 0.86 and 1.56 ω², |T'| <= 0.45 ω³, |v| <= 1.1 ω l sin θ
    and |a| <= 1.2 ω² l sin θ, so that three quarters of M at most come from M itself, and the rest
    is the Coriolis force's: M < 16 Ω ω² l sin θ.
    """
    turn = np.linalg.norm(rows.turn[..., 0], axis=1)
    is_xdot = (rows.form[..., 0] == XDOT).all(axis=1)
    is_slow = rows.rate > 30 * (turn + rows.drag[:, 0])
    bound = 16 * turn * rows.rate**2 * rows.length[:, 0] * np.sin(angle)
    return np.where(is_xdot & (angle < np.pi / 6) & is_slow, bound, np.nan)


def passages(
    engine: Batch, word: str, rows: Rows, run: Outcomes, errors: Errors
) -> tuple[dict[str, Any], Any]:
    """Return the columns of a section, and the rows in which its passages are undecided.

    Args:
        engine: solves the rows for these passages.
        word: the section.
        rows: with the section's form.
        run: the results of the same rows without it.
        errors: those of `run`.
    """
    of_section = replace(engine.solve(rows, SECTION_RUN), largest_angle=run.largest_angle)
    vertical = direction_of(word) != 0
    error, undecided = _errors_of_zeros(
        rows, of_section, errors.position, errors.velocity, vertical
    )
    zeros = SectionPassages(
        of_section.transit_row, of_section.transit_t, of_section.transit_direction
    )
    columns, unknown = passages_listed(word, error, zeros)
    no_form = ~np.isfinite(rows.form).all(axis=(1, 2))
    return columns, (of_section.fate != OK) | no_form | undecided | unknown


def passages_listed(word: str, error: Array, zeros: SectionPassages) -> tuple[dict[str, Any], Any]:
    """Return the columns of a section, and the rows in which a number has no error estimate.

    Args:
        word: the section.
        error: of the times of each row, in s, shape (rows,).
        zeros: all zeros of its form, also in directions that do not count.
    """
    counting = zeros[zeros.direction * direction_of(word) >= 0]
    row = counting.row
    t = counting.t
    count = np.bincount(row, minlength=len(error))
    first = np.cumsum(count) - count  # the place of a row's first passage
    t_first = np.where(count > 0, np.append(t, np.nan)[first], np.nan)

    # those in the direction of the first
    alike = counting[counting.direction == counting.direction[first[row]]]
    alike_count = np.bincount(alike.row, minlength=len(error))
    t_last = np.append(alike.t, np.nan)[np.cumsum(alike_count) - 1]
    gaps = alike_count - 1
    with np.errstate(divide="ignore", invalid="ignore"):
        interval = np.where(gaps > 0, (t_last - t_first) / gaps, np.nan)
        interval_error = np.where(error < LATE * interval / 2, 2 * error / gaps, np.nan)
        described = section_columns([word])
        names = [column.name for column in described]
        numbers = (count, t_first, error, interval, interval_error)
        return _with_errors(dict(zip(names, numbers, strict=True)), described)


def columns_of(rows: Rows, run: Outcomes, errors: Errors) -> tuple[dict[str, Any], Any]:
    """Return the columns by name, and the rows in which a number has no error estimate: there both are NaN."""
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
        return _with_errors(columns, COLUMNS)


def _with_errors(
    columns: dict[str, Any], described: Sequence[ParquetColumn]
) -> tuple[dict[str, Any], Any]:
    """Return the columns, and in which rows a number has no error.

    Each error grows by an ulp of its numbers. A number without an error, and its error, become NaN.
    """
    columns = dict(columns)
    unknown: Any = False
    for error_name in dict.fromkeys(column.error for column in described if column.error):
        names = [column.name for column in described if column.error == error_name]
        numbers = np.array([columns[name] for name in names])
        error = columns[error_name] + np.spacing(np.max(np.abs(numbers), axis=0))
        missing = ~np.isfinite(error)
        unknown = unknown | missing & np.isfinite(numbers).any(axis=0)
        columns[error_name] = error
        for name in (*names, error_name):
            columns[name] = np.where(missing, np.nan, columns[name])
    return columns, unknown
