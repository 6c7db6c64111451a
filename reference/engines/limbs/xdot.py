"""xdot and xddot on a step: xdot in limbs, its sign, and approximate doubles for Newton's method."""

from __future__ import annotations

from .compiling import compiled
from .dense_output import evaluate
from .lanes import LANES
from .limb import DOUBLED, Array, carry_scalar, double_of, double_of_lane, sign_of
from .series import TENSION, VM, VX, LinearTerms, M, Series, X
from .step import Model


@compiled
def xdot_of(rows: Array, s: Series, terms: LinearTerms, limb_count: int) -> None:
    """Write xdot times h, from all lanes at some place of the step, to `scalar`, as carried limbs."""
    for r in range(limb_count):
        s.scalar[r] = rows[LANES * r + VX]
    s.scalar[limb_count] = 0.0
    for p in range(limb_count):
        factor = terms.turn[LANES * p]
        for q in range(limb_count - p):
            s.scalar[p + q + 1] += factor * rows[LANES * q + M]
    carry_scalar(s.scalar, limb_count)


@compiled
def sign_of_xdot(now: Array, turn: Array, s: Series, limb_count: int) -> int:
    """Return the sign of xdot = Vx + ω m for a state; `turn` as in the model's linear terms, not doubled."""
    for r in range(limb_count):
        s.scalar[r] = now[LANES * r + VX]
    s.scalar[limb_count] = 0.0
    for p in range(limb_count):
        factor = DOUBLED * turn[LANES * p]
        for q in range(limb_count - p):
            s.scalar[p + q + 1] += factor * now[LANES * q + M]
    carry_scalar(s.scalar, limb_count)
    return sign_of(s.scalar, limb_count)


@compiled
def sign_after_release(s: Series, multiplicity: int, limb_count: int) -> int:
    """Return the sign of xdot just after a release at which it has a zero of this multiplicity."""
    block = (multiplicity + 1) * limb_count * LANES
    for q in range(limb_count):
        limb = s.c[block + LANES * q + X]
        if limb != 0.0:
            return 1 if limb > 0.0 else -1
    return 0


@compiled
def xdot_at(place: Array, s: Series, terms: LinearTerms, rows: Array, model: Model) -> float:
    """Return xdot times h at a place of the step, as a double with the sign of its limbs; write all lanes to `rows`."""
    evaluate(rows, s, place, model.order, model.limb_count)
    xdot_of(rows, s, terms, model.limb_count)
    return double_of(s.scalar, model.limb_count)


@compiled
def xddot_of(rows: Array, xdot: float, terms: LinearTerms, model: Model) -> float:
    """Return xddot times h² from all lanes and xdot times h, as a double."""
    limb_count = model.limb_count
    turn = double_of_lane(terms.turn, 0, 0, limb_count) / DOUBLED
    x, vm = double_of_lane(rows, 0, X, limb_count), double_of_lane(rows, 0, VM, limb_count)
    tension = double_of_lane(rows, 0, TENSION, limb_count)
    value = turn * (2.0 * vm - turn * x) - tension * x
    if model.drag:
        value += double_of_lane(terms.drag, 0, VX, limb_count) / DOUBLED * xdot
    return value
