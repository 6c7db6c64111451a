"""Typed mistakes beside a solver at a loose tolerance: what no drift of phase and amplitude changes is certain."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from adaptive import Loose
from mistakes import Told, told

from reference import load_scene

LIKE_A_STEP = {"site.gravity", "pendulum.length", "pendulum.drag", "clock"}


def explained(rtol: float, true: set[str], **fields: Any) -> Told:
    """Return what is told of 300 rows, ten a swing, of a program that SciPy's RK45 steps."""
    settings = ["pendulum.length=20", "site.gravity=9.81", "release.x=0.2", "release.y=0.1"]
    scene = load_scene(
        "paris", [*settings, "run.t_end=300", "run.transits=false", "inputs=binary64"]
    )
    latitude = float(scene.exact.latitude)
    times = 0.9 * np.arange(300.0)
    made = Loose(
        scene, times, 20.0, 9.81, latitude, 7.292115e-5, (0.2, 0.1), "RK45", rtol, true=true
    )
    vars(made).update(fields)
    return told(scene, times, made.rows(), 2e-7)


def test_the_centrifugal_force_is_told_beside_a_step_error() -> None:
    """Its horizontal part moves the bob's rest position, which no drift does."""
    found = explained(1e-6, {"no_centrifugal"}, gravity="none")
    words = found.words | found.alternatives
    assert words & {"no_centrifugal", "effective_gravity"}
    assert "integrator_loose" in words
    assert not words & LIKE_A_STEP


def test_beside_a_coarse_step_error_the_vertical_centrifugal_force_is_not_seen() -> None:
    """A phase that drifts is that of another g, too."""
    found = explained(1e-4, {"no_centrifugal"}, gravity="none")
    assert found.words == {"effective_gravity", "integrator_loose"} and not found.alternatives
    text = {cause.id: cause.text for cause in found.explanation.causes}["effective_gravity"]
    assert text.endswith("or leaves out its horizontal part alone")


@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
def test_of_a_program_that_has_the_vertical_force_no_more_is_certain_than_that(rtol) -> None:
    found = explained(rtol, {"no_tilt"}, suspension=(0.0, 1.0))
    assert found.words <= {"no_centrifugal", "effective_gravity", "no_tilt", "integrator_loose"}
    for cause in found.explanation.known:
        alone = cause.id in ("no_tilt", "integrator_loose")
        assert alone or cause.text.endswith("or leaves out its horizontal part alone")


def test_a_coriolis_force_of_the_wrong_sign_is_told_beside_a_step_error() -> None:
    found = explained(1e-6, {"coriolis_sign"}, coriolis=-1.0)
    assert found.words | found.alternatives >= {"coriolis_sign", "integrator_loose"}
    assert not found.words - {"coriolis_sign", "integrator_loose"}


def test_beside_a_step_error_a_plane_turned_by_hand_is_no_rival_of_a_sign_for_certain() -> None:
    """In the linear model both are the same motion but for Ω², which the error of the steps hides.

    The coarser it is, the more other causes are about as good.
    """
    linear = {"model": "linear", "gravity": "none"}
    for rtol in (1e-5, 1e-6, 1e-7):
        found = explained(rtol, {"coriolis_sign"}, coriolis=-1.0, **linear)
        assert found.words <= {"integrator_loose", "linear_g", "effective_gravity"}
        assert not found.alternatives or "coriolis_sign" in found.alternatives


def test_a_loose_tolerance_alone_is_a_step_error_and_nothing_else() -> None:
    found = explained(1e-5, set())
    assert found.words == {"integrator_loose"}


EXACT = 1e-12  # relative tolerance of RK45 at which no step error is left
RATE = 7.292115e-5
LINEAR = {"model": "linear", "gravity": "none"}
OTHER_WAY = [{"coriolis_sign", "hemisphere"}]


@pytest.mark.parametrize(
    ("fields", "certain", "either"),
    [
        (LINEAR | {"rate": -1.01 * RATE}, {"site.rotation_rate"}, OTHER_WAY),
        (LINEAR | {"rate": 1.01 * RATE, "coriolis": -1.0}, {"site.rotation_rate"}, OTHER_WAY),
        (LINEAR | {"latitude": -48.5}, {"site.latitude"}, OTHER_WAY),
        ({"latitude": -48.5}, {"site.latitude"}, []),
    ],
)
def test_a_plane_that_turns_the_other_way_with_another_number(
    fields: dict[str, Any], certain: set[str], either: list[set[str]]
) -> None:
    """In a plane Ω sin φ alone counts, so that its sign may be that of Ω or of φ; the sphere shows which."""
    explanation = explained(EXACT, set(), **fields).explanation
    ids = {cause.id for cause in explanation.causes} - {"linear_g", "no_centrifugal"}
    assert {word for word in ids if "|" not in word} == certain
    assert [set(word.split("|")) for word in ids if "|" in word] == either
