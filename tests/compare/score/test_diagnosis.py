"""Diagnosis: a C program with chosen mistakes is run as a user would run it, over a whole day."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from places import PENDULUM_C
from small_scenes import make_scene
from typer.testing import CliRunner

from compare.candidates.candidate import Candidate
from compare.score.diagnosis import diagnose
from compare.score.errors import TrajectoryErrors
from compare.score.judge import Score, judge
from foucault import commands
from reference import Scene, trajectory
from reference.dataset.dense import Dense
from reference.engines.variants import Variants
from reference.precision import LONG_DOUBLE
from reference.solver.sensitivity import sensitivity, with_value

SOURCE = PENDULUM_C
COMPILER = shutil.which("cc")
WORDS = "{x0} {y0} {length} {latitude} {gravity} {rotation_rate} {equatorial_radius} {inverse_flattening} {t_end}"


@pytest.fixture(scope="module", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FOUCAULT_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if COMPILER is None:
        pytest.skip("no C compiler")
    made = tmp_path_factory.mktemp("programs") / "pendulum"
    subprocess.run([str(COMPILER), "-O2", "-o", str(made), str(SOURCE), "-lm"], check=True)
    return made


def scored(program: Path, fault: str, *options: str) -> tuple[int, dict[str, Any]]:
    command = f"{program} {fault} {WORDS} 0.01 6000"
    result = CliRunner().invoke(commands(), ["score", "paris", "--run", command, "--repeats", "0", "--json", *options])
    return result.exit_code, json.loads(result.stdout)


def test_the_full_equations_agree_and_need_no_diagnosis(program: Path) -> None:
    status, said = scored(program, "none")
    assert (status, said["verdict"], said["diagnosis"]) == (0, "agrees", None)
    assert 1e-9 < said["max_error_m"] < 1e-6  # 3e-8 m for RK4 at 0.01 s
    assert said["timing"]["cpu_s"] > 0


@pytest.mark.parametrize(
    ("fault", "found"),
    [
        ("solar_day", "solar_day"),
        ("sphere", "sphere"),
        ("mean_sphere", "mean_sphere"),
        ("swapped", "swapped"),
        ("coriolis_sign", "coriolis_sign"),
        ("coriolis_half", "coriolis_half"),
        ("vertical_only", "vertical_only"),
        ("no_centrifugal", "no_centrifugal"),
        ("linear", "linear_g"),
        ("radians", "radians"),
        ("geocentric", "geocentric"),
        ("inertial_rest", "inertial_rest"),
    ],
)
def test_a_named_mistake_is_recognised(program: Path, fault: str, found: str) -> None:
    status, said = scored(program, fault)
    assert (status, said["verdict"]) == (1, "disagrees")
    assert said["diagnosis"]["id"] == found
    assert said["diagnosis"]["explained"] > 0.99


@pytest.mark.parametrize(
    ("fault", "name", "shift"),
    [("gravity", "site.gravity", 2e-5), ("length", "pendulum.length", 1e-3), ("release", "release.x", 1e-3)],
)
def test_a_wrong_input_is_named_with_its_shift(program: Path, fault: str, name: str, shift: float) -> None:
    status, said = scored(program, fault)
    assert (status, said["diagnosis"]["id"]) == (1, name)
    assert said["diagnosis"]["shift"] == pytest.approx(shift, rel=1e-3)


def test_a_random_fault_gets_no_diagnosis(program: Path) -> None:
    status, said = scored(program, "random", "--tolerance", "1e-7")
    assert (status, said["verdict"], said["diagnosis"]) == (1, "disagrees", None)


def synthetic(scene: Scene, name: str, value: str, decimals: int = 17, rows: int = 400) -> Score:
    """Score a candidate that solves the scene with another input and prints `decimals` decimals."""
    read_as = scene.with_values(["inputs=binary64"])
    times = np.linspace(0.0, float(scene.run.t_end), rows)
    states = Variants().states(with_value(read_as.exact, name, Fraction(value)), times).round(decimals)
    columns = {word: np.ascontiguousarray(states[:, i]) for i, word in enumerate("xyz")}
    return judge(Candidate.of("made", times, columns), scene, inputs="binary64")


@pytest.mark.parametrize(
    ("name", "value", "decimals"),
    [
        ("site.gravity", "9.80667", 4),  # the first minutes show nothing but the rounding of the output
        ("site.latitude", "30", 17),
        ("pendulum.drag", "1e-6", 17),
        ("pendulum.length", "70", 17),
    ],
)
def test_an_input_is_found_whether_its_shift_is_small_or_large(
    paris: Scene, name: str, value: str, decimals: int
) -> None:
    made = synthetic(paris, name, value, decimals)
    assert made.diagnosis is not None
    assert made.diagnosis.id == name
    true = sensitivity(paris, [0.0]).values[name]
    assert made.diagnosis.shift == pytest.approx(float(Fraction(value) - true), rel=1e-3)


def test_named_mistakes_that_are_the_same_at_this_site_are_both_named() -> None:
    """On the equator the horizontal part of Ω is all of it."""
    scene = make_scene("equatorial", site={"latitude": "0"}, run={"t_end": "3600", "grid_step": "60", "digits": 22})
    times = np.linspace(0.0, 3600.0, 200)
    read_as = scene.with_values(["inputs=binary64"])
    states = Variants().states(read_as.exact, times, alter=lambda k: replace(k, turn=(0, 0, 0)))
    columns = {word: np.ascontiguousarray(states[:, i]) for i, word in enumerate("xyz")}
    truth = trajectory(read_as, times, number=LONG_DOUBLE)
    found = Dense(times, truth, np.zeros_like(truth), 1e-16, "long_double")
    candidate = Candidate.of("made", times, columns)
    errors = TrajectoryErrors(
        times, {w: columns[w] - truth[:, i] for i, w in enumerate("xyz")}, times, found, 1e-16, 0.5, 0.2
    )
    said = diagnose(candidate, errors, read_as)
    assert said is not None
    assert (said.id, said.also[0]) == ("vertical_only", "no_coriolis")
    assert "leaves out the Coriolis force" in said.text


def test_above_the_horizontal_no_approximation_of_small_swings_is_tried() -> None:
    """They are singular there, and would be integrated for ever."""
    scene = make_scene("wide", pendulum={"length": "1"}, release={"angle": "89.9", "azimuth": "30"})
    times = np.linspace(0.0, 60.0, 61)
    truth = trajectory(scene, times, number=LONG_DOUBLE)
    noise = 1e-3 * np.random.default_rng(0).standard_normal(truth.shape)
    found = Dense(times, truth, np.zeros_like(truth), 1e-16, "long_double")
    columns = {word: np.ascontiguousarray((truth + noise)[:, i]) for i, word in enumerate("xyz")}
    candidate = Candidate.of("made", times, columns)
    errors = TrajectoryErrors(times, {w: noise[:, i] for i, w in enumerate("xyz")}, times, found, 1e-16, 1.0, 4.0)
    assert diagnose(candidate, errors, scene) is None
