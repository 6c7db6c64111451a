"""Explanations of public simulators: 30 trajectories of real programs, run at their own parameters."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import pytest
from wild_programs import FOLDER, ONE_OF, SETTINGS, TRUE, UNTOLD, one_of, read_in, said

from compare import Candidate, judge
from reference import load_scene

STEPS_S = {"w04": 0.3, "w06": 1.0, "w11": 1 / 60, "w25": 0.1}
ENOUGH = 0.8  # of the true causes, that are certain or one of several
ONE_OF_SEVERAL = 0.3  # of these, at most
# the others under --long
ALWAYS = ("w01", "w04", "w06", "w18", "w24", "w25", "w27", "w30")


@cache
def explained(name: str) -> Any:
    """Return what is said of a trajectory."""
    scene, times, columns = read_in(name)
    x, y, *_ = (float(place) for place in scene.exact.position)
    return judge(
        Candidate.of(name, times, columns), scene, tolerance=1e-6 * math.hypot(x, y)
    ).explanation


def marked(*names: str) -> list[Any]:
    """Return names as parameters of a test, those that take long under --long."""
    return [
        name if name in ALWAYS else pytest.param(name, marks=pytest.mark.long) for name in names
    ]


@pytest.mark.parametrize("name", marked(*TRUE))
def test_true_causes_are_named_and_none_is_wrong(name: str) -> None:
    words, true = said(explained(name)), TRUE[name]
    if any(word.startswith("integrator") for word in true):
        true = true | {"integrator_loose"}  # which says less, and is true
    assert words <= true
    assert words >= TRUE[name] - UNTOLD.get(name, set()) - ONE_OF.get(name, set())
    assert one_of(explained(name)) >= ONE_OF.get(name, set())


def test_most_true_causes_are_told_and_few_as_one_of_several() -> None:
    assert all(words <= TRUE[name] for name, words in (*UNTOLD.items(), *ONE_OF.items()))
    causes = sum(map(len, TRUE.values()))
    told = causes - sum(map(len, UNTOLD.values()))
    assert told >= ENOUGH * causes
    assert sum(map(len, ONE_OF.values())) <= ONE_OF_SEVERAL * told


def test_a_cord_of_a_quarter_of_the_earth_is_judged_by_the_swing_of_the_program() -> None:
    """Its plumb line leans by 45 degrees in the reference and not at all in the program, whose bob swings by 1 m."""
    score = judge(FOLDER / "w24.csv", load_scene("paris", SETTINGS["w24"]), explain=False)
    assert score.tolerance_m == pytest.approx(1e-6, rel=0.02) and not score.agrees


@pytest.mark.parametrize("name", marked(*STEPS_S))
def test_steps_have_the_lengths_that_the_programs_take(name: str) -> None:
    steps = [one.value for one in explained(name).causes if "integrator" in one.id]
    assert steps == [pytest.approx(STEPS_S[name], rel=1e-9)]
