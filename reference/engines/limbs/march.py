"""Steps from release to the end, compiled: states at output times and zeros of xdot as they are passed."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .dense_output import divide_place, evaluate, finish
from .lanes import LANES, SOURCES, compiled, entry, load, store
from .limb import Array, aligned
from .series import Counts, Line, Series, expand, room
from .step import AIM, SLIP, Model, begin, end, next_length, reach, scale_line, settle
from .zeros import FOUND, GRAZING, Search, bracket_zeros, polish, search_room, sign_leaving, sign_now

GOOD, FULL, STUCK, DOUBTFUL = range(4)  # what a march says when it stops
COLUMNS = 7  # x, y, z, vx, vy, vz, ax
TIME, LENGTH, MULTIPLICITY, SIGN, STEPS, ROWS, ZEROS, SCALED, NEXT = range(9)  # of `Carried.counts`


class Carried(NamedTuple):
    """What goes from step to step.

    Attributes:
        now: the state, rows of x, m, w and V in the unit of time.
        counts: time and step length in grains; how often over xdot vanishes at release; sign of xdot; steps;
            output times passed; zeros written; the length that `line` was made for; the next step's.
        s, line, rows, place: room for a step.
        search: room for its zeros.
    """

    now: Array
    counts: Counts
    s: Series
    line: Line
    rows: Array
    place: Array
    search: Search


class Outputs(NamedTuple):
    """Output times and what is found at them; zeros of xdot.

    Attributes:
        whole, rest: times in grains, and digits of what is beyond the whole ones, shape (times * limbs,).
        states: `limbs` rows per time, as `dense_output.finish` makes them.
        moments: per zero the step's start and length in grains, and the crossing's sign.
        places: per zero the digits of its place in the step.
        met: `limbs` rows per zero.
        steps: per step of a call its start and length in grains; may be shorter than the steps.
        series: for as many steps the coefficients, (order + 1) * `limbs` rows.
    """

    whole: Counts
    rest: Array
    states: Array
    moments: Counts
    places: Array
    met: Array
    steps: Counts
    series: Array


def carried(start: Array, first: int, multiplicity: int, order: int, limbs: int) -> Carried:
    """At release."""
    counts = np.zeros(9, dtype=np.int64)
    counts[LENGTH], counts[MULTIPLICITY] = first, multiplicity
    line = Line(*(aligned(LANES * (limbs + 2)) for _ in Line._fields))
    rows = aligned(LANES * (limbs + 2))
    now = aligned(len(start))
    now[:] = start
    return Carried(now, counts, room(order, limbs), line, rows, np.zeros(limbs + 2), search_room(order, limbs))


@compiled
def _march(at: Carried, model: Model, out: Outputs, until: int, steps: int, seek: bool) -> int:
    """Take up to `steps` steps, until the time in grains is `until` or later; says why it stopped."""
    s, counts, limbs, order = at.s, at.counts, model.limbs, model.order
    for i in range(steps):
        if seek and counts[ZEROS] + FOUND > len(out.moments) // 3:
            return FULL
        if not _series(at, model):
            return STUCK
        m = counts[LENGTH]
        end(at.rows, s, order, limbs)
        if seek and counts[STEPS] == 0:
            counts[SIGN] = _first_sign(at, model)
        settle(at.now, at.rows, s, m, limbs)
        if seek and not _zeros(at, model, out):
            return DOUBTFUL
        _outputs(at, model, out)
        if 2 * i < len(out.steps):
            out.steps[2 * i], out.steps[2 * i + 1] = counts[TIME], m
            size = (order + 1) * limbs * LANES
            for j in range(0, size, LANES):
                store(out.series, i * size + j, load(s.c, j))
        counts[TIME] += m
        counts[STEPS] += 1
        counts[MULTIPLICITY] = 0
        counts[LENGTH] = counts[NEXT]
        if counts[TIME] >= until:
            return GOOD
    return FULL


@compiled
def _first_sign(at: Carried, model: Model) -> int:
    """The sign of xdot at release, or just after it."""
    if at.counts[MULTIPLICITY] > 0:
        return sign_leaving(at.s, at.counts[MULTIPLICITY], model.limbs)
    return sign_now(at.now, model.line.turn, at.s, model.limbs)


@compiled
def _series(at: Carried, model: Model) -> bool:
    """The coefficients of the next step, made shorter until they end within it; False if no length will do."""
    counts = at.counts
    while True:
        m = counts[LENGTH]
        if m != counts[SCALED]:
            scale_line(at.line, model, m)
            counts[SCALED] = m
        begin(at.s, at.line, at.now, m, model.limbs)
        shorter = m // 2
        if expand(at.s, at.line, model.order, model.limbs, model.drag):
            part = reach(at.s, model.order, model.limbs, model.tolerance)
            if part >= SLIP:
                counts[NEXT] = next_length(m, part, model.most)
                return True
            shorter = min(int(m * part * AIM), m - 1)
        if shorter < 1:
            return False
        counts[LENGTH] = shorter


@compiled
def _outputs(at: Carried, model: Model, out: Outputs) -> None:
    """States at the times that the step passes."""
    counts, limbs = at.counts, model.limbs
    begun, m = counts[TIME], counts[LENGTH]
    while counts[ROWS] < len(out.whole) and out.whole[counts[ROWS]] < begun + m:
        i = counts[ROWS]
        at.place[:] = 0.0
        for q in range(limbs):
            at.place[q] = out.rest[i * limbs + q]
        divide_place(at.place, out.whole[i] - begun, m, limbs)
        evaluate(at.rows, at.s, at.place, model.order, limbs)
        finish(out.states, i * limbs * LANES, at.rows, at.s, at.line, model, m)
        counts[ROWS] += 1


@compiled
def _zeros(at: Carried, model: Model, out: Outputs) -> bool:
    """Zeros of xdot on the step; False if they stay in doubt."""
    counts, limbs, z, m = at.counts, model.limbs, at.search, at.counts[LENGTH]
    after = sign_now(at.now, model.line.turn, at.s, limbs)
    found = bracket_zeros(z, at.s, at.line, at.rows, counts[SIGN], after, counts[MULTIPLICITY], model)
    if found == GRAZING:
        return False
    for i in range(found):
        if not polish(z, i, at.s, at.line, at.rows, model):
            return False
        n = counts[ZEROS]
        for q in range(limbs):
            out.places[n * limbs + q] = z.place[q]
        finish(out.met, n * limbs * LANES, at.rows, at.s, at.line, model, m)
        out.moments[3 * n], out.moments[3 * n + 1], out.moments[3 * n + 2] = counts[TIME], m, z.way[i]
        counts[ZEROS] += 1
    counts[SIGN] = after
    return True


def _entry(sources: str) -> Any:
    """What Python calls.

    numba's cache on disk looks at the file of the function that is called, not at those that it calls; but what a
    function closes over is part of its key.
    """

    @entry
    def march(at: Carried, model: Model, out: Outputs, until: int, steps: int, seek: bool) -> int:
        return _march(at, model, out, until, steps, seek) if sources else STUCK

    return march


march = _entry(SOURCES)
