"""Guess times close to a zero, on both sides of it. Untrusted: the proof checks the signs there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb, arb_poly, ctx

SHORT = 64  # bits in which Newton's method begins
# of the Taylor series, enough for this: a coefficient is about a quarter of the one before
ORDERS = 40
POLISH = 24  # steps of Newton's method from the middle of a leaf to a zero, in few bits, at most
NEAR = arb(2) ** -28  # a step so short is the last: the error left is about its square
NEGLIGIBLE = arb(2) ** -12  # part of what the form is uncertain by
MARGIN = 1 + arb(2) ** -8  # farther from the zero than the form is uncertain


def around_zero(leaves: Sequence[Any]) -> tuple[arb, arb]:
    """Return exact times close to a zero of the form's polynomial, one on each side: proposals.

    Args:
        leaves: neighbouring `Leaf`s, of which the middle one is taken.
    """
    leaf = leaves[len(leaves) // 2]
    form = leaf.form
    f = arb_poly(form.value.polynomial)
    rate = arb_poly(form.rate.polynomial)

    middle = ((leaf.low + leaf.high) / 2).mid()
    with ctx.workprec(SHORT):
        s = _in_few_bits(form, f, rate, middle)
        slope = rate(s).mid()

    # in all bits the polynomial itself takes two thirds of the time of the balls
    value = form.value.polynomial(s)
    width = form.value.off.rad() * form.unit
    for _ in range(ctx.prec // SHORT):
        if abs(value) < NEGLIGIBLE * width:
            break
        s = (s - value / slope).mid()
        value = form.value.polynomial(s)

    away = MARGIN * (width + abs(value)) / abs(slope)
    before = form.centre + (s - away) * form.piece.constants.h
    after = form.centre + (s + away) * form.piece.constants.h
    return before.mid(), after.mid()


def _in_few_bits(form: Any, f: arb_poly, rate: arb_poly, s: arb) -> arb:
    """Return about where Newton's method leads from `s`."""
    if form.short is None:
        short_f = f.truncate(ORDERS)
        short_rate = rate.truncate(ORDERS)
    else:
        short_f = form.short.value
        short_rate = form.short.rate
    for _ in range(POLISH):
        before = s
        s = (s - short_f(s).mid() / short_rate(s).mid()).mid()
        if abs(s - before) < NEAR:
            break
    return s
