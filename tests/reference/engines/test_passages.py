"""Zeros of a step's polynomial, isolated: those of decaying oscillations, whose series of many terms are the step's."""

from __future__ import annotations

from math import floor, pi

import mpmath
import pytest

from reference.engines.passages import Places

BITS, TERMS = 711, 260


def places(decay, turns, least=0):
    """e**(-decay s) cos(turns s) as integers over its largest coefficient, to 2**-BITS."""
    with mpmath.workprec(2 * BITS):
        rate = mpmath.mpc(-decay, turns)
        terms = [mpmath.re(rate**k) / mpmath.factorial(k) for k in range(TERMS)]
        largest = max(map(abs, terms))
        return Places([int(term / largest * 2**BITS) for term in terms], least, BITS, "xdot")


@pytest.mark.parametrize("decay", [0, 1, 20])
@pytest.mark.parametrize("turns", [1, 2, 5, 9, 20, 30])
def test_all_zeros_of_a_long_step_are_found_in_order(decay, turns):
    """A step of a small swing holds several swings; double, which is looked at first, shows noise alone from 20 on."""
    xdot = places(decay, turns)
    found = [(xdot.root(*piece), piece[2]) for piece in xdot.isolated(1, xdot.sign(1 << BITS))]
    true = [(k + 0.5) * pi / turns for k in range(floor(turns / pi + 0.5))]
    assert [s / (1 << BITS) for s, _ in found] == pytest.approx(true, rel=1e-12)
    assert [before for _, before in found] == [(-1) ** k for k in range(len(true))]
