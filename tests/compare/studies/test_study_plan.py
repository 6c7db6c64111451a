"""The runs that a study makes, and grids whose times are doubles."""

from __future__ import annotations

from fractions import Fraction

import pytest

from compare.methods import METHODS
from compare.studies.stability import cut
from compare.studies.study import study
from compare.studies.study_plan import declared, on_doubles, plan, precision_items
from reference import InputError, load_scene, scene_ids

PARIS = load_scene("paris")


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


def test_the_runs_of_a_study_are_those_that_methods_declare() -> None:
    assert declared(["rk4"], "long_runs") == [("rk4", "plane", 0.05)]
    # minutes a scene
    assert {name for name, _, _ in declared(None, "stability")} == {*METHODS} - {"mpmath_odefun"}
    with pytest.raises(InputError, match="got 'mpmath_odefun', expected methods that declare runs"):
        declared(["rk4", "mpmath_odefun"], "stability")
    with pytest.raises(InputError, match="rk5"):
        declared(["rk5"], "stability")


@pytest.mark.parametrize(
    "runs", [lambda: study("paris", []), lambda: declared([], "stability"), lambda: plan(PARIS, ())]
)
def test_no_methods_are_not_all_of_them(runs):
    with pytest.raises(InputError, match="got no id, expected a method that can run here"):
        runs()


def test_precisions_of_some_methods_are_those_of_all_methods_chosen_from():
    whole = precision_items([113, 160])
    assert precision_items([113, 160], ["heyoka_real", "limbs"]) == [
        one for one in whole if one[0] in ("limbs", "heyoka_real")
    ]
    with pytest.raises(InputError, match=r"These have: .*limbs"):
        precision_items([113, 160], ["rk4"])
