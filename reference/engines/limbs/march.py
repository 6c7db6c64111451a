"""The compiled loop of Taylor steps, from the release on, and what each step writes: states, and the zeros of xdot."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...numbers.precision import Array
from ...system.machine_code import kept
from ..simd.lanes import LANES, OPTIONS, aligned, get_row, merged, set_row
from .dense_output import divide_place, evaluate, to_cartesian, xdot_of
from .limb import DOUBLED, double_of
from .recurrence import taylor_coefficients
from .series import Counts, LinearTerms, Step, X, empty_series
from .step import (
    LEAST_FACTOR,
    SAFETY_FACTOR,
    LimbModel,
    next_length,
    order_zero,
    project,
    scale_terms,
    step_size_factor,
    sum_series,
)
from .zeros import MOST_ZEROS, Search, bracket_zeros, empty_search, polish

_LIMBS = Path(__file__).parent
# the files that the machine code is made of
_SOURCES = [*_LIMBS.glob("*.py"), *_LIMBS.parent.glob("simd/*.py")]
COLUMNS = 7  # x, y, z, vx, vy, vz, ax
# in `MarchState.counts`
TIME, _LENGTH, _MULTIPLICITY, _SIGN, STEPS, _ROWS, ZEROS, _SCALED, _NEXT = range(9)
# why a march stops: end reached; arrays full or steps used up; no step short enough; zeros of xdot
# undecided
GOOD, _FULL, STUCK, DOUBTFUL = range(4)


class MarchState(NamedTuple):
    """State carried between steps, and working arrays.

    Attributes:
        now: rows of n, in the axes x, m, w, and of V in the unit of time.
        counts: time and step length in grains; multiplicity of the zero of xdot at release; sign of
            xdot; steps; output times passed; zeros written; the step length that `terms` is for;
            the next step's length.
        step: the step.
        search: working arrays for a place in it, and for its zeros.
    """

    now: Array
    counts: Counts
    step: Step
    search: Search


class Outputs(NamedTuple):
    """Output times, the states at them, and zeros of xdot.

    Attributes:
        whole, remainders: times in whole grains, and the limbs of the remainders, shape (times *
            limb_count,).
        states: `limb_count` rows per time, as `dense_output.to_cartesian` writes them.
        moments: per zero the step's start and length in grains, and the crossing's sign.
        places: per zero the limbs of its place in the step.
        zero_states: `limb_count` rows per zero.
        steps: start and length in grains of the first steps of a call, as many as there is room
            for.
        series: the coefficients of as many steps, (order + 1) * `limb_count` rows each.
    """

    whole: Counts
    remainders: Array
    states: Array
    moments: Counts
    places: Array
    zero_states: Array
    steps: Counts
    series: Array


def state_at_release(start: Array, first: int, multiplicity: int, model: LimbModel) -> MarchState:
    """Return the state carried between steps, initialised at the release."""
    order = model.order
    limb_count = model.limb_count
    counts = np.zeros(9, dtype=np.int64)
    counts[_LENGTH] = first
    counts[_MULTIPLICITY] = multiplicity
    now = aligned(len(start))
    now[:] = start
    terms = LinearTerms(*(aligned(LANES * (limb_count + 2)) for _ in LinearTerms._fields))
    rows = aligned(LANES * (limb_count + 2))
    step = Step(empty_series(order, limb_count), terms, rows)
    return MarchState(now, counts, step, empty_search(order, limb_count))


@merged
def _write_states(state: MarchState, model: LimbModel, out: Outputs) -> None:
    """Write the states at the output times that the step passes."""
    counts = state.counts
    step = state.step
    place = state.search.place
    limb_count = model.limb_count
    start = counts[TIME]
    m = counts[_LENGTH]
    while counts[_ROWS] < len(out.whole) and out.whole[counts[_ROWS]] < start + m:
        i = counts[_ROWS]
        place[:] = 0.0
        for q in range(limb_count):
            place[q] = out.remainders[i * limb_count + q]
        divide_place(place, out.whole[i] - start, m, limb_count)
        evaluate(step.rows, step.s, place, model.order, limb_count)
        to_cartesian(out.states, i * limb_count * LANES, step, model, m)
        counts[_ROWS] += 1


@merged
def _write_zeros(state: MarchState, model: LimbModel, out: Outputs) -> bool:
    """Write the zeros of xdot on the step; return false if they stay in doubt."""
    counts = state.counts
    z = state.search
    limb_count = model.limb_count
    after = int(np.sign(xdot_of(state.now, state.step.s, model.terms.turn, DOUBLED, limb_count)))
    if not bracket_zeros(z, state.step, counts[_SIGN], after, counts[_MULTIPLICITY], model):
        return False
    for i in range(z.number[0]):
        if not polish(z, i, state.step, model):
            return False
        n = counts[ZEROS]
        for q in range(limb_count):
            out.places[n * limb_count + q] = z.place[q]
        start = n * limb_count * LANES
        to_cartesian(out.zero_states, start, state.step, model, counts[_LENGTH])
        out.moments[3 * n] = counts[TIME]
        out.moments[3 * n + 1] = counts[_LENGTH]
        out.moments[3 * n + 2] = z.direction[i]
        counts[ZEROS] += 1
    counts[_SIGN] = after
    return True


@merged
def _write_series(state: MarchState, model: LimbModel, out: Outputs, i: int) -> None:
    """Write start, length and coefficients of step i of a call, if there is room."""
    if 2 * i < len(out.steps):
        out.steps[2 * i] = state.counts[TIME]
        out.steps[2 * i + 1] = state.counts[_LENGTH]
        row_count = (model.order + 1) * model.limb_count
        for j in range(row_count):
            set_row(out.series, i * row_count + j, get_row(state.step.s.c, j))


@kept(*_SOURCES, **OPTIONS)
def march(
    state: MarchState, model: LimbModel, out: Outputs, until: int, steps: int, seek: bool
) -> int:
    """Take at most `steps` steps, until the time in grains is `until` or later.

    Return why it stopped.
    """
    s = state.step.s
    counts = state.counts
    limb_count = model.limb_count
    for i in range(steps):
        if seek and counts[ZEROS] + MOST_ZEROS > len(out.moments) // 3:
            return _FULL
        if not _step_coefficients(state, model):
            return STUCK
        sum_series(state.step.rows, s, model.order, limb_count)
        if seek and counts[STEPS] == 0:
            # the first coefficient of xdot that is not 0
            leading = (counts[_MULTIPLICITY] + 1) * limb_count * LANES + X
            counts[_SIGN] = int(np.sign(double_of(s.c, limb_count, leading, LANES)))
        project(state.now, state.step.rows, s, counts[_LENGTH], limb_count)
        if seek and not _write_zeros(state, model, out):
            return DOUBTFUL
        _write_states(state, model, out)
        _write_series(state, model, out, i)

        counts[TIME] += counts[_LENGTH]
        counts[STEPS] += 1
        counts[_MULTIPLICITY] = 0
        counts[_LENGTH] = counts[_NEXT]
        if counts[TIME] >= until:
            return GOOD
    return _FULL


@merged
def _step_coefficients(state: MarchState, model: LimbModel) -> bool:
    """Compute the coefficients of the next step, shortened until they decay enough.

    False if no length will do.
    """
    counts = state.counts
    s = state.step.s
    terms = state.step.terms
    while True:
        m = counts[_LENGTH]
        if m != counts[_SCALED]:
            scale_terms(terms, model, m)
            counts[_SCALED] = m
        order_zero(s, terms, state.now, m, model.limb_count)
        shorter = m // 2
        if taylor_coefficients(s, terms, model.order, model.limb_count, model.drag):
            factor = step_size_factor(s, model.order, model.limb_count, model.tolerance)
            if factor >= LEAST_FACTOR:
                counts[_NEXT] = next_length(m, factor, model.longest)
                return True
            shorter = min(int(m * factor * SAFETY_FACTOR), m - 1)
        if shorter < 1:
            return False
        counts[_LENGTH] = shorter
