"""Five numbers of a swing that classical Runge-Kutta makes, to be checked by eye."""

import numpy as np
import pytest

from compare.methods.rhs.problem import Problem
from reference import load_scene

QUARTER_S = 4.109  # of the period 2π sqrt(67 / 9.79) = 16.44 s


def test_a_swing_in_paris(installed):
    rk4 = installed("rk4")
    times = QUARTER_S * np.arange(5)
    outcome = rk4.prepare(
        Problem.of(load_scene("paris", ["inputs=binary64"]), "plane", times), 0.01
    )()
    x, y, z, vx, vy, _ = outcome.states.T

    # released at rest 0.5 m aside, which is 0.5² / (2 · 67) m = 1.87 mm above the lowest point
    assert (x[0], y[0]) == (pytest.approx(0.3), pytest.approx(0.4))
    assert z[0] + 67 == pytest.approx(0.00187, abs=1e-5)
    # after a quarter of the period near the point of rest, 0.115 m south of the vertical
    assert (x[1], y[1]) == (pytest.approx(0, abs=1e-3), pytest.approx(-0.115, abs=1e-3))
    # there as fast as the distance from it, 0.596 m, times 2π / 16.44 s
    assert np.hypot(vx[1], vy[1]) == pytest.approx(0.596 * 0.3822, rel=1e-3)
    # after the whole period back, and turned clockwise by 11.33 degrees an hour: 0.9 mrad
    assert (x[4], y[4]) == (pytest.approx(0.3, abs=1e-3), pytest.approx(0.4, abs=1e-3))
    # four calls of the right-hand side a step
    assert outcome.rhs_evaluations == 4 * outcome.steps
