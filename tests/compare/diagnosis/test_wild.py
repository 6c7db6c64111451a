"""Explanations of public simulators: 30 trajectories of real programs, run at their own parameters."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from wild_programs import FOLDER, SETTINGS, TRUE, UNTOLD, read_in, said

from compare import Candidate, judge
from reference import load_scene

STEPS_S = {"w04": 0.3, "w06": 1.0, "w11": 1 / 60, "w25": 0.1}
ENOUGH = 0.9
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
    assert said(explained(name)) == TRUE[name] - UNTOLD.get(name, set())


def test_nine_of_ten_true_causes_are_those_that_are_named() -> None:
    assert all(UNTOLD[name] <= TRUE[name] for name in UNTOLD)
    assert sum(map(len, UNTOLD.values())) <= (1 - ENOUGH) * sum(map(len, TRUE.values()))


@pytest.mark.parametrize("name", ["w07", "w10", "w23"])
def test_a_cause_that_is_not_told_moves_the_bob_by_less_than_the_tolerance(name: str) -> None:
    """In closed form, for the angle α of the swing, from the release to the last row."""
    scene, times, _ = read_in(name)
    exact = scene.exact
    length, amplitude = float(exact.length), math.hypot(*map(float, exact.position[:2]))
    angle = math.asin(amplitude / length)
    phase = math.sqrt(float(exact.gravity) / length) * float(times[-1])
    if name == "w07":  # a swing whose period grows by α²/16 is late by that part of its phase
        apart = amplitude * angle**2 / 16 * phase
    else:  # of a swing that is linear in x, and one that is linear in the angle: l sin(α cos φ)
        cosines = np.linspace(-1, 1, 2001)
        apart = float(np.abs(length * np.sin(angle * cosines) - amplitude * cosines).max())
    assert 0 < apart < 1e-6 * amplitude


def test_a_cord_of_a_quarter_of_the_earth_is_judged_by_the_swing_of_the_program() -> None:
    """Its plumb line leans by 45 degrees in the reference and not at all in the program, whose bob swings by 1 m."""
    score = judge(FOLDER / "w24.csv", load_scene("paris", SETTINGS["w24"]), explain=False)
    assert score.tolerance_m == pytest.approx(1e-6, rel=0.02) and not score.agrees


def test_the_sine_that_stands_for_a_cosine_is_shown() -> None:
    """x = x0 cos βt cos ωt + y0 cos βt sin ωt, where y0 sin βt cos ωt is meant."""
    said = explained("w13").slip
    assert "in the formula of x, cos ωt sin βt has 0 m where the model has 0.5 m" in said
    assert "in the formula of x, sin ωt cos βt has 0.5 m where the model has 0 m" in said
    assert "formula of y" not in said


@pytest.mark.parametrize("name", marked(*STEPS_S))
def test_steps_have_the_lengths_that_the_programs_take(name: str) -> None:
    steps = [one.value for one in explained(name).causes if "integrator" in one.id]
    assert steps == [pytest.approx(STEPS_S[name], rel=1e-9)]
