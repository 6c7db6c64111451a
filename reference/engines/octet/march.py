"""The compiled loop of steps: eight rows at a time; a lane whose row is done takes the next one."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..batch import STOPPED
from ..limbs.lanes import LANES, SOURCES, at_least, compiled, entry, load, occupied, spread, store, where
from ..limbs.limb import Array, aligned
from .rows import (
    COLUMNS,
    END,
    END_LOW,
    FATE,
    HIGHEST,
    PULL,
    RESULTS,
    STEPS,
    TURN_P,
    TURN_U,
    UNIT,
    U,
)
from .series import MOST_ORDER, Series, State, Terms, empty_series, step_length, sum_series, taylor_coefficients

Counts = npt.NDArray[np.int64]
SHORTEST = 2.0**-40  # of a row's unit of time: a step that is shorter stops the row
NEXT, BUSY = range(2)  # in `March.counts`, then the row of each lane
ROW = 2


class Plan(NamedTuple):
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
        unit: units of time in s.
        time, time_low, end, end_low: time reached and time of the end, in s, as sums of two doubles.
        length: the step's length, in units of time.
        last: 1 where the step is the row's last one.
        inverses: 1, 1/2, 1/3, …
        counts: the next row, the number of lanes with a row, and the row of each lane.
    """

    now: State
    c: Series
    t: Terms
    unit: Array
    time: Array
    time_low: Array
    end: Array
    end_low: Array
    length: Array
    last: Array
    inverses: Array
    counts: Counts


def empty_march() -> March:
    """Return lanes without rows."""
    rows = [aligned(LANES) for _ in range(7)]
    state, terms = State(*(aligned(LANES) for _ in State._fields)), Terms(*(aligned(LANES) for _ in Terms._fields))
    inverses = 1.0 / np.arange(1.0, MOST_ORDER + 2)
    return March(state, empty_series(), terms, *rows, inverses, np.zeros(ROW + LANES, dtype=np.int64))


@compiled
def _take_row(m: March, lane: int, numbers: Array, results: Array) -> None:
    """Give a lane the next row, or none."""
    rows = len(numbers) // COLUMNS
    row = m.counts[NEXT]
    if row >= rows:
        m.counts[ROW + lane] = -1
        m.t.turn_p[lane] = m.t.turn_u[lane] = m.t.pull[lane] = 0.0
        m.now.x[lane] = m.now.p[lane] = m.now.u[lane] = m.now.w[lane] = m.now.v[lane] = m.now.s[lane] = 0.0
        m.unit[lane], m.time[lane], m.time_low[lane], m.end[lane], m.end_low[lane] = 1.0, 0.0, 0.0, np.inf, 0.0
        return
    at = row * COLUMNS
    m.t.turn_p[lane], m.t.turn_u[lane], m.t.pull[lane] = numbers[at + TURN_P], numbers[at + TURN_U], numbers[at + PULL]
    m.now.x[lane], m.now.p[lane], m.now.u[lane] = numbers[at + 3], numbers[at + 4], numbers[at + 5]
    m.now.w[lane], m.now.v[lane], m.now.s[lane] = numbers[at + 6], numbers[at + 7], numbers[at + 8]
    m.unit[lane], m.time[lane], m.time_low[lane] = numbers[at + UNIT], 0.0, 0.0
    m.end[lane], m.end_low[lane] = numbers[at + END], numbers[at + END_LOW]
    m.counts[ROW + lane] = row
    m.counts[NEXT] += 1
    m.counts[BUSY] += 1
    results[row * RESULTS + HIGHEST] = numbers[at + U]


@compiled
def _set_length(m: March, plan: Plan) -> None:
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
def _leave(m: March, lane: int, numbers: Array, results: Array, fate: int) -> None:
    """Write a row's end, and take the next row."""
    at = m.counts[ROW + lane] * RESULTS
    results[at], results[at + 1], results[at + 2] = m.now.x[lane], m.now.p[lane], m.now.u[lane]
    results[at + 3], results[at + 4], results[at + 5] = m.now.w[lane], m.now.v[lane], m.now.s[lane]
    if fate:
        results[at + FATE] = fate
    m.counts[BUSY] -= 1
    _take_row(m, lane, numbers, results)


@compiled
def _march(m: March, plan: Plan, numbers: Array, results: Array, steps: int) -> bool:
    """Take at most `steps` steps; return whether all rows are done."""
    if m.counts[NEXT] == 0:
        for lane in range(LANES):
            _take_row(m, lane, numbers, results)
    for _ in range(steps):
        if m.counts[BUSY] == 0:
            return True
        taylor_coefficients(m.c, m.now, m.t, m.inverses, plan.order)
        _set_length(m, plan)
        sum_series(m.now, m.c, m.t, m.length, plan.order)
        _advance_time(m)
        for lane in range(LANES):
            row = m.counts[ROW + lane]
            if row >= 0:
                results[row * RESULTS + STEPS] += 1.0
                if not m.length[lane] > SHORTEST and m.last[lane] == 0.0 or not abs(m.now.x[lane]) < 2.0:
                    _leave(m, lane, numbers, results, STOPPED)
                elif m.last[lane] != 0.0:
                    _leave(m, lane, numbers, results, 0)
    return m.counts[BUSY] == 0


def _entry(sources: str) -> Any:
    """Return the function that Python calls, cached on disk for these sources: see `limbs.march`."""

    def march(m: March, plan: Plan, numbers: Array, results: Array, steps: int) -> bool:
        return _march(m, plan, numbers, results, steps) if sources else False

    return entry(march, nogil=True)


march = _entry(SOURCES + "".join(sha256(path.read_bytes()).hexdigest() for path in sorted(Path(__file__).parent.glob("*.py"))))
