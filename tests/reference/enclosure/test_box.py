"""A box of inputs: every pendulum with inputs in it is where the proof says, by limbs at forty digits."""

import pytest
from boxes import BOXES, box_of, check_runs, proof_of

IN_EVERY_RUN = ("release", "fast and damped", "effective", "late", "tiny box", "turning table")
NAMES = [
    name if name in IN_EVERY_RUN else pytest.param(name, marks=pytest.mark.long) for name in BOXES
]


# the others with derivatives, where what is proved for a box is held as well
@pytest.mark.parametrize("name", NAMES)
def test_every_pendulum_of_a_box_lies_inside(name, size):
    box, times = box_of(name)
    check_runs(name, box, proof_of(box, times).proved, size(4, 1000))
