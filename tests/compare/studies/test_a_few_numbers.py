"""Five numbers of measurements on the Paris pendulum that a newcomer can check by eye."""

import pytest

from compare.methods import METHODS
from compare.studies.measure import Bench
from compare.studies.row import GridTruth
from compare.studies.stability import digits_requested
from compare.truth import golden_of
from reference import load_scene


def test_runge_kutta_over_two_minutes():
    pytest.importorskip("numba")
    scene = load_scene("paris", ["inputs=binary64", "run.t_end=120"])
    bench = Bench(scene, GridTruth(golden_of(scene), 120.0), 8.0, repeats=1)
    coarse, fine = (bench.row(METHODS["rk4"], "plane", step_s) for step_s in (0.2, 0.1))

    # 120 s in steps of 0.2 and 0.1 s, each of four calls
    assert (coarse.steps, fine.steps) == (600, 1200)
    assert fine.rhs_evaluations == 4800
    # half the step, a sixteenth of the error
    assert coarse.error_m / fine.error_m == pytest.approx(16, rel=0.1)
    # the phase falls back by (ω h)⁴ / 120 of itself, ω = 0.382/s: 46 rad · (0.038)⁴ / 120 of 0.6 m
    assert fine.error_m == pytest.approx(46 * 0.0382**4 / 120 * 0.596, rel=0.3)
    # a step of a 200th of a swing: (2π / 200)⁴ is 1e-6
    assert digits_requested("rk4", 1 / 200) == pytest.approx(6.0, abs=0.02)
