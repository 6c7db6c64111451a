"""The compiled loop of steps: eight rows at a time; a lane whose row is done takes the next one.

A row's transits and highest points are recorded as they are found: how many, the first and the
last, the least sharp.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...numbers.precision import Array
from ...system.machine_code import kept
from ..batch_interface import DOUBTFUL, LEAST_BEND, STOPPED
from ..simd.lanes import (
    LANES,
    OPTIONS,
    aligned,
    at_least,
    compiled,
    get_row,
    inlined,
    larger,
    magnitude,
    occupied,
    set_row,
    spread,
    where,
)
from . import rows
from .lane_zeros import (
    CONVERGED,
    CONVERGED_HIGHEST,
    DOUBT,
    MOST_ZEROS,
    Bisection,
    LanePolynomial,
    LaneZeros,
    all_zeros,
    empty_bisection,
    empty_zeros,
    place_highest,
    refine,
    seek,
    seek_highest,
)
from .series import (
    LaneSeries,
    empty_series,
    form_of,
    put_form,
    step_length,
    sum_series,
    taylor_coefficients,
    udot_of,
    xdot_of,
)

_LEAST_RATE = 1e-300  # of u' at a release that rises or falls: it keeps its sign
_SHORTEST = 2.0**-40  # of a row's unit of time: a step that is shorter stops the row
_NEXT, _DONE, _ROW = range(3)  # in `March.counts`


class Moments(NamedTuple):
    """Times of transits: their number so far, and of each its row, time and direction."""

    number: npt.NDArray[np.int64]
    row: npt.NDArray[np.int64]
    time: Array
    direction: Array


def empty_moments(room: int) -> Moments:
    """Return room for this many times; with none, no times are kept."""
    return Moments(
        number=np.zeros(1, dtype=np.int64),
        row=np.zeros(room, dtype=np.int64),
        time=np.zeros(room),
        direction=np.zeros(room),
    )


class RowData(NamedTuple):
    """The rows to solve, and what comes out.

    Attributes:
        numbers: what `rows.packed` says of each row, flat: `rows.COLUMNS` of each.
        results: `rows.RESULTS` of each row, flat.
        moments: times of transits.
    """

    numbers: Array
    results: Array
    moments: Moments


@compiled
def _record_transit(data: RowData, row: int, time_s: float, slope: float, close_s: float) -> None:
    """Record a transit of a row.

    One that comes less than `close_s` after the one before makes a close pair.
    """
    out = data.results
    at = row * rows.RESULTS
    if out[at + rows.COUNT] == 0.0:
        out[at + rows.T_FIRST] = time_s
        out[at + rows.SMALLEST_SLOPE] = abs(slope)
    elif time_s - out[at + rows.T_LAST] < close_s:
        out[at + rows.CLOSE] += 1.0
    out[at + rows.COUNT] += 1.0
    out[at + rows.T_LAST] = time_s
    out[at + rows.SMALLEST_SLOPE] = min(out[at + rows.SMALLEST_SLOPE], abs(slope))

    moments = data.moments
    n = moments.number[0]
    if n < len(moments.row):
        moments.row[n] = row
        moments.time[n] = time_s
        moments.direction[n] = 1.0 if slope > 0.0 else -1.0
        moments.number[0] = n + 1


class _HighestPoint(NamedTuple):
    """A highest point of a row.

    Attributes:
        time_s: when it is reached.
        x, p, u: where it is.
        fall: -u'' there, in units of time.
        bend: the same over C (1 - (1 - u)²), as in `Outcomes.least_bend`.
    """

    time_s: float
    x: float
    p: float
    u: float
    fall: float
    bend: float


@compiled
def _record_highest(data: RowData, row: int, point: _HighestPoint) -> None:
    """Record a highest point.

    Half turns are counted where the direction, up to a half turn, passes east.
    """
    out = data.results
    at = row * rows.RESULTS
    # the direction up to a half turn: that of (x, p) or of its opposite, with p >= 0
    side = -1.0 if point.p < 0.0 or (point.p == 0.0 and point.x < 0.0) else 1.0
    x = side * point.x
    p = side * point.p
    if out[at + rows.APSIDES] == 0.0:
        out[at + rows.A_FIRST] = point.time_s
        out[at + rows.X_FIRST] = x
        out[at + rows.P_FIRST] = p
        out[at + rows.SMALLEST_BEND] = point.bend
        out[at + rows.SMALLEST_FALL] = point.fall
    else:
        along = out[at + rows.X_LAST] * x + out[at + rows.P_LAST] * p
        across = out[at + rows.X_LAST] * p - out[at + rows.P_LAST] * x
        if along < 0.0:
            out[at + rows.HALF_TURNS] += 1.0 if across < 0.0 else -1.0
        if along * side * out[at + rows.SIDE_LAST] > 0.0:
            out[at + rows.SAME_SIDE] += 1.0

    out[at + rows.APSIDES] += 1.0
    out[at + rows.A_LAST] = point.time_s
    out[at + rows.X_LAST] = x
    out[at + rows.P_LAST] = p
    out[at + rows.SIDE_LAST] = side
    out[at + rows.SMALLEST_BEND] = min(out[at + rows.SMALLEST_BEND], point.bend)
    out[at + rows.SMALLEST_FALL] = min(out[at + rows.SMALLEST_FALL], point.fall)
    out[at + rows.HIGHEST] = max(out[at + rows.HIGHEST], point.u)


class March(NamedTuple):
    """The lanes: what is carried between steps, and working arrays.

    Attributes:
        state: the present one and the constants of each lane's row, a row of eight for each of
            `rows`' columns.
        series: coefficients.
        transits, highest: the zeros of xdot and of u' on the step.
        bisection: working arrays for all zeros of one lane.
        time, time_low: time reached in s, as a sum of two doubles.
        length: the step's length, in units of time.
        last: above 0 where the step is the row's last one: 1 more than its fate.
        top: x, p and u at the highest points, a row of eight each.
        counts: the next row, the number of rows that are done, and the row of each lane, -1 for
            none.
    """

    state: Array
    series: LaneSeries
    transits: LaneZeros
    highest: LaneZeros
    bisection: Bisection
    time: Array
    time_low: Array
    length: Array
    last: Array
    top: Array
    counts: npt.NDArray[np.int64]


def empty_march() -> March:
    """Return lanes without rows."""
    return March(
        state=aligned(rows.COLUMNS * LANES),
        series=empty_series(),
        transits=empty_zeros(),
        highest=empty_zeros(),
        bisection=empty_bisection(),
        time=aligned(LANES),
        time_low=aligned(LANES),
        length=aligned(LANES),
        last=aligned(LANES),
        top=aligned(3 * LANES),
        counts=np.zeros(_ROW + LANES, dtype=np.int64),
    )


@compiled
def _take_row(m: March, lane: int, data: RowData) -> None:
    """Give a lane the next row, or one that never ends."""
    row = m.counts[_NEXT]
    has_row = row < len(data.numbers) // rows.COLUMNS
    at = row * rows.COLUMNS if has_row else 0
    m.counts[_NEXT] += 1
    m.counts[_ROW + lane] = row if has_row else -1
    for column in range(rows.COLUMNS):
        m.state[LANES * column + lane] = data.numbers[at + column]
    m.time[lane] = 0.0
    m.time_low[lane] = 0.0
    _start_search(m.transits, lane, data.numbers[at + rows.SEEKS_X] if has_row else 0.0)
    _start_search(m.highest, lane, data.numbers[at + rows.SEEKS_U] if has_row else 0.0)
    if has_row:
        data.results[row * rows.RESULTS + rows.HIGHEST] = data.numbers[at + rows.U]
    else:
        m.state[LANES * rows.END + lane] = np.inf


@compiled
def _start_search(z: LaneZeros, lane: int, sought: float) -> None:
    """Prepare a lane for a new row, whose zeros are sought where `sought` is 1."""
    z.sought[lane] = sought
    z.hit[lane] = 0.0
    z.doubt[lane] = 0.0


@compiled
def _set_length(m: March, order: int) -> None:
    """Set the steps' lengths, none beyond its row's end."""
    remaining_s = get_row(m.state, rows.END) - get_row(m.time, 0)
    remaining_s = remaining_s + (get_row(m.state, rows.END_LOW) - get_row(m.time_low, 0))
    remaining = remaining_s / get_row(m.state, rows.UNIT)
    length = step_length(m.series, order)
    last = at_least(length, remaining)
    set_row(m.last, 0, last)
    set_row(m.length, 0, where(last, remaining, length))


@compiled
def _advance_time(m: March) -> None:
    """Add the steps' lengths to the times, and the rounding of the sum to their low parts (Knuth's two-sum)."""
    step = get_row(m.length, 0) * get_row(m.state, rows.UNIT)
    time = get_row(m.time, 0)
    total = time + step
    added = total - time
    error = (time - (total - added)) + (step - added)
    set_row(m.time, 0, total)
    set_row(m.time_low, 0, get_row(m.time_low, 0) + error)


@compiled
def _finish_row(m: March, lane: int, data: RowData) -> None:
    """Write the results at a row's end."""
    out = data.results
    at = m.counts[_ROW + lane] * rows.RESULTS
    out[at + rows.HIGHEST] = max(out[at + rows.HIGHEST], m.state[LANES * rows.U + lane])
    for column in range(rows.S + 1):
        out[at + column] = m.state[LANES * column + lane]
    out[at + rows.FATE] = int(m.last[lane]) - 1
    m.counts[_DONE] += 1


