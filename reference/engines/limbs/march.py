"""The compiled loop of Taylor steps, from the release on."""

from __future__ import annotations

from pathlib import Path

from ...system.machine_code import kept
from .compiling import OPTIONS, compiled
from .lanes import LANES, load, store
from .march_state import (
    LENGTH,
    MULTIPLICITY,
    NEXT,
    SCALED,
    SIGN,
    STEPS,
    TIME,
    ZEROS,
    MarchState,
    Outputs,
)
from .outputs import write_outputs
from .recurrence import taylor_coefficients
from .step import (
    LEAST_FACTOR,
    SAFETY_FACTOR,
    Model,
    next_length,
    order_zero,
    project,
    scale_terms,
    step_size_factor,
    sum_series,
)
from .xdot import sign_after_release, sign_of_xdot
from .zeros import MOST_ZEROS

# why a march stops: end reached; arrays full or steps used up; no step short enough; zeros of xdot in doubt
GOOD, FULL, STUCK, DOUBTFUL = range(4)


@kept(*Path(__file__).parent.glob("*.py"), **OPTIONS)
def march(state: MarchState, model: Model, out: Outputs, until: int, steps: int, seek: bool) -> int:
    """Take at most `steps` steps, until the time in grains is `until` or later; return why it stopped."""
    s, counts, limb_count, order = state.s, state.counts, model.limb_count, model.order
    for i in range(steps):
        if seek and counts[ZEROS] + MOST_ZEROS > len(out.moments) // 3:
            return FULL
        if not _step_coefficients(state, model):
            return STUCK
        m = counts[LENGTH]
        sum_series(state.rows, s, order, limb_count)
        if seek and counts[STEPS] == 0:
            counts[SIGN] = _first_sign(state, model)
        project(state.now, state.rows, s, m, limb_count)
        if not write_outputs(state, model, out, seek):
            return DOUBTFUL
        if 2 * i < len(out.steps):
            out.steps[2 * i], out.steps[2 * i + 1] = counts[TIME], m
            size = (order + 1) * limb_count * LANES
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
def _first_sign(state: MarchState, model: Model) -> int:
    """Return the sign of xdot at release, or just after it."""
    if state.counts[MULTIPLICITY] > 0:
        return sign_after_release(state.s, state.counts[MULTIPLICITY], model.limb_count)
    return sign_of_xdot(state.now, model.terms.turn, state.s, model.limb_count)


@compiled
def _step_coefficients(state: MarchState, model: Model) -> bool:
    """Compute the coefficients of the next step, shortened until they decay enough; false if no length will do."""
    counts = state.counts
    while True:
        m = counts[LENGTH]
        if m != counts[SCALED]:
            scale_terms(state.terms, model, m)
            counts[SCALED] = m
        order_zero(state.s, state.terms, state.now, m, model.limb_count)
        shorter = m // 2
        if taylor_coefficients(state.s, state.terms, model.order, model.limb_count, model.drag):
            factor = step_size_factor(state.s, model.order, model.limb_count, model.tolerance)
            if factor >= LEAST_FACTOR:
                counts[NEXT] = next_length(m, factor, model.longest)
                return True
            shorter = min(int(m * factor * SAFETY_FACTOR), m - 1)
        if shorter < 1:
            return False
        counts[LENGTH] = shorter
