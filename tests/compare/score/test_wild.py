"""Explanations of public simulators: 30 trajectories of real programs, run at their own parameters."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from wild_programs import FOLDER, SETTINGS, TRUE, UNTOLD, read_in, said

from compare.diagnosis.case import Explanation, Rows, largest
from compare.diagnosis.explain import KnownScene, explain
from compare.diagnosis.formulas import of_formula
from compare.score.judge import judge
from reference import load_scene

STEPS_S = {"w04": 0.3, "w06": 1.0, "w11": 1 / 60, "w25": 0.1}
ENOUGH = 0.9
# the others under --long: w13 alone, whose slip no cause explains, takes more than all of these
ALWAYS = ("w01", "w04", "w06", "w18", "w24", "w25", "w27", "w30")


@cache
def explained(name: str) -> Explanation:
    """Return what is said of a trajectory."""
    scene, times, columns = read_in(name)
    position = scene.exact.position
    assert position is not None
    return explain(times, columns, scene, 1e-6 * float(np.hypot(float(position[0]), float(position[1]))))


def marked(*names: str) -> list[Any]:
    """Return names as parameters of a test, those that take long under --long."""
    return [name if name in ALWAYS else pytest.param(name, marks=pytest.mark.long) for name in names]


@pytest.mark.parametrize("name", marked(*TRUE))
def test_true_causes_are_named_and_none_is_wrong(name: str) -> None:
    assert said(explained(name)) == TRUE[name] - UNTOLD.get(name, set())


def test_nine_of_ten_true_causes_are_those_that_are_named() -> None:
    assert all(UNTOLD[name] <= TRUE[name] for name in UNTOLD)
    assert sum(map(len, UNTOLD.values())) <= (1 - ENOUGH) * sum(map(len, TRUE.values()))


@pytest.mark.parametrize(
    ("name", "changes", "one", "other"),
    [
        ("w07", {"gravity_reading": "none"}, {"kind": "linear"}, {"kind": "sphere"}),
        ("w10", {"gravity_reading": "none"}, {"kind": "linear"}, {"kind": "angle"}),
        ("w23", {"gravity_reading": "none"}, {"kind": "linear"}, {"kind": "angle"}),
    ],
)
def test_a_cause_that_is_not_told_has_a_motion_that_others_have_as_well(
    name: str, changes: dict[str, Any], one: dict[str, Any], other: dict[str, Any]
) -> None:
    problem = KnownScene.of(load_scene("paris", [*SETTINGS[name], "inputs=binary64"]))
    times = np.loadtxt(FOLDER / f"{name}.csv", delimiter=",", skiprows=1)[:, 0]
    case = problem.case(Rows(times, np.zeros((len(times), 2)), 0.0), 0.0)
    program = problem.right.changed(**changes)
    apart = largest(case.positions(program.changed(**one)) - case.positions(program.changed(**other)))
    assert 0 < apart < 1e-6 * np.hypot(program.x, program.y)


def test_a_cord_of_a_quarter_of_the_earth_is_judged_by_the_swing_of_the_program() -> None:
    """Its plumb line leans by 45 degrees in the reference and not at all in the program, whose bob swings by 1 m."""
    score = judge(FOLDER / "w24.csv", load_scene("paris", SETTINGS["w24"]), explain=False)
    assert score.tolerance_m == pytest.approx(1e-6, rel=0.02) and not score.agrees


def slip_of_w13() -> str:
    """Return what is said of its formula, without a search for causes."""
    scene, times, columns = read_in("w13")
    problem = KnownScene.of(scene)
    formula = of_formula(problem.case(problem.rows(times, columns), 1e-6))
    assert formula is not None
    return formula.slip


def test_the_sine_that_stands_for_a_cosine_is_shown() -> None:
    """x = x0 cos βt cos ωt + y0 cos βt sin ωt, where y0 sin βt cos ωt is meant."""
    said = slip_of_w13()
    assert "in the formula of x, cos ωt sin βt has 0 m where the model has 0.5 m" in said
    assert "in the formula of x, sin ωt cos βt has 0.5 m where the model has 0 m" in said
    assert "formula of y" not in said


@pytest.mark.long
def test_the_slip_of_a_formula_is_in_the_explanation() -> None:
    assert explained("w13").slip == slip_of_w13()


@pytest.mark.parametrize("name", marked(*STEPS_S))
def test_steps_have_the_lengths_that_the_programs_take(name: str) -> None:
    steps = [one.value for one in explained(name).causes if "integrator" in one.id]
    assert steps == [pytest.approx(STEPS_S[name], rel=1e-9)]
