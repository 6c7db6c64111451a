"""The compiled loop of steps: eight rows at a time; a lane whose row is done takes the next one."""

from __future__ import annotations

import math
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..batch import DOUBTFUL, STOPPED
from ..limbs.lanes import LANES, SOURCES, at_least, compiled, entry, load, occupied, spread, store, where
from ..limbs.limb import Array, aligned
from .apsides import CONVERGED as TURNED
from .apsides import evaluate, seek_highest
from .found import Moments, note_highest, note_transit
from .long_way import DOUBT, MOST_ZEROS, LongWay, all_zeros, empty_long_way
from .rows import (
    APSIDES,
    CLOSE_S,
    COLUMNS,
    END,
    END_LOW,
    FATE,
    HIGHEST,
    LEAST_BEND,
    MOVES,
    PULL,
    RESULTS,
    STEPS,
    TURN_P,
    TURN_U,
    UNIT,
    ZEROS_U,
    ZEROS_X,
    P,
    S,
    U,
    V,
    W,
    X,
)
from .series import (
    MOST_ORDER,
    Series,
    State,
    Terms,
    empty_series,
    step_length,
    sum_series,
    taylor_coefficients,
    udot_of,
    xdot_of,
)
from .zeros import CONVERGED, Zeros, empty_zeros, refine, seek

Counts = npt.NDArray[np.int64]
SHORTEST = 2.0**-40  # of a row's unit of time: a step that is shorter stops the row
NEXT, BUSY = range(2)  # in `March.counts`, then the row of each lane
ROW = 2


class Settings(NamedTuple):
    """What is asked of the kernel.

    Attributes:
        order: even, at most MOST_ORDER.
        tolerance: the size that the last coefficients have, against the motion.
        transits, apsides: whether they are looked for.
    """

    order: int
    tolerance: float
    transits: bool
    apsides: bool


class March(NamedTuple):
    """The lanes: state carried between steps, and working arrays.

    Attributes:
        now, c, t: state, coefficients, constants of each lane.
        transits, highest: the zeros of xdot and of u' on the step.
        w: working arrays of the long way.
        unit: units of time in s.
        time, time_low, end, end_low: time reached and time of the end, in s, as sums of two doubles.
        length: the step's length, in units of time.
        last: 1 where the step is the row's last one.
        at_x, at_p, at_u: n at the highest points.
        inverses, threes: 1, 1/2, 1/3, … and the binomials k over 3.
        counts: the next row, the number of lanes with a row, and the row of each lane.
    """

    now: State
    c: Series
    t: Terms
    transits: Zeros
    highest: Zeros
    w: LongWay
    unit: Array
    time: Array
    time_low: Array
    end: Array
    end_low: Array
    length: Array
    last: Array
    at_x: Array
    at_p: Array
    at_u: Array
    inverses: Array
    threes: Array
    counts: Counts


def empty_march() -> March:
    """Return lanes without rows."""
    rows = [aligned(LANES) for _ in range(10)]
    state, terms = State(*(aligned(LANES) for _ in State._fields)), Terms(*(aligned(LANES) for _ in Terms._fields))
    inverses = 1.0 / np.arange(1.0, MOST_ORDER + 2)
    threes = np.array([math.comb(k, 3) for k in range(MOST_ORDER + 1)], dtype=float)
    counts = np.zeros(ROW + LANES, dtype=np.int64)
    return March(
        state, empty_series(), terms, empty_zeros(), empty_zeros(), empty_long_way(), *rows, inverses, threes, counts
    )


