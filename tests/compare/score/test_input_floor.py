"""The input floor: how far rounding the inputs to doubles moves the bob, computed once per scene, for any end."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from small_scenes import make_scene

from compare.score.input_floor import input_floor
from reference import load, load_scene


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "floor"


def test_it_is_how_far_the_two_golden_readings_of_a_scene_are_apart():
    decimal, rounded = load("paris"), load("paris.binary64")
    apart = [
        [float(a - b) for a, b in zip(decimal.exact(c), rounded.exact(c), strict=True)]
        for c in "xyz"
    ]
    moved = np.maximum.accumulate(np.linalg.norm(np.array(apart), axis=0))
    paris = load_scene("paris")
    for row in (60, 720, 1440):
        assert input_floor(paris, 60.0 * row) == pytest.approx(moved[row], rel=0.05), row


def test_ends_within_a_factor_of_two_share_one_run(own_cache):
    scene = make_scene("mine", run={"t_end": "20", "grid_step": "5"})
    floors = {}
    for runs, ends in ((1, (20.0, 15.0, 10.1)), (2, (10.0, 5.1)), (3, (5.0, 2.51)), (4, (25.0,))):
        for end in ends:
            floors[end] = input_floor(scene, end)
            assert len(list(own_cache.iterdir())) == runs, end
    assert input_floor(scene.with_values(["inputs=binary64"]), 20.0) == floors[20.0]
    assert len(list(own_cache.iterdir())) == 4
    assert all(floors[a] <= floors[b] for a, b in pairwise(sorted(floors)))


def test_a_short_run_is_not_told_what_a_long_one_loses():
    paris = load_scene("paris", ["site.latitude=40"])
    whole = input_floor(paris, 86400.0)
    assert 0 < input_floor(paris, 10.0) < whole / 100
    assert 0 < input_floor(paris, 43201.0) < input_floor(paris, 80000.0) <= whole


def test_an_end_at_the_start_or_beyond_the_scene_has_a_floor_too():
    scene = make_scene("mine", run={"t_end": "20", "grid_step": "5"})
    rounded = [
        float(Fraction(text) - Fraction(float(text))) for text in (scene.release.x, scene.release.y)
    ]
    assert input_floor(scene, 0.0) == pytest.approx(np.hypot(*rounded), rel=1e-3)
    assert input_floor(scene, 25.0) > input_floor(scene, 20.0) > 0


def test_inputs_that_are_doubles_have_no_floor():
    release = {"x": "0.25", "y": "0.5"}
    site = {"latitude": "45", "gravity": "9.75", "rotation_rate": "0.0001220703125", "equatorial_radius": "6378137",
            "inverse_flattening": "256"}  # fmt: skip
    assert (
        input_floor(make_scene("exact", site=site, release=release, run={"t_end": "20"}), 20.0) == 0
    )
