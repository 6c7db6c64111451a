"""A box of inputs: every pendulum with inputs in it is where the proof says, by limbs at forty digits."""

from random import Random

import pytest
from boxes import BOXES, box_of, drawn, ordered, outside, proof_of, truth, widths_over_hulls


@pytest.mark.parametrize("name", BOXES)
def test_every_pendulum_of_a_box_lies_inside(name, size):
    box, times = box_of(name)
    proved, rng = proof_of(box, times).proved, Random(name)
    assert proved.transits
    assert ordered(proved)
    runs = [truth(drawn(box, rng, corner=k % 2 == 0), times) for k in range(size(4, 1000))]
    for run in runs:
        assert outside(proved, run) == []
    ratios = widths_over_hulls(proved, runs)
    print(f"\n{name}: {len(runs)} runs, {len(proved.transits)} transits; widths over hulls", end=" ")
    print(", ".join(f"{column} {ratio:.2f}" for column, ratio in ratios.items()))