@compiled
def _begin(m: March) -> None:
    """Set the rates at the release of rows that begin: the exact inputs give the sign of u' or, at 0, its slope."""
    fresh = at_least(spread(0.0), get_row(m.time, 0))
    rising = get_row(m.state, rows.RISING)
    size = larger(magnitude(get_row(m.series.udot, 0)), spread(_LEAST_RATE))
    udot = where(magnitude(rising), rising * size, get_row(m.series.udot, 1))
    xdot = get_row(m.series.xdot, 0)
    set_row(m.transits.before, 0, where(fresh, xdot, get_row(m.transits.before, 0)))
    set_row(m.highest.before, 0, where(fresh, udot, get_row(m.highest.before, 0)))


@compiled
def _place_zeros(m: March, order: int, form: bool | None) -> None:
    """Find transits and highest points on the step of each lane."""
    if occupied(get_row(m.transits.sought, 0)):
        after = xdot_of(m.state) if form is None else form_of(m.state)
        set_row(m.transits.after, 0, after)
        seek(m.transits, m.series.xdot, m.length, m.time, order)
        refine(m.transits, m.series.xdot, m.length, order, CONVERGED)
    if occupied(get_row(m.highest.sought, 0)):
        set_row(m.highest.after, 0, udot_of(m.state))
        seek_highest(m.highest, m.series.udot, m.length, order)
        if occupied(get_row(m.highest.hit, 0)):
            refine(m.highest, m.series.udot, m.length, order, CONVERGED_HIGHEST)
            place_highest(m.top, m.series, m.highest, order)


