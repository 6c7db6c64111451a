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


@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
def test_the_centrifugal_force_is_told_beside_a_step_error(rtol: float) -> None:
    """Its horizontal part moves the bob's rest position, which no drift does."""
    found = explained(rtol, {"no_centrifugal"}, gravity="none")
    words = found.words | found.alternatives
    assert words & {"no_centrifugal", "effective_gravity"}
    assert "integrator_loose" in words
    assert not words & LIKE_A_STEP


def test_a_coriolis_force_of_the_wrong_sign_is_told_beside_a_step_error() -> None:
    found = explained(1e-6, {"coriolis_sign"}, coriolis=-1.0)
    assert found.words | found.alternatives >= {"coriolis_sign", "integrator_loose"}
    assert not found.words - {"coriolis_sign", "integrator_loose"}


def test_a_loose_tolerance_alone_is_a_step_error_and_nothing_else() -> None:
    found = explained(1e-5, set())
    assert found.words == {"integrator_loose"}
