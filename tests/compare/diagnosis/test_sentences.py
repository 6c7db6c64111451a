"""Sentences of an explanation: digits, units, and what to do next."""

from __future__ import annotations

import numpy as np
import pytest

from compare.candidates.candidate import Deviation
from compare.diagnosis.case import Explanation
from compare.diagnosis.causes import fitted_number, shortest_decimal
from compare.diagnosis.explain import KnownScene, explain
from reference import load_scene, trajectory

MUSEUM = load_scene("museum", ["inputs=binary64", "run.transits=false"])


@pytest.mark.parametrize(
    ("free", "value", "uncertainty", "said"),
    [
        ("late", 0.0274796, 1e-4, "0.0275 s late"),
        ("late", -0.0077, 1e-6, "0.0077 s early"),
        ("drag", 1.00000001e-4, 1e-9, "0.0001 and not 0 per second"),
        ("y", 1e-12, 1e-9, "0 and not 0.6 m"),
        ("length", 20.010000001, 1e-8, "20.01 and not 20 m"),
        # however uncertain it is, it is not said to be the scene's
        ("length", 20.0004, 0.1, "20.0004 and not 20 m"),
        ("pace", 1 / 1.0001, 1e-3, "1.0001"),
    ],
)
def test_a_number_has_its_unit_and_the_digits_that_are_known(
    free: str, value: float, uncertainty: float, said: str
) -> None:
    cause = fitted_number(free, free, "{value}", free)
    assert cause.sentence(value, uncertainty, KnownScene.of(MUSEUM).right) == said


def test_zero_is_the_shortest_decimal_of_a_number_that_may_be_zero() -> None:
    assert shortest_decimal(1e-12, 1e-9)[0] == 0.0
    assert shortest_decimal(1e-12, 1e-13)[0] == 1e-12


def moved(axis: str) -> Deviation:
    return Deviation("column_moved", f"prints {axis} with 1 m added to it", 1.0)


def test_advice_is_given_once_for_lines_that_follow_each_other() -> None:
    other = Deviation("unit_of_length", "is in feet", 1.0)
    parts = (moved("x"), moved("y"), other, moved("z"))
    lines = list(Explanation(conventions=parts, corrected_m=0.0, explains=True).lines())
    starts = [line.split()[0] for line in lines[:-1]]
    assert starts == ["Your", "Your", "→", "Your", "→", "Your", "→"]


@pytest.mark.parametrize(("spacing_s", "denser"), [(0.5, False), (2.0, True)])
def test_denser_rows_are_asked_for_where_there_are_half_as_many(
    spacing_s: float, denser: bool
) -> None:
    """Noise, in rows of the museum's pendulum, whose swing takes 9 s."""
    times = np.arange(0, 300, spacing_s)
    positions = trajectory(MUSEUM, times)[:, :2]
    positions += 1e-3 * np.random.default_rng(1).standard_normal(positions.shape)
    columns = {"x": positions[:, 0].copy(), "y": positions[:, 1].copy()}
    found = explain(times, columns, MUSEUM, 1e-6)
    assert not found.known
    assert found.next_step.startswith("print at least 20 rows a swing") is denser


def test_the_head_of_a_score_has_all_digits_of_its_times(foucault, tmp_path) -> None:
    times = 0.005 + np.arange(0, 1201, 400.0)
    positions = trajectory(MUSEUM, [0.0, *times])[1:, :3]
    path = tmp_path / "mine.csv"
    rows = np.column_stack([times, positions])
    np.savetxt(path, rows, delimiter=",", header="t,x,y,z", comments="", fmt="%.17g")
    assert "t = 0.005 to 1200.005 of 3600 s" in foucault("score", "museum", path)[1]