@compiled
def _time_s(m: March, lane: int, place: float) -> float:
    """Return the time at a place in a lane's step."""
    elapsed_s = place * m.state[LANES * rows.UNIT + lane]
    time_s: float = m.time[lane] + (m.time_low[lane] + elapsed_s)
    return time_s


@inlined
def _record_transits(m: March, order: int, lane: int, data: RowData) -> bool:
    """Record the transits on a lane's step; return false if they stay in doubt."""
    count = 0
    if m.transits.doubt[lane] != 0.0:
        has_moved = m.time[lane] > 0.0
        multiplicity = -1 if has_moved else int(m.state[LANES * rows.ZEROS_X + lane])
        polynomial = LanePolynomial(m.series.xdot, lane, order, m.length[lane])
        count = all_zeros(m.bisection, m.transits, polynomial, multiplicity)
        if count == DOUBT:
            return False
    elif m.transits.hit[lane] != 0.0:
        m.bisection.places[0] = m.transits.place[lane]
        m.bisection.slopes[0] = m.transits.slope[lane]
        count = 1

    row = m.counts[_ROW + lane]
    close_s = m.state[LANES * rows.CLOSE_S + lane]
    for i in range(count):
        time_s = _time_s(m, lane, m.bisection.places[i])
        _record_transit(data, row, time_s, m.bisection.slopes[i], close_s)
    return True


