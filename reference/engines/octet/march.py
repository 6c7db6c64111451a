"""The compiled loop of steps: eight rows at a time; a lane whose row is done takes the next one.

A row's transits and highest points are noted as they are found: numbers, first and last, the least sharp.
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
    larger,
    load,
    magnitude,
    occupied,
    spread,
    store,
    where,
)
from . import rows
from .lane_zeros import (
    CONVERGED,
    DOUBT,
    MOST_ZEROS,
    TURNED,
    Bisection,
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

LEAST_RATE = 1e-300  # of u' at a release that rises or falls: it keeps its sign
SHORTEST = 2.0**-40  # of a row's unit of time: a step that is shorter stops the row
NEXT, DONE, ROW = range(3)  # in `March.counts`


class Moments(NamedTuple):
    """Times of transits: their number so far, and of each its row, time and direction."""

    number: npt.NDArray[np.int64]
    row: npt.NDArray[np.int64]
    time: Array
    direction: Array


def empty_moments(room: int) -> Moments:
    """Return room for times; none for none."""
    return Moments(
        np.zeros(1, dtype=np.int64), np.zeros(room, dtype=np.int64), np.zeros(room), np.zeros(room)
    )


@compiled
def note_transit(
    out: Array, at: int, row: int, moments: Moments, time: float, slope: float, close: float
) -> None:
    """Note a transit of a row whose results begin at `at`; `close` is what makes two of them a close pair, in s."""
    if out[at + rows.COUNT] == 0.0:
        out[at + rows.T_FIRST], out[at + rows.LEAST_SLOPE] = time, abs(slope)
    elif time - out[at + rows.T_LAST] < close:
        out[at + rows.CLOSE] += 1.0
    out[at + rows.COUNT] += 1.0
    out[at + rows.T_LAST] = time
    out[at + rows.LEAST_SLOPE] = min(out[at + rows.LEAST_SLOPE], abs(slope))
    n = moments.number[0]
    if n < len(moments.row):
        moments.row[n], moments.time[n], moments.direction[n] = (
            row,
            time,
            1.0 if slope > 0.0 else -1.0,
        )
        moments.number[0] = n + 1


@compiled
def note_highest(
    out: Array, at: int, time: float, x: float, p: float, u: float, fall: float, pull: float
) -> None:
    """Note a highest point (x, p, u); half turns are counted where the direction, less a half turn, passes east."""
    bend = fall / (pull * u * (2.0 - u))
    side = 1.0
    if p < 0.0 or (p == 0.0 and x < 0.0):
        side = -1.0
        x, p = -x, -p
    if out[at + rows.APSIDES] == 0.0:
        out[at + rows.A_FIRST], out[at + rows.LEAST_BEND], out[at + rows.LEAST_FALL] = (
            time,
            bend,
            fall,
        )
        out[at + rows.X_FIRST], out[at + rows.P_FIRST] = x, p
    else:
        along = out[at + rows.X_LAST] * x + out[at + rows.P_LAST] * p
        if along < 0.0:
            out[at + rows.HALF_TURNS] += (
                1.0 if out[at + rows.X_LAST] * p - out[at + rows.P_LAST] * x < 0.0 else -1.0
            )
        if along * side * out[at + rows.SIDE_LAST] > 0.0:
            out[at + rows.SAME_SIDE] += 1.0
    out[at + rows.SIDE_LAST] = side
    out[at + rows.APSIDES] += 1.0
    out[at + rows.A_LAST], out[at + rows.X_LAST], out[at + rows.P_LAST] = time, x, p
    out[at + rows.LEAST_BEND] = min(out[at + rows.LEAST_BEND], bend)
    out[at + rows.LEAST_FALL] = min(out[at + rows.LEAST_FALL], fall)
    out[at + rows.HIGHEST] = max(out[at + rows.HIGHEST], u)


class March(NamedTuple):
    """The lanes: what is carried between steps, and working arrays.

    Attributes:
        state: the present one and the constants of each lane's row, a row of eight for each of `rows`' columns.
        c: coefficients.
        transits, highest: the zeros of xdot and of u' on the step.
        w: working arrays of the long way.
        time, time_low: time reached in s, as a sum of two doubles.
        length: the step's length, in units of time.
        last: above 0 where the step is the row's last one: 1 more than its fate.
        top: x, p and u at the highest points, a row of eight each.
        counts: the next row, the number of rows that are done, and the row of each lane, -1 for none.
    """

    state: Array
    c: LaneSeries
    transits: LaneZeros
    highest: LaneZeros
    w: Bisection
    time: Array
    time_low: Array
    length: Array
    last: Array
    top: Array
    counts: npt.NDArray[np.int64]


def empty_march() -> March:
    """Return lanes without rows."""
    state, time, low, length, last, top = (
        aligned(size * LANES) for size in (rows.COLUMNS, 1, 1, 1, 1, 3)
    )
    working = empty_series(), empty_zeros(), empty_zeros(), empty_bisection()
    return March(
        state, *working, time, low, length, last, top, np.zeros(ROW + LANES, dtype=np.int64)
    )


@compiled
def _take_row(m: March, lane: int, numbers: Array, results: Array) -> None:
    """Give a lane the next row, or one that never ends."""
    row = m.counts[NEXT]
    sought = row < len(numbers) // rows.COLUMNS
    m.counts[ROW + lane] = row if sought else -1
    at = row * rows.COLUMNS if sought else 0
    for column in range(rows.COLUMNS):
        m.state[LANES * column + lane] = numbers[at + column]
    m.time[lane] = m.time_low[lane] = 0.0
    for z, column in ((m.transits, rows.SEEKS_X), (m.highest, rows.SEEKS_U)):
        z.sought[lane] = numbers[at + column] if sought else 0.0
        z.hit[lane] = z.doubt[lane] = 0.0
    m.counts[NEXT] += 1
    if sought:
        results[row * rows.RESULTS + rows.HIGHEST] = numbers[at + rows.U]
    else:
        m.state[LANES * rows.END + lane] = np.inf


@compiled
def _set_length(m: March, order: int) -> None:
    """Set the steps' lengths, none beyond its row's end."""
    left = load(m.state, LANES * rows.END) - load(m.time, 0)
    left = (left + (load(m.state, LANES * rows.END_LOW) - load(m.time_low, 0))) / load(
        m.state, LANES * rows.UNIT
    )
    length = step_length(m.c, order)
    last = at_least(length, left)
    store(m.last, 0, last)
    store(m.length, 0, where(last, left, length))


@compiled
def _advance_time(m: March) -> None:
    step, time = load(m.length, 0) * load(m.state, LANES * rows.UNIT), load(m.time, 0)
    total = time + step
    other = total - time
    error = (time - (total - other)) + (step - other)
    store(m.time, 0, total)
    store(m.time_low, 0, load(m.time_low, 0) + error)


@compiled
def _leave(m: March, lane: int, numbers: Array, results: Array, fate: int) -> None:
    """Write a row's end, and take the next row."""
    at = m.counts[ROW + lane] * rows.RESULTS
    results[at + rows.HIGHEST] = max(results[at + rows.HIGHEST], m.state[LANES * rows.U + lane])
    for column in range(rows.S + 1):
        results[at + column] = m.state[LANES * column + lane]
    results[at + rows.FATE] = fate
    m.counts[DONE] += 1
    _take_row(m, lane, numbers, results)


