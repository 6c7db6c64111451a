"""What the lemmas take for granted is demanded: nothing is proved where a premise does not hold."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType

import pytest

from reference import load_scene
from reference.enclosure.trusted.box import BoxBalls, Windows
from reference.enclosure.trusted.derivatives import Tangents
from reference.enclosure.trusted.printed_box import end_of
from reference.enclosure.trusted.sections import form
from reference.enclosure.trusted.shapes import Box, EnclosedZero, Interval
from reference.enclosure.trusted.system import SceneBalls

PARIS = load_scene("paris").exact
WIDTHS = MappingProxyType({"pendulum.length": Fraction(1, 1000)})
TEXTS = {"pendulum.length": "±0.001"}


@pytest.mark.parametrize("text", ["-0.001", "±-0.001"])
def test_a_box_is_not_turned_inside_out_by_a_negative_width(text):
    """Lemma 12.4 adds the widths: with a negative one it would take where it has to add."""
    with pytest.raises(ArithmeticError, match="negative width"):
        end_of(PARIS, {"pendulum.length": text}, 1)


def test_derivatives_refuse_a_box_that_is_turned_inside_out():
    low, high = (end_of(PARIS, TEXTS, side) for side in (-1, 1))
    swapped = BoxBalls(Box(PARIS, high, low), 200)
    with pytest.raises(ArithmeticError, match="negative width"):
        Tangents(swapped, {name: -width for name, width in WIDTHS.items()}, {"pendulum.length": 0})


@pytest.mark.parametrize("word", ["fence 30", "Turn 30", "gate", "turn 30@0", "gate 30@0@0"])
def test_a_word_that_names_no_section_has_no_form(word):
    with pytest.raises((ArithmeticError, ValueError)):
        form(SceneBalls(PARIS, 200), word)


def test_a_release_by_x_and_y_on_the_level_of_the_suspension_is_refused():
    x, vx = PARIS.length * Fraction(3, 5), Fraction(1)
    position = (x, PARIS.length * Fraction(4, 5), vx, -vx * Fraction(3, 4))
    with pytest.raises(ArithmeticError, match="below the suspension"):
        SceneBalls(replace(PARIS, position=position), 200)


def test_zeros_that_may_come_up_to_the_end_are_the_first_ones():
    """A wide interval that begins before the end, after one that begins behind it, is not paired wrongly."""
    box = Box(PARIS, end_of(PARIS, TEXTS, -1), end_of(PARIS, TEXTS, 1))
    windows = Windows(box, 200, [Fraction(0), Fraction(10)], ())
    here = Interval(Fraction(0), Fraction(1))

    def zero(low, high):
        t = Interval(Fraction(low), Fraction(high))
        return EnclosedZero("one", 1, t, here, here, here, here)

    first, beyond = zero(8, 9), zero(12, 13)
    assert len(windows._in_own_time((first, beyond))) == 1
    with pytest.raises(ArithmeticError, match="order"):
        windows._in_own_time((beyond, first))