@inlined
def _record_highest_point(m: March, lane: int, data: RowData) -> bool:
    """Record the highest point on a lane's step, if there is one.

    Return false if this stays in doubt.
    """
    row = m.counts[_ROW + lane]
    pull = m.state[LANES * rows.PULL + lane]
    if m.highest.doubt[lane] != 0.0:
        # in a conical orbit u' is nothing but rounding
        u = m.series.u[lane]
        if not abs(m.series.udot[LANES + lane]) < LEAST_BEND * pull * u * (2.0 - u):
            return False
        at = row * rows.RESULTS
        data.results[at + rows.SMALLEST_BEND] = 0.0
        data.results[at + rows.APSIDES] = max(data.results[at + rows.APSIDES], 1.0)
    elif m.highest.hit[lane] != 0.0:
        time_s = _time_s(m, lane, m.highest.place[lane])
        x = m.top[lane]
        p = m.top[LANES + lane]
        u = m.top[2 * LANES + lane]
        fall = -m.highest.slope[lane]
        bend = fall / (pull * u * (2.0 - u))
        _record_highest(data, row, _HighestPoint(time_s, x, p, u, fall, bend))
    return True


@inlined
def _end_of_step(m: March, order: int, lane: int, data: RowData) -> None:
    """Record what a lane's row has passed on its step, and whether this is the row's last one."""
    data.results[m.counts[_ROW + lane] * rows.RESULTS + rows.STEPS] += 1.0
    is_too_short = m.last[lane] == 0.0 and not m.length[lane] > _SHORTEST
    is_off_the_sphere = not abs(m.state[LANES * rows.X + lane]) < 2.0  # or not a number
    is_decided = _record_transits(m, order, lane, data) and _record_highest_point(m, lane, data)
    if is_too_short or is_off_the_sphere:
        m.last[lane] = 1.0 + STOPPED
    elif not is_decided:
        m.last[lane] = 1.0 + DOUBTFUL


@kept(*rows.SOURCES, nogil=True, **OPTIONS)
def march(m: March, order: int, form: bool | None, data: RowData, steps: int) -> bool:
    """Take at most `steps` steps, or until no room is left for times.

    Return whether all rows are done.

    The transits are the zeros of the rows' forms unless `form` is None: then numba leaves out what
    has to do with them.
    """
    row_count = len(data.numbers) // rows.COLUMNS
    room = len(data.moments.row)
    if m.counts[_NEXT] == 0:
        for lane in range(LANES):
            _take_row(m, lane, data)
    for _ in range(steps):
        is_full = 0 < room < data.moments.number[0] + LANES * MOST_ZEROS
        if m.counts[_DONE] == row_count or is_full:
            break
        taylor_coefficients(m.series, m.state, order)
        if form is not None:
            put_form(m.series, m.state, order)
        _begin(m)
        _set_length(m, order)
        sum_series(m.state, m.series, m.length, order)
        _place_zeros(m, order, form)
        for lane in range(LANES):
            if m.counts[_ROW + lane] >= 0:
                _end_of_step(m, order, lane, data)
        _advance_time(m)
        set_row(m.transits.before, 0, get_row(m.transits.after, 0))
        set_row(m.highest.before, 0, get_row(m.highest.after, 0))
        if occupied(get_row(m.last, 0)):
            for lane in range(LANES):
                if m.last[lane] != 0.0 and m.counts[_ROW + lane] >= 0:
                    _finish_row(m, lane, data)
                    _take_row(m, lane, data)
    return bool(m.counts[_DONE] == row_count)
