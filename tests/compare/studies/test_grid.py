"""Grids whose times are doubles."""

from __future__ import annotations

from fractions import Fraction

import pytest

from compare.studies.stability import cut
from compare.studies.study_plan import on_doubles
from reference import load_scene, scene_ids


def test_a_grid_of_doubles_stays_as_it_is():
    scene = load_scene("paris", ["inputs=binary64"])
    assert on_doubles(scene) == scene


@pytest.mark.parametrize("name", scene_ids())
def test_every_scene_gets_times_that_are_doubles_and_about_as_many(name: str) -> None:
    scene = load_scene(name, ["inputs=binary64"])
    moved = on_doubles(scene)
    assert all(Fraction(float(t)) == t for t in moved.exact.grid)
    assert float(moved.exact.t_end) == pytest.approx(float(scene.exact.t_end), rel=0.01)
    assert len(moved.exact.grid) == pytest.approx(len(scene.exact.grid), rel=0.01, abs=1)
    assert cut(load_scene(name)).exact.t_end <= moved.exact.t_end
