"""A C program with mistakes to order, run as a user would run it, over a whole day."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from foucault import app

SOURCE = Path(__file__).parent / "programs" / "pendulum.c"
COMPILER = shutil.which("cc")
WORDS = "{x0} {y0} {length} {latitude} {gravity} {rotation_rate} {equatorial_radius} {inverse_flattening} {t_end}"

pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler")


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("programs") / "pendulum"
    subprocess.run([str(COMPILER), "-O2", "-o", str(made), str(SOURCE), "-lm"], check=True)
    return made


def scored(program: Path, fault: str, *options: str) -> tuple[int, dict[str, Any]]:
    command = f"{program} {fault} {WORDS} 0.01 6000"
    result = CliRunner().invoke(app, ["score", "paris", "--run", command, "--repeats", "0", "--json", *options])
    return result.exit_code, json.loads(result.stdout)


def test_the_full_equations_agree_and_need_no_diagnosis(program: Path) -> None:
    status, said = scored(program, "none")
    assert (status, said["verdict"], said["diagnosis"]) == (0, "agrees", None)
    assert 1e-9 < said["max_error_m"] < 1e-6  # facts/peers.md: 3e-8 m for RK4 at 0.01 s
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
