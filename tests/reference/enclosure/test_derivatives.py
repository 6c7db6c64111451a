"""Derivatives to inputs, by differences of runs of limbs at forty digits; and what follows from them is true."""

from fractions import Fraction
from functools import cache
from random import Random

import pytest
from boxes import BOXES, box_of, check_runs, drawn, inputs_of, proof_of, widened, wrong_derivatives

from reference.enclosure.shapes import Box

# by position with drag, by angles with all inputs at once, above the horizontal, with effective gravity
IN_EVERY_RUN = ("only drag", "fast", "very wide", "effective, fast")
NAMES = [name if name in IN_EVERY_RUN else pytest.param(name, marks=pytest.mark.long) for name in BOXES]


def narrow_box_of(name):
    """A box whose flattening is exact, as scenes give its inverse."""
    box, times = box_of(name)
    widths = {key: width for key, width in BOXES[name][2].items() if key != "flattening"}
    return widened(box.inputs, widths), times


@cache
def proof_with_derivatives(name):
    """The proof of a box with derivatives to all inputs, also to those that it does not vary."""
    box, times = narrow_box_of(name)
    return proof_of(box, times, inputs_of(box))


@pytest.mark.parametrize("name", NAMES)
def test_every_pendulum_lies_in_what_follows_from_derivatives(name, size):
    check_runs(name, narrow_box_of(name)[0], proof_with_derivatives(name).proved, size(4, 1000))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("point", [True, False])
def test_differences_of_runs_lie_inside(name, point, size):
    box, times = narrow_box_of(name)
    halves, rng = inputs_of(box), Random(f"{name} {point}")
    if point:
        box, halves = Box(box.inputs, box.inputs, box.inputs), dict.fromkeys(halves, Fraction(0))
        found = proof_of(box, times, halves).derivatives
    else:
        found = proof_with_derivatives(name).derivatives
    assert found.names == tuple(halves)
    for key in rng.sample(list(halves), size(1, len(halves))):
        if point:  # and they have four digits; shares are printed with two
            j = found.names.index(key)
            for row in found.states[1:]:
                far = max(max(abs(x.low), abs(x.high)) for x in row[j][:3])
                assert all(x.high - x.low <= far / 10**4 for x in row[j][:3])
        assert wrong_derivatives(found, box.inputs, key) == []
        if not point:
            assert wrong_derivatives(found, drawn(box, rng, corner=True), key) == []