@compiled
def _take_row(m: March, plan: Settings, lane: int, numbers: Array, results: Array) -> None:
    """Give a lane the next row, or one that never moves."""
    row = m.counts[NEXT]
    sought = row < len(numbers) // COLUMNS
    m.counts[ROW + lane] = row if sought else -1
    at = row * COLUMNS if sought else 0
    m.transits.fresh[lane] = 1.0
    m.transits.sought[lane] = numbers[at + MOVES] if sought and plan.transits else 0.0
    m.highest.sought[lane] = 1.0 if sought and plan.apsides else 0.0
    m.t.turn_p[lane], m.t.turn_u[lane], m.t.pull[lane] = numbers[at + TURN_P], numbers[at + TURN_U], numbers[at + PULL]
    m.now.x[lane], m.now.p[lane], m.now.u[lane] = numbers[at + X], numbers[at + P], numbers[at + U]
    m.now.w[lane], m.now.v[lane], m.now.s[lane] = numbers[at + W], numbers[at + V], numbers[at + S]
    m.unit[lane], m.time[lane], m.time_low[lane] = numbers[at + UNIT], 0.0, 0.0
    m.end[lane], m.end_low[lane] = np.inf, 0.0
    if sought:
        m.end[lane], m.end_low[lane] = numbers[at + END], numbers[at + END_LOW]
        m.counts[NEXT] += 1
        m.counts[BUSY] += 1
        results[row * RESULTS + HIGHEST] = numbers[at + U]


@compiled
def _set_length(m: March, plan: Settings) -> None:
    """Set the steps' lengths, none beyond its row's end."""
    left = (load(m.end, 0) - load(m.time, 0)) + (load(m.end_low, 0) - load(m.time_low, 0))
    left = left / load(m.unit, 0)
    length = step_length(m.c, plan.tolerance, m.inverses, plan.order)
    last = at_least(length, left)
    store(m.last, 0, last)
    store(m.length, 0, where(last, left, length))


@compiled
def _advance_time(m: March) -> None:
    step, time = load(m.length, 0) * load(m.unit, 0), load(m.time, 0)
    total = time + step
    other = total - time
    error = (time - (total - other)) + (step - other)
    store(m.time, 0, total)
    store(m.time_low, 0, load(m.time_low, 0) + error)


@compiled
def _leave(m: March, plan: Settings, lane: int, numbers: Array, results: Array, fate: int) -> None:
    """Write a row's end, and take the next row."""
    at = m.counts[ROW + lane] * RESULTS
    results[at], results[at + 1], results[at + 2] = m.now.x[lane], m.now.p[lane], m.now.u[lane]
    results[at + 3], results[at + 4], results[at + 5] = m.now.w[lane], m.now.v[lane], m.now.s[lane]
    results[at + FATE] = fate
    m.counts[BUSY] -= 1
    _take_row(m, plan, lane, numbers, results)


@compiled
def _begin(m: March, numbers: Array) -> None:
    """Set the rates at the release of rows that begin: where u' is exactly zero, its slope gives the sign."""
    for lane in range(LANES):
        row = m.counts[ROW + lane]
        if row >= 0 and m.transits.fresh[lane] != 0.0:
            m.transits.before[lane], m.highest.before[lane] = m.c.xdot[lane], m.c.udot[lane]
            if numbers[row * COLUMNS + ZEROS_U] != 0.0:
                m.highest.before[lane] = m.c.udot[LANES + lane]


@compiled
def _place_zeros(m: March, plan: Settings) -> None:
    """Find transits and highest points on the step of each lane."""
    if plan.transits:
        store(m.transits.after, 0, xdot_of(m.now, m.t))
        seek(m.transits, m.c.xdot, m.length, m.threes, plan.order)
        refine(m.transits, m.c.xdot, m.length, plan.order, CONVERGED)
    if plan.apsides:
        store(m.highest.after, 0, udot_of(m.now, m.t))
        seek_highest(m.highest, m.c.udot, m.length, plan.order)
        if occupied(load(m.highest.hit, 0)):
            refine(m.highest, m.c.udot, m.length, plan.order, TURNED)
            evaluate(m.at_x, m.c.x, m.highest.place, plan.order)
            evaluate(m.at_p, m.c.p, m.highest.place, plan.order)
            evaluate(m.at_u, m.c.u, m.highest.place, plan.order)


