"""Absolute tolerances are parts of each variable's own swing: that of z is l(1 - cos angle), not that of x (F6)."""

from __future__ import annotations

import numpy as np
import pytest
from places import ROOT

from compare.methods.rhs.problem import Problem
from reference import load, load_scene
from reference.numbers.columns import STATE


@pytest.mark.parametrize("name", ["paris", "paris_measured", "hard", "pantheon"])
def test_a_size_bounds_the_swing_of_its_variable_and_is_not_far_above(name: str) -> None:
    scene = load_scene(name, ["inputs=binary64"])
    golden, length = load(ROOT / "data/golden" / name), float(scene.exact.length)
    x, y, z, vx, vy, vz = (getattr(golden, column) / length for column in STATE)
    aside, speed = np.hypot(x, y).max(), np.sqrt(vx**2 + vy**2 + vz**2).max()
    swings = np.array([aside, aside, (z + 1).max(), speed, speed, np.abs(vz).max()])
    sizes = Problem.of(scene, "space", [0.0, 1.0]).sizes
    assert (sizes > 0.999 * swings).all()
    assert (sizes < 4 * swings).all()
    np.testing.assert_array_equal(Problem.of(scene, "plane", [0.0, 1.0]).sizes, sizes[[0, 1, 3, 4]])
