"""Five numbers of a verdict on two rows of the Paris pendulum, one of them a millimetre off."""

import numpy as np
import pytest

from compare.candidates.candidate import Candidate
from compare.score.judge import judge

ROW = {"x": np.array([0.3, -0.176326733]), "y": np.array([0.4, -0.415867688])}  # at 0 and 60 s


def test_a_millimetre_in_paris():
    wrong = ROW | {"y": ROW["y"] + [0.0, 0.001]}
    score = judge(Candidate.of("mine", np.array([0.0, 60.0]), wrong), "paris", explain=False)
    assert not score.agrees
    assert score.errors.max_m == pytest.approx(0.001, rel=1e-5)
    assert score.tolerance_m == pytest.approx(7.11e-7, rel=1e-2)  # a millionth of the amplitude
    assert score.errors.amplitude_m == pytest.approx(0.711, rel=1e-3)
    assert judge(Candidate.of("mine", np.array([0.0, 60.0]), ROW), "paris").errors.max_m < 1e-9
