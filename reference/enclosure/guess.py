"""Where a zero may be: times on both sides of it, close by. Untrusted: the signs of xdot at both are proved."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb, arb_poly, ctx

SHORT = 64  # bits in which Newton's method begins
# of the Taylor series, enough for this: a coefficient is about a quarter of the one before
ORDERS = 40
POLISH = 24  # steps of Newton's method from the middle of a leaf to a zero, in few bits, at most:
NEAR = arb(2) ** -28  # a last one so short has come near: what is left is about its square
NEGLIGIBLE = arb(2) ** -12  # part of what xdot is uncertain by
MARGIN = 1 + arb(2) ** -8  # farther from the zero than xdot is uncertain


def around_zero(leaves: Sequence[Any]) -> tuple[arb, arb]:
    """Return exact times between which p'_x has a zero, about: proposals, which prove nothing.

    Args:
        leaves: neighbouring `Leaf`s, of which the middle one is taken.
    """
    leaf = leaves[len(leaves) // 2]
    slope, s = leaf.slope, ((leaf.low + leaf.high) / 2).mid()
    (f, off), (g, _) = slope.forms
    f, g = arb_poly(f), arb_poly(g)  # whose values take half the time of those of integers
    with ctx.workprec(SHORT):
        short_f, short_g = getattr(slope, "short", None) or (f.truncate(ORDERS), g.truncate(ORDERS))
        for _ in range(POLISH):
            before, s = s, (s - short_f(s).mid() / short_g(s).mid()).mid()
            if abs(s - before) < NEAR:
                break
        rate = g(s).mid()
    value, width = f(s), off.rad() * slope.unit
    for _ in range(ctx.prec // SHORT):
        if abs(value) < NEGLIGIBLE * width:
            break
        s = (s - value / rate).mid()
        value = f(s)
    away = MARGIN * (width + abs(value)) / abs(rate)
    low, high = (slope.centre + (s + way * away) * slope.piece.constants.h for way in (-1, 1))
    return low.mid(), high.mid()
