"""Files that once had false causes, stated as certain: wrong columns, clocks, an integrator like a formula."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from compare.candidates.candidate import Candidate
from compare.score.judge import judge
from reference import Scene, load_scene, trajectory

Columns = dict[str, np.ndarray]
TIMES = np.linspace(0, 120, 121)
LONG = pytest.mark.long


def paris(t_end_s: float, *settings: str) -> Scene:
    return load_scene("paris", [f"run.t_end={t_end_s}", "inputs=binary64", *settings])


def right_rows(scene: Scene, times: np.ndarray) -> Columns:
    return dict(zip(("x", "y", "z"), trajectory(scene, times).T[:3], strict=True))


def explained(scene: Scene, times: np.ndarray, columns: Columns) -> Any:
    found = judge(Candidate.of("mine", times, columns), scene)
    assert not found.agrees and found.explanation is not None
    return found.explanation


WRONG_COLUMNS: list[tuple[str, Callable[[Columns], Columns]]] = [
    ("y is x", lambda q: {"x": q["x"], "y": q["x"]}),
    ("y is 0", lambda q: {"x": q["x"], "y": 0 * q["y"]}),
    ("y is -x", lambda q: {"x": q["x"], "y": -q["x"]}),
    ("y is scaled", lambda q: {"x": q["x"], "y": 4 / 3 * q["y"]}),
    ("x is 0", lambda q: {"x": 0 * q["x"], "y": q["y"]}),
]


IN_EVERY_RUN = ("y is x", "y is scaled")


@pytest.mark.parametrize(
    ("change", "span_s"),
    [
        pytest.param(
            change,
            span_s,
            id=f"{name}-{span_s}",
            marks=() if span_s == 120 and name in IN_EVERY_RUN else LONG,
        )
        for name, change in WRONG_COLUMNS
        for span_s in (120, 600)
    ],
)
def test_no_cause_is_stated_that_spoils_a_right_column(
    change: Callable[[Columns], Columns], span_s: int
) -> None:
    scene = paris(span_s)
    times = np.linspace(0, span_s, span_s + 1)
    found = explained(scene, times, change(right_rows(scene, times)))
    assert found.causes == ()
    assert [convention.id.partition("_")[0] for convention in found.conventions] == ["column"]


def test_a_baseline_names_the_column_that_is_printed_wrongly_now_and_nothing_else() -> None:
    scene = paris(120)
    columns = right_rows(scene, TIMES)
    old = Candidate.of("old", TIMES, {"x": columns["x"], "y": columns["y"]})
    new = Candidate.of("new", TIMES, {"x": columns["x"], "y": columns["x"]})
    since = judge(new, scene, baseline=old).since
    assert since is not None and since.worse and since.complete
    assert since.changes == ("its file now prints x in its column of y",)


@pytest.mark.parametrize(
    "factor",
    [
        1.0001,
        *(pytest.param(factor, marks=LONG) for factor in (86400 / 86164.1, 30 / 29.97, 1.001)),
    ],
)
def test_a_clock_is_no_gravity_and_no_rotation_for_certain(factor: float) -> None:
    """A clock slow by k is a g of k⁻² and a rotation of k⁻¹, each of few digits for some k."""
    scene = paris(700)
    times = np.linspace(0, 600, 601)
    found = explained(scene, times * factor, right_rows(scene, times))
    assert [cause.id for cause in found.known] == ["clock"]
    assert 1 / found.known[0].value == pytest.approx(factor, rel=1e-9)


@pytest.mark.parametrize("height_m", [3.0, 1000.0])
def test_heights_from_another_point_are_told_as_that(height_m: float) -> None:
    scene = paris(120)
    columns = right_rows(scene, TIMES)
    found = explained(scene, TIMES, columns | {"z": columns["z"] + height_m})
    assert [convention.id for convention in found.conventions] == ["z_offset"]
    assert found.conventions[0].size_m == pytest.approx(height_m) and found.causes == ()


def test_another_length_of_the_cord_is_no_other_height() -> None:
    """On a small swing both move z by the same in every row."""
    scene = paris(120)
    longer = scene.with_values(["pendulum.length=67.001"])
    found = explained(scene, TIMES, right_rows(longer, TIMES))
    assert [part.id for part in (*found.conventions, *found.causes)] == ["pendulum.length"]


@pytest.mark.parametrize("step_s", [0.001, pytest.param(0.0005, marks=LONG)])
def test_velocities_that_are_updated_in_turn_are_no_closed_formula(step_s: float) -> None:
    """As beginners write it: the second velocity with the first one's new value, which no named method does."""
    scene = paris(600, "site.gravity_is=effective")
    length, gravity = 67.0, 9.80665
    turn = 2 * 7.292115e-5 * math.sin(math.radians(48.846111))
    x, y, vx, vy = 0.3, 0.4, 0.0, 0.0
    every = round(1 / step_s)
    rows = []
    for step in range(300 * every + 1):
        if step % every == 0:
            rows.append((x, y))
        vx += step_s * (-gravity / length * x + turn * vy)
        vy += step_s * (-gravity / length * y - turn * vx)
        x += step_s * vx
        y += step_s * vy
    times = np.arange(301.0)
    found = explained(scene, times, dict(zip("xy", np.array(rows).T, strict=True)))
    assert found.slip == ""
    assert {cause.id for cause in found.known} == {
        "linear_g",
        "no_centrifugal",
        "integrator_in_turn",
    }
