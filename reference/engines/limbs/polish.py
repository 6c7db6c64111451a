"""Zeros of xdot refined to full precision: Newton's method in limbs, from the guess of each bracketed zero."""

from __future__ import annotations

from .compiling import compiled
from .dense_output import evaluate
from .lanes import LANES, load, store
from .limb import Array, add_double, carry_scalar, double_of, set_double
from .recurrence import taylor_coefficients
from .series import LinearTerms, Series
from .size import LIMB_BITS
from .step import Model
from .xdot import xddot_of, xdot_of
from .zeros import EDGE, NEAR, NEWTON_STEPS, Search, near_order

DERIVATIVE_BITS = 44  # correct bits of the derivative, a double, that Newton's method divides by


@compiled
def polish(z: Search, i: int, s: Series, terms: LinearTerms, rows: Array, model: Model) -> bool:
    """Write the place of zero i to `place`, all lanes there to `rows`; false if Newton's method leaves its interval.

    The guess is so good that a series about it needs few orders: the step's own is evaluated just once.
    """
    limb_count, short, previous = model.limb_count, z.near, 1.0
    set_double(z.place, z.guess[i], limb_count)
    for _ in range(NEWTON_STEPS):
        evaluate(rows, s, z.place, model.order, limb_count)
        for r in range(limb_count):
            store(short.c, LANES * r, load(rows, LANES * r))
        if not taylor_coefficients(short, terms, near_order(limb_count), limb_count, model.drag):
            return False
        if not _newton(z, terms, rows, model):
            return False
        for q in range(limb_count):
            z.place[q] += z.aside[q]
        carry_scalar(z.place, limb_count - 1)
        # where xdot is small against its last limb, rounding ends convergence before the shift is small enough
        shift = abs(double_of(z.aside, limb_count))
        stalled, previous = shift > 0.25 * previous and previous < EDGE, shift
        if stalled and shift >= NEAR:
            evaluate(rows, s, z.place, model.order, limb_count)
        if stalled or shift < NEAR:
            place = double_of(z.place, limb_count)
            return bool(z.low[i] - EDGE <= place <= z.high[i] + EDGE)
    return False


@compiled
def _newton(z: Search, terms: LinearTerms, rows: Array, model: Model) -> bool:
    """Apply Newton's method to the short series, from its centre: the place to `aside`, all lanes there to `rows`."""
    limb_count, short, order = model.limb_count, z.near, near_order(model.limb_count)
    enough, previous = 2.0 ** min(DERIVATIVE_BITS - (LIMB_BITS * limb_count - 1), -20), 1.0
    z.aside[:] = 0.0
    for _ in range(NEWTON_STEPS):
        xdot_of(rows, short, terms, limb_count)
        xdot = double_of(short.scalar, limb_count)
        xddot = xddot_of(rows, xdot, terms, model)
        if xddot == 0.0:
            return False
        shift = -xdot / xddot
        if not abs(shift) < 1.0:
            return False
        add_double(z.aside, shift, limb_count)
        evaluate(rows, short, z.aside, order, limb_count)
        stalled, previous = abs(shift) > 0.25 * previous and previous < EDGE, abs(shift)
        if stalled or abs(shift) < enough or not abs(double_of(z.aside, limb_count)) < NEAR:
            return True
    return False