@compiled
def _begin(m: March) -> None:
    """Set the rates at the release of rows that begin: the exact inputs give the sign of u' or, at 0, its slope."""
    fresh = at_least(spread(0.0), load(m.time, 0))
    rising = load(m.state, LANES * rows.RISING)
    udot = rising * larger(magnitude(load(m.c.udot, 0)), spread(LEAST_RATE))
    udot = where(magnitude(rising), udot, load(m.c.udot, LANES))
    store(m.transits.before, 0, where(fresh, load(m.c.xdot, 0), load(m.transits.before, 0)))
    store(m.highest.before, 0, where(fresh, udot, load(m.highest.before, 0)))


@compiled
def _place_zeros(m: March, order: int, form: bool | None) -> None:
    """Find transits and highest points on the step of each lane."""
    if occupied(load(m.transits.sought, 0)):
        store(m.transits.after, 0, xdot_of(m.state) if form is None else form_of(m.state))
        seek(m.transits, m.c.xdot, m.length, m.time, order)
        refine(m.transits, m.c.xdot, m.length, order, CONVERGED)
    if occupied(load(m.highest.sought, 0)):
        store(m.highest.after, 0, udot_of(m.state))
        seek_highest(m.highest, m.c.udot, m.length, order)
        if occupied(load(m.highest.hit, 0)):
            refine(m.highest, m.c.udot, m.length, order, TURNED)
            place_highest(m.top, m.c, m.highest, order)


