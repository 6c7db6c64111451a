"""How hard a scene is, and the reason of a failure: the strongest cause that the numbers point to, in a sentence."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from compare.studies.character import Character, character, reason_of
from compare.studies.row import Row
from reference import load_scene, trajectory
from reference.status import Status

CALM = Character(0.4, 0.0, 1.0, 2.0, 9.0, 0.001, 0.01, 600.0)
ROW = Row("rk4", "space", 0.1, "step", "binary64", Status.OK, steps=6000, h_drift=1e-7, cpu_s=12.0)


@pytest.mark.parametrize(
    ("status", "row", "traits", "words"),
    [
        (
            Status.OUT_OF_TIME,
            ROW,
            replace(CALM, damping=4000.0, ratio=1e6),
            ["about 12 s", "stiff: rates up to 4e+03/s"],
        ),
        (
            Status.GAVE_UP,
            replace(ROW, reason="Step too small."),
            replace(CALM, least_tension=-9.8),
            ["the rod is pushed", "It reported: Step too small"],
        ),
        (
            Status.SILENTLY_WRONG,
            ROW,
            CALM,
            [
                "success was reported with 1.0 digits",
                "local errors of 6000 steps add up",
                "h drifts",
            ],
        ),
        (
            Status.SILENTLY_WRONG,
            ROW,
            replace(CALM, magnified=1e8),
            ["amplifies an error at the release 1e+08 times"],
        ),
        (
            Status.SILENTLY_WRONG,
            ROW,
            replace(CALM, amplitude=1e-11),
            ["cancellation against z ≈ −l costs 11 digits"],
        ),
        (
            Status.SILENTLY_WRONG,
            replace(ROW, formulation="angles"),
            replace(CALM, nearest=1e-9),
            ["passes the vertical within 1e-09"],
        ),
        (
            Status.SILENTLY_WRONG,
            replace(ROW, formulation="plane"),
            replace(CALM, amplitude=1.0),
            ["height of the suspension"],
        ),
        (
            Status.NOT_FINITE,
            replace(ROW, reason=""),
            CALM,
            ["no measured property of the scene explains it"],
        ),
        (
            # nobody knows what a program of --run integrates
            Status.GAVE_UP,
            replace(ROW, formulation="program", reason="It diverges."),
            replace(CALM, least_tension=-4.1),
            ["if it integrates x, y, z and their rates: the rod is pushed", "It reported: It dive"],
        ),
        (
            Status.SILENTLY_WRONG,
            replace(ROW, formulation="program"),
            replace(CALM, amplitude=1.0),
            ["local errors of 6000 steps add up", "if it integrates x and y alone: the path reach"],
        ),
        (Status.REFUSED, replace(ROW, reason="not below"), CALM, ["not below"]),
    ],
)
def test_each_cause_is_named(status: Status, row: Row, traits: Character, words: list[str]) -> None:
    reason = reason_of(row, status, traits, 1.0, 9.0, 3.0)
    for word in words:
        assert word.lower() in reason.lower()


def test_what_is_right_needs_no_reason() -> None:
    assert reason_of(ROW, Status.OK, CALM, 9.0, 9.0, 3.0) == ""


def character_of(scene_id: str, *changes: str):  # type: ignore[no-untyped-def]
    scene = load_scene(scene_id, changes)
    times = np.linspace(0, float(scene.exact.t_end), 200)
    return character(scene, times, trajectory(scene, times))


def test_the_rates_of_a_small_swing_are_those_of_the_linear_pendulum() -> None:
    traits = character_of(
        "paris", "run.t_end=600", "site.rotation_rate=0", "release.x=1e-4", "release.y=0"
    )
    assert traits.fastest == pytest.approx(math.sqrt(9.80665 / 67), rel=1e-5)
    assert traits.ratio == pytest.approx(1, abs=1e-3)
    assert traits.magnified == pytest.approx(1, rel=0.01)
    assert not traits.stiff


def test_the_rates_of_a_creeping_bob_are_its_drag_and_gravity_over_drag() -> None:
    traits = character_of("creeping", "run.t_end=1", "run.grid_step=0.01")
    assert traits.damping == pytest.approx(4000, rel=1e-3)
    assert traits.ratio > 1e6
    assert traits.stiff


def test_near_the_top_the_flow_magnifies_and_the_rod_is_pushed() -> None:
    traits = character_of("near_inverted", "run.t_end=5", "run.grid_step=0.1")
    assert traits.least_tension < 0
    assert traits.magnified > 100  # exp(t sqrt(g/l)) while it lingers there


def test_on_the_separatrix_all_that_a_double_holds_is_not_all_that_is_magnified() -> None:
    """An error grows like exp(3 t) to t = 20 s: by 26 digits, more than a trajectory in double can show."""
    traits = character_of("separatrix")
    assert traits.digits_lost == pytest.approx(60 / math.log(10), abs=1)
