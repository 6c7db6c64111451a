"""What is said of a file's conventions, of right and wrong files alike."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
from mistakes import told
from scipy.special import ellipj, ellipk
from small_scenes import make_scene

from compare.diagnosis.case import FileRows
from compare.diagnosis.conventions import heights


def test_no_wide_swing_counts_time_in_another_unit(size):
    """100 exact pendulums of 30° to 85° in a plane (Jacobi's elliptic functions), rows 0.02 s to 1 s apart.

    Their g is 9.81 m/s² where the scene has 9.8, and nothing else is wrong. In every run each thirteenth of them.
    """
    length, rate = 67.0, math.sqrt(9.81 / 67.0)
    site = {"gravity": "9.8", "gravity_is": "effective", "rotation_rate": "0"}
    swings = product(
        (30, 40, 50, 55, 60, 65, 70, 75, 80, 85),
        (0.02, 0.033333, 0.05, 0.1, 0.14, 0.2, 0.25, 0.3, 0.5, 1.0),
    )
    for degrees, step in list(swings)[:: size(13, 1)]:
        modulus = math.sin(math.radians(degrees) / 2)
        span = 20 * 4 * ellipk(modulus**2) / rate
        times = np.arange(0, min(span, 60) if step < 0.3 else span, step)
        _, cosine, delta, _ = ellipj(rate * times, modulus**2)
        half = modulus * cosine / delta  # sin(θ/2), greatest at t = 0
        x = 2 * length * half * np.sqrt(1 - half**2)
        release, run = (
            {"angle": str(degrees), "azimuth": "0"},
            {"t_end": repr(float(times[-1])), "transits": False},
        )
        scene = make_scene("wide", pendulum={"length": "67"}, site=site, release=release, run=run)
        found = told(scene, times, {"x": x, "y": 0 * x}, 1e-6)
        assert not found.agrees
        assert found.words == {"gravity_9.81"}, (degrees, step)


def test_a_bob_that_leaves_the_sphere_keeps_its_horizontal_columns_in_order():
    """Columns x, height, north of a cord of 10 m that stretches: without heights, x and north are left."""
    times = 0.1 * np.arange(100)
    cord = 10 + 1e-4 * np.sin(3 * times)
    east, north = 0.5 * np.cos(times), 0.3 * np.sin(times)
    down = -np.sqrt(cord**2 - east**2 - north**2)
    read = heights(FileRows(times, np.column_stack([east, down, north]), 0.0, 0.0), 10.0)
    assert [part.id for part in read.conventions] == ["vertical_is_not_z", "off_the_sphere"]
    np.testing.assert_array_equal(
        np.sort(np.abs(read.plane).max(axis=0)), [0.3 * np.abs(np.sin(times)).max(), 0.5]
    )
