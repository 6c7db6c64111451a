"""Zeros of a step's polynomial, isolated: those of decaying oscillations, whose series of many terms are the step's."""

from __future__ import annotations

from fractions import Fraction
from math import floor, pi

import mpmath
import pytest

from reference.engines.passages import Places
from reference.errors import IntegrationError

BITS, TERMS = 711, 260
THIRD = Fraction(1, 3)


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
    """As steps have it where drag has all but ended a swing; double, which is tried first, shows noise from 20 on."""
    xdot = places(decay, turns)
    zeros = list(xdot.isolated(1, xdot.sign(1 << BITS)))
    true = [(k + 0.5) * pi / turns for k in range(floor(turns / pi + 0.5))]
    assert [xdot.root(zero) / (1 << BITS) for zero in zeros] == pytest.approx(true, rel=1e-12)
    assert [zero.sign_before for zero in zeros] == [(-1) ** k for k in range(len(true))]


def parabola(depth, bits, least=0):
    """(s - 1/3)**2 - depth."""
    return Places(
        [int(c * 2**bits) for c in (THIRD**2 - depth, -2 * THIRD, Fraction(1))],
        least,
        bits,
        "gate 0",
    )


@pytest.mark.parametrize("bits", [117, 711])
@pytest.mark.parametrize("power", [4, 40, 90])
def test_two_zeros_that_almost_meet_are_told_from_none(power, bits):
    """By the depth of the dip, down to about what the integers hold; between two signs that agree."""
    dip = parabola(Fraction(1, 1 << power), bits)
    zeros = list(dip.isolated(1, 1))
    assert [zero.sign_before for zero in zeros] == [1, -1]
    roots = [Fraction(dip.root(zero), 1 << bits) for zero in zeros]
    assert [abs(root - THIRD) for root in roots] == pytest.approx(
        [Fraction(1, 1 << power // 2)] * 2, rel=1e-6
    )
    assert list(parabola(-Fraction(1, 1 << power), bits).isolated(1, 1)) == []


@pytest.mark.parametrize("bits", [117, 711, 2000])
@pytest.mark.parametrize("side", [-1, 0, 1])
def test_what_touches_zero_as_far_as_the_integers_tell_is_refused(side, bits):
    """Or as far as the digits tell, of which 2**-11 is left."""
    for depth, least in (
        (Fraction(side, 1 << bits - 1), 0),
        (Fraction(side, 1 << 20), 1 << bits - 11),
    ):
        with pytest.raises(IntegrationError, match="gate 0: the motion touches this section"):
            list(parabola(depth, bits, least).isolated(1, 1))
