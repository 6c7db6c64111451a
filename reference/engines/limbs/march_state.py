"""State carried between Taylor steps, and what is written of them: states at the output times and zeros of xdot."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .lanes import LANES
from .limb import Array, aligned
from .series import Counts, LinearTerms, Series, empty_series
from .step import Model
from .zeros import Search, empty_search

COLUMNS = 7  # x, y, z, vx, vy, vz, ax
TIME, LENGTH, MULTIPLICITY, SIGN, STEPS, ROWS, ZEROS, SCALED, NEXT = range(9)  # in `MarchState.counts`


class MarchState(NamedTuple):
    """State carried between steps, and working arrays.

    Attributes:
        now: rows of n, in the axes x, m, w, and of V in the unit of time.
        counts: time and step length in grains; multiplicity of the zero of xdot at release; sign of xdot; steps;
            output times passed; zeros written; the step length that `terms` is for; the next step's length.
        s: the step's series.
        terms: its linear terms.
        rows, place: working arrays: all lanes at some place in the step, and that place.
        search: working arrays for the step's zeros.
    """

    now: Array
    counts: Counts
    s: Series
    terms: LinearTerms
    rows: Array
    place: Array
    search: Search


class Outputs(NamedTuple):
    """Output times, the states at them, and zeros of xdot.

    Attributes:
        whole, remainders: times in whole grains, and the limbs of the remainders, shape (times * limb_count,).
        states: `limb_count` rows per time, as `dense_output.to_cartesian` writes them.
        moments: per zero the step's start and length in grains, and the crossing's sign.
        places: per zero the limbs of its place in the step.
        zero_states: `limb_count` rows per zero.
        steps: start and length in grains of the first steps of a call, as many as there is room for.
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


def state_at_release(start: Array, first: int, multiplicity: int, model: Model) -> MarchState:
    """Return the state carried between steps, initialised at the release."""
    order, limb_count = model.order, model.limb_count
    counts = np.zeros(9, dtype=np.int64)
    counts[LENGTH], counts[MULTIPLICITY] = first, multiplicity
    terms = LinearTerms(*(aligned(LANES * (limb_count + 2)) for _ in LinearTerms._fields))
    rows = aligned(LANES * (limb_count + 2))
    now = aligned(len(start))
    now[:] = start
    series, search = empty_series(order, limb_count), empty_search(order, limb_count)
    return MarchState(now, counts, series, terms, rows, np.zeros(limb_count + 2), search)
