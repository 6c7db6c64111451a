"""Derivatives to inputs, by differences of runs of limbs at forty digits; and what follows from them is true."""

from fractions import Fraction
from random import Random

import pytest
from boxes import (
    BOXES,
    box_of,
    drawn,
    inputs_of,
    ordered,
    outside,
    proof_of,
    truth,
    widened,
    widths_over_hulls,
    wrong_derivatives,
)

from reference.enclosure.shapes import Box


def narrow_box_of(name):
    """A box whose flattening is exact, as scenes give its inverse."""
    box, times = box_of(name)
    widths = {key: width for key, width in BOXES[name][2].items() if key != "flattening"}
    return widened(box.inputs, widths), times


@pytest.mark.parametrize("name", BOXES)
def test_every_pendulum_lies_in_what_follows_from_derivatives(name, size):
    box, times = narrow_box_of(name)
    halves = {key: half for key, half in inputs_of(box).items() if half}
    proved, rng = proof_of(box, times, halves).proved, Random(name)
    assert proved.transits
    assert ordered(proved)
    runs = [truth(drawn(box, rng, corner=k % 2 == 0), times) for k in range(size(4, 1000))]
    for run in runs:
        assert outside(proved, run) == []
    ratios = widths_over_hulls(proved, runs)
    print(f"\n{name}: {len(runs)} runs, {len(proved.transits)} transits; widths over hulls", end=" ")
    print(", ".join(f"{column} {ratio:.2f}" for column, ratio in ratios.items()))


@pytest.mark.parametrize("name", BOXES)
@pytest.mark.parametrize("point", [True, False])
def test_differences_of_runs_lie_inside(name, point, size):
    box, times = narrow_box_of(name)
    halves, rng = inputs_of(box), Random(name)
    if point:
        box, halves = Box(box.inputs, box.inputs, box.inputs), dict.fromkeys(halves, Fraction(0))
    found = proof_of(box, times, halves).derivatives
    assert found.names == tuple(halves)
    for key in rng.sample(list(halves), size(2, len(halves))):
        if point:  # and they say much
            j = found.names.index(key)
            for row in found.states[1:]:
                far = max(max(abs(x.low), abs(x.high)) for x in row[j][:3])
                assert all(x.high - x.low <= far / 10**5 for x in row[j][:3])
        assert wrong_derivatives(found, box.inputs, key) == []
        if not point:
            assert wrong_derivatives(found, drawn(box, rng, corner=True), key) == []