@compiled
def _note(m: March, order: int, lane: int, row: int, results: Array, moments: Moments) -> bool:
    """Note what a lane has passed; return false if its transits or highest points stay in doubt."""
    at, unit, close = (
        row * rows.RESULTS,
        m.state[LANES * rows.UNIT + lane],
        m.state[LANES * rows.CLOSE_S + lane],
    )
    since, low, n = m.time[lane], m.time_low[lane], 0
    results[at + rows.STEPS] += 1.0
    if m.transits.doubt[lane] != 0.0:
        multiplicity = -1 if since > 0.0 else int(m.state[LANES * rows.ZEROS_X + lane])
        n = all_zeros(m.w, m.transits, m.c.xdot, lane, m.length[lane], multiplicity, order)
        if n == DOUBT:
            return False
    elif m.transits.hit[lane] != 0.0:
        m.w.places[0], m.w.slopes[0], n = m.transits.place[lane], m.transits.slope[lane], 1
    for i in range(n):
        note_transit(
            results, at, row, moments, since + (low + m.w.places[i] * unit), m.w.slopes[i], close
        )
    pull = m.state[LANES * rows.PULL + lane]
    if m.highest.doubt[lane] != 0.0:
        # of a conical orbit u' is but rounding
        u = m.c.u[lane]
        if not abs(m.c.udot[LANES + lane]) < LEAST_BEND * pull * u * (2.0 - u):
            return False
        results[at + rows.LEAST_BEND], results[at + rows.APSIDES] = (
            0.0,
            max(results[at + rows.APSIDES], 1.0),
        )
    elif m.highest.hit[lane] != 0.0:
        x, p, u = m.top[lane], m.top[LANES + lane], m.top[2 * LANES + lane]
        place, fall = m.highest.place[lane], -m.highest.slope[lane]
        note_highest(results, at, since + (low + place * unit), x, p, u, fall, pull)
    return True


@kept(*rows.SOURCES, nogil=True, **OPTIONS)
def march(
    m: March,
    order: int,
    form: bool | None,
    numbers: Array,
    results: Array,
    moments: Moments,
    steps: int,
) -> bool:
    """Take at most `steps` steps, or until no room is left for times; return whether all rows are done.

    The transits are the zeros of the rows' forms unless `form` is None: then numba leaves out what has to do with them.
    """
    many = len(numbers) // rows.COLUMNS
    if m.counts[NEXT] == 0:
        for lane in range(LANES):
            _take_row(m, lane, numbers, results)
    for _ in range(steps):
        if m.counts[DONE] == many or 0 < len(moments.row) < moments.number[0] + LANES * MOST_ZEROS:
            break
        taylor_coefficients(m.c, m.state, order)
        if form is not None:
            put_form(m.c, m.state, order)
        _begin(m)
        _set_length(m, order)
        sum_series(m.state, m.c, m.length, order)
        _place_zeros(m, order, form)
        for lane in range(LANES):
            row = m.counts[ROW + lane]
            if row >= 0:
                short = m.last[lane] == 0.0 and not m.length[lane] > SHORTEST
                if not _note(m, order, lane, row, results, moments):
                    m.last[lane] = 1.0 + DOUBTFUL
                if short or not abs(m.state[LANES * rows.X + lane]) < 2.0:
                    m.last[lane] = 1.0 + STOPPED
        _advance_time(m)
        store(m.transits.before, 0, load(m.transits.after, 0))
        store(m.highest.before, 0, load(m.highest.after, 0))
        if occupied(load(m.last, 0)):
            for lane in range(LANES):
                if m.last[lane] != 0.0 and m.counts[ROW + lane] >= 0:
                    _leave(m, lane, numbers, results, int(m.last[lane]) - 1)
    return bool(m.counts[DONE] == many)
