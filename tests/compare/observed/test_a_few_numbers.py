"""Five numbers of the Paris pendulum, read off its rows."""

import numpy as np
import pytest

from compare.observed.swing_plane import (
    apsides,
    frequency,
    gauge_of,
    precession_period,
    rest_in_metres,
)
from reference import load_scene, trajectory


def test_paris_as_it_is_observed():
    paris = load_scene("paris", ["run.t_end=600"])
    times = np.linspace(0, 600, 6001)
    rows = trajectory(paris, times)
    gauge = gauge_of(paris)
    assert gauge is not None
    highest, _ = apsides(gauge, times, rows)
    assert highest[1] - highest[0] == pytest.approx(8.218, abs=1e-3)  # s, half a swing
    assert frequency(paris) == pytest.approx(0.0608436, abs=1e-7)  # Hz
    # m: it hangs south of the vertical
    assert rest_in_metres(paris)[1] == pytest.approx(-0.1152, abs=1e-4)
    # m from the vertical, at most
    assert np.hypot(*rows[:, :2].T).max() == pytest.approx(0.698, abs=1e-3)
    # hours for a full turn
    assert precession_period(paris) / 3600 == pytest.approx(31.74, abs=0.05)