@compiled
def _note(m: March, plan: Settings, lane: int, row: int, numbers: Array, results: Array, moments: Moments) -> bool:
    """Note what a lane has passed; return false if its transits stay in doubt."""
    at, close, start = row * RESULTS, numbers[row * COLUMNS + CLOSE_S], m.time_low[lane]
    if m.transits.doubt[lane] != 0.0:
        multiplicity = -1 if m.transits.fresh[lane] == 0.0 else int(numbers[row * COLUMNS + ZEROS_X])
        before, after = m.transits.before[lane], m.transits.after[lane]
        n = all_zeros(m.w, m.c.xdot, lane, m.length[lane], before, after, multiplicity, plan.order)
        if n == DOUBT:
            return False
        for i in range(n):
            time = m.time[lane] + (start + m.w.places[i] * m.unit[lane])
            note_transit(results, at, row, moments, time, m.w.slopes[i], close)
    elif m.transits.hit[lane] != 0.0:
        time = m.time[lane] + (start + m.transits.place[lane] * m.unit[lane])
        note_transit(results, at, row, moments, time, m.transits.slope[lane], close)
    if m.highest.hit[lane] != 0.0:
        u, pull = m.at_u[lane], m.t.pull[lane]
        bend = -m.highest.slope[lane] / (pull * u * (2.0 - u)) if m.highest.doubt[lane] == 0.0 else 0.0
        time = m.time[lane] + (start + m.highest.place[lane] * m.unit[lane])
        note_highest(results, at, time, m.at_x[lane], m.at_p[lane], u, bend)
    elif m.highest.doubt[lane] != 0.0:
        results[at + LEAST_BEND], results[at + APSIDES] = 0.0, max(results[at + APSIDES], 1.0)
    return True


@compiled
def _march(m: March, plan: Settings, numbers: Array, results: Array, moments: Moments, steps: int) -> bool:
    """Take at most `steps` steps, or until no room is left for times; return whether all rows are done."""
    if m.counts[NEXT] == 0:
        for lane in range(LANES):
            _take_row(m, plan, lane, numbers, results)
    for _ in range(steps):
        room = len(moments.row) - moments.count[0]
        if m.counts[BUSY] == 0 or (len(moments.row) > 0 and room < LANES * MOST_ZEROS):
            break
        taylor_coefficients(m.c, m.now, m.t, m.inverses, plan.order)
        if occupied(load(m.transits.fresh, 0)):
            _begin(m, numbers)
        _set_length(m, plan)
        sum_series(m.now, m.c, m.t, m.length, plan.order)
        _place_zeros(m, plan)
        for lane in range(LANES):
            row = m.counts[ROW + lane]
            if row >= 0:
                clear = _note(m, plan, lane, row, numbers, results, moments)
                results[row * RESULTS + STEPS] += 1.0
                if (m.last[lane] == 0.0 and not m.length[lane] > SHORTEST) or not abs(m.now.x[lane]) < 2.0:
                    m.last[lane] = 1.0 + STOPPED
                elif not clear:
                    m.last[lane] = 1.0 + DOUBTFUL
        _advance_time(m)
        store(m.transits.before, 0, load(m.transits.after, 0))
        store(m.highest.before, 0, load(m.highest.after, 0))
        store(m.transits.fresh, 0, spread(0.0))
        if occupied(load(m.last, 0)):
            for lane in range(LANES):
                if m.last[lane] != 0.0 and m.counts[ROW + lane] >= 0:
                    _leave(m, plan, lane, numbers, results, int(m.last[lane]) - 1)
    return m.counts[BUSY] == 0


def _entry(sources: str) -> Any:
    """Return the function that Python calls, cached on disk for these sources: see `limbs.march`."""

    def march(m: March, plan: Settings, numbers: Array, results: Array, moments: Moments, steps: int) -> bool:
        return _march(m, plan, numbers, results, moments, steps) if sources else False

    return entry(march, nogil=True)


march = _entry(
    SOURCES + "".join(sha256(path.read_bytes()).hexdigest() for path in sorted(Path(__file__).parent.glob("*.py")))
)
