"""The outputs of a Taylor step: the states at the output times that it passes, and the zeros of xdot on it."""

from __future__ import annotations

from .compiling import compiled
from .dense_output import divide_place, evaluate, to_cartesian
from .lanes import LANES
from .march_state import LENGTH, MULTIPLICITY, ROWS, SIGN, TIME, ZEROS, MarchState, Outputs
from .polish import polish
from .step import Model
from .xdot import sign_of_xdot
from .zeros import GRAZING, bracket_zeros


@compiled
def write_outputs(state: MarchState, model: Model, out: Outputs, seek: bool) -> bool:
    """Write what the present step passes, zeros of xdot if they are sought; return false if they stay in doubt."""
    if seek and not _write_zeros(state, model, out):
        return False
    _write_states(state, model, out)
    return True


@compiled
def _write_states(state: MarchState, model: Model, out: Outputs) -> None:
    """Write the states at the output times that the step passes."""
    counts, limb_count = state.counts, model.limb_count
    start, m = counts[TIME], counts[LENGTH]
    while counts[ROWS] < len(out.whole) and out.whole[counts[ROWS]] < start + m:
        i = counts[ROWS]
        state.place[:] = 0.0
        for q in range(limb_count):
            state.place[q] = out.remainders[i * limb_count + q]
        divide_place(state.place, out.whole[i] - start, m, limb_count)
        evaluate(state.rows, state.s, state.place, model.order, limb_count)
        to_cartesian(out.states, i * limb_count * LANES, state.rows, state.s, state.terms, model, m)
        counts[ROWS] += 1


@compiled
def _write_zeros(state: MarchState, model: Model, out: Outputs) -> bool:
    """Write the zeros of xdot on the step; return false if they stay in doubt."""
    counts, limb_count, z, m = state.counts, model.limb_count, state.search, state.counts[LENGTH]
    after = sign_of_xdot(state.now, model.terms.turn, state.s, limb_count)
    count = bracket_zeros(z, state.s, state.terms, state.rows, counts[SIGN], after, counts[MULTIPLICITY], model)
    if count == GRAZING:
        return False
    for i in range(count):
        if not polish(z, i, state.s, state.terms, state.rows, model):
            return False
        n = counts[ZEROS]
        for q in range(limb_count):
            out.places[n * limb_count + q] = z.place[q]
        to_cartesian(out.zero_states, n * limb_count * LANES, state.rows, state.s, state.terms, model, m)
        out.moments[3 * n], out.moments[3 * n + 1], out.moments[3 * n + 2] = counts[TIME], m, z.direction[i]
        counts[ZEROS] += 1
    counts[SIGN] = after
    return True
