"""A box of inputs: every pendulum with inputs in it is where the proof says, by limbs at forty digits."""

import pytest
from boxes import BOXES, box_of, check_runs, proof_of


@pytest.mark.parametrize("name", BOXES)
def test_every_pendulum_of_a_box_lies_inside(name, size):
    box, times = box_of(name)
    check_runs(name, box, proof_of(box, times).proved, size(4, 1000))
