"""`foucault study --approximations` and `foucault score --approximation`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from compare.approximations import motions
from foucault import commands
from reference import InputError


def test_the_study_of_approximations_writes_its_page_and_json(tmp_path: Path) -> None:
    arguments = [
        "study",
        "hard",
        "--approximations",
        "--set",
        "release.angle=5",
        "--t-end",
        "60",
        "--json",
    ]
    result = CliRunner().invoke(commands(), [*arguments, "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    assert {row["t"] for row in document["rows"]} == {20.0, 60.0}
    assert {row["over"] for row in document["limits"]} == {
        "time",
        "amplitude",
        "latitude",
        "length",
    }
    assert {row["approximation"] for row in document["rows"]} == {*motions()}
    page = (tmp_path / "index.html").read_text()
    assert all(row["approximation"] in page for row in document["rows"])
    assert page.count("<svg") == 5  # errors over time, of the swing plane, and of the three sweeps


def test_a_folder_of_somebody_elses_is_refused_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text("mine")
    result = CliRunner().invoke(
        commands(), ["study", "paris", "--approximations", "--out", str(tmp_path), "--t-end", "60"]
    )
    assert isinstance(result.exception, InputError)
    assert (tmp_path / "rows.csv").read_text() == "mine"


def test_an_approximation_is_scored_like_a_program() -> None:
    arguments = ["score", "paris", "--approximation", "linear_3d", "--json", "--no-diagnosis"]
    result = CliRunner().invoke(commands(), [*arguments, "--set", "run.t_end=3600"])
    document = json.loads(result.stdout)
    assert (result.exit_code, document["verdict"]) == (1, "disagrees")
    assert document["max_error_m"] == pytest.approx(4.06e-3, rel=0.05)


def test_an_approximation_of_a_number_cannot_be_scored_as_a_motion() -> None:
    result = CliRunner().invoke(commands(), ["score", "paris", "--approximation", "rest_triangle"])
    assert isinstance(result.exception, InputError)
