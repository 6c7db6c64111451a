"""Where a zero may be: a point to begin interval Newton at. Untrusted: whatever it is, the step from it is proved."""

from __future__ import annotations

from flint import arb, ctx

from .balls import SHORT
from .shapes import Leaf

POLISH = 6  # steps of Newton's method from the middle of a leaf to a zero


def near_zero(leaf: Leaf) -> arb:
    """Return the time of a zero of p'_x, about: a proposal, which proves nothing."""
    (f, _), (g, _) = leaf.slope.forms
    full, s = ctx.prec, ((leaf.low + leaf.high) / 2).mid()
    with ctx.workprec(SHORT):
        for _ in range(POLISH):
            s = (s - f(s) / (rate := g(s))).mid()
    for _ in range(-(-full // SHORT)):
        s = (s - f(s) / rate.mid()).mid()
    time: arb = (leaf.slope.centre + s * leaf.slope.piece.k.h).mid()
    return time
