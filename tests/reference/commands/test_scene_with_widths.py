"""A scene whose inputs are uncertain: show, generate and score take its widths, unless `--uncertain` says otherwise."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from foucault import commands
from reference.dataset.ranges import load_ranges

HALL = """
[pendulum]
length = "12.3"
[site]
gravity_is = "effective"
[release]
x = "0.5"
y = "0.3"
[run]
t_end = "20"
grid_step = "10"
[uncertain]
"pendulum.length" = "0.001"
"""


def invoke(*words: str):
    return CliRunner().invoke(commands(), words, catch_exceptions=False)


@pytest.fixture
def hall(tmp_path: Path) -> Path:
    path = tmp_path / "hall.toml"
    path.write_text(HALL)
    return path


@pytest.mark.parametrize(
    ("options", "widths"),
    [
        ([], {"pendulum.length": "0.001"}),
        (["--uncertain", "length=±0.002"], {"pendulum.length": "0.002"}),
        (["--uncertain", "gravity=±0.01"], {"pendulum.length": "0.001", "site.gravity": "0.01"}),
    ],
)
def test_generate_writes_ranges_for_the_widths_of_the_scene_and_of_the_option(
    hall, tmp_path, options, widths
):
    result = invoke("generate", str(hall), "--out", str(tmp_path / "out"), *options)
    assert result.exit_code == 0, result.stderr
    assert load_ranges(tmp_path / "out").uncertain == widths


def test_without_its_widths_the_scene_has_a_dataset(hall, tmp_path):
    out = tmp_path / "out"
    result = invoke(
        "generate", str(hall), "--uncertain", "none", "--level", "computed", "--out", str(out)
    )
    assert result.exit_code == 0 and (out / "manifest.json").is_file()


def test_show_and_score_take_the_widths_of_the_scene(hall, tmp_path):
    shown = json.loads(invoke("show", str(hall), "--json").stdout)
    assert shown["ranges"]["uncertain"] == {"pendulum.length": "±0.001"}
    assert "ranges" not in json.loads(
        invoke("show", str(hall), "--uncertain", "none", "--json").stdout
    )
    rows = tmp_path / "rows.csv"
    rows.write_text("t,x,y\n0,0.5,0.3\n")
    assert "cannot be told apart" in invoke("score", str(hall), str(rows)).stdout
