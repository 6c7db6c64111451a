"""What people read of a score: the numbers of its JSON document, in order, and nothing that it has not."""

from __future__ import annotations

import json
import re
import shlex

import numpy as np
import pytest
from small_scenes import make_scene

from compare import APPROXIMATIONS, judge
from compare.score.document import document
from compare.score.verdict import percent
from reference import load, load_scene, trajectory

HEADER = "t (min),x,y,z,vx,vy,vz"


@pytest.fixture(scope="module")
def golden():
    return load("paris.binary64")


@pytest.fixture(scope="module")
def told(tmp_path_factory, golden):
    """The lines and the document of a program whose g is wrong, whose transits too, and which goes on after the end."""
    from typer.testing import CliRunner

    from foucault import commands

    folder = tmp_path_factory.mktemp("told")
    times = np.arange(0.0, 3901.0, 60.0)
    rows = trajectory(load_scene("paris", ["site.gravity=9.8068", "inputs=binary64"]), times)
    table = np.column_stack([times / 60, rows])
    np.savetxt(folder / "rows.csv", table, delimiter=",", header=HEADER, comments="", fmt="%.17g")
    right = golden.transits["t"][:430]
    zeros = np.sort([*np.delete(right, [10, 20, 30, 40]), 100.0, 200.0])
    np.savetxt(folder / "zeros.csv", zeros, header="t", comments="", fmt="%.17g")
    words = [
        "score",
        "paris",
        "--run",
        f"cat {shlex.quote(str(folder / 'rows.csv'))}",
        "--repeats",
        "1",
    ]
    words += ["--transits", str(folder / "zeros.csv"), "--t-end", "3600", "--tolerance", "1e-5"]
    text, data = (CliRunner().invoke(commands(), [*words, *more]) for more in ([], ["--json"]))
    assert (text.exit_code, data.exit_code) == (1, 1)
    return text.stdout.splitlines(), json.loads(data.stdout)


def line_of(lines, label):
    (found,) = [line.strip() for line in lines if line.strip().startswith(label)]
    return found.removeprefix(label)


def numbers(text):
    return [float(word) for word in re.findall(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?", text)]


def test_the_verdict_comes_first_then_the_reasons_then_the_errors(told):
    lines, _ = told
    order = [
        "the program disagrees with paris", "It seems that your program",
        "largest error", "rms, at the end", "digits", "worst ", "worst of each",
        "swing plane, phase", "drifts", "transits", "missed at", "extra at", "took", "inputs read as", "reference",
        "Reading: ", "Note: ",
    ]  # fmt: skip
    places = [
        next(i for i, line in enumerate(lines) if line.strip().startswith(word)) for word in order
    ]
    assert places == sorted(places) and places[0] == 0


@pytest.mark.parametrize(
    ("label", "keys"),
    [
        ("largest error", ["max_error_m", "tolerance_m", "error_over_floor", "input_floor_m"]),
        ("rms, at the end", ["rms_error_m", "end_error_m"]),
        ("digits", ["digits", "scale_m"]),
        ("scd, mescd at end", ["scd", "mescd"]),
        ("swing plane, phase", ["swing_plane_error_deg", "phase_error_s"]),
    ],
)
def test_the_lines_have_the_numbers_of_the_document(told, label, keys):
    lines, data = told
    # one decimal, of which digits are told
    rounding = 0.06 if keys[0] in ("digits", "scd") else 0.0
    said = numbers(line_of(lines, label))[: len(keys)]
    assert said == pytest.approx([data[key] for key in keys], rel=0.05, abs=rounding)


def test_the_lines_name_the_worst_number_as_the_document_does(told):
    lines, data = told
    worst = data["worst"]
    said = line_of(lines, "worst  ")
    assert said.strip().startswith(f"{worst['component']} at t = ")
    assert numbers(said) == [worst["t"], worst["expected"], worst["got"]]
    assert worst["got"] - worst["expected"] == pytest.approx(worst["difference"], rel=1e-9)
    each = line_of(lines, "worst of each").split(", ")
    assert (
        [word.split()[0] for word in each]
        == list(data["worst_of_each"])
        == ["x", "y", "z", "vx", "vy", "vz"]
    )
    assert [word.split()[-1] for word in each] == ["m"] * 3 + ["m/s"] * 3


def test_the_lines_count_transits_as_the_document_does_and_name_three(told):
    lines, data = told
    transits = data["transits"]
    counts = [transits["matched"], transits["missed"], transits["extra"]]
    assert numbers(line_of(lines, "transits"))[:3] == counts == [426, 12, 2]
    missed, extra = line_of(lines, "missed at"), line_of(lines, "extra at")
    assert numbers(missed) == pytest.approx(transits["missed_at"][:3], abs=1e-6) and "…" in missed
    assert numbers(extra) == pytest.approx(transits["extra_at"], abs=1e-6) and "…" not in extra


def test_the_lines_and_the_document_tell_the_cause_the_reading_and_the_note(told):
    lines, data = told
    (cause,) = data["causes"]
    assert cause["id"] == "site.gravity" and cause["value"] == pytest.approx(9.8068, rel=1e-9)
    assert cause["text"].removeprefix("your program ") in "\n".join(lines)
    left = line_of(lines, "With this corrected, the error is below")
    assert data["corrected"]["max_error_m"] < numbers(left)[0] < 1e-6 < data["max_error_m"]
    assert [f"Reading: {one['text']}." for one in data["conventions"]] == [
        x for x in lines if x.startswith("Reading")
    ]
    assert [f"Note: {note}." for note in data["notes"]] == [
        x for x in lines if x.startswith("Note")
    ]
    assert "5 rows after t = 3600 s ignored" in data["notes"][0]
    assert (data["rows"], data["covered_s"]) == (61, [0.0, 3600.0])
    assert (data["timing"]["runs"], "median of 1 after a warm-up" in line_of(lines, "took")) == (
        1,
        True,
    )


def test_what_a_score_has_not_is_not_said(golden):
    row = {"t": golden.t[1:2], "x": golden.x[1:2], "y": golden.y[1:2]}
    right = judge(row, "paris")
    lines, data = str(right).splitlines(), document(right)
    absent = ("transits", "took", "swing plane", "drifts", "No mistake", "Reading", "Note")
    assert not [line for line in lines if line.strip().startswith(absent)]
    assert "grows like" not in line_of(lines, "rms, at the end")
    unknown = (
        "growth_exponent", "swing_plane_error_deg", "phase_error_s", "h_drift_m2_s2", "length_drift_m", "transits",
        "model", "corrected", "slip", "diagnosis", "baseline",
    )  # fmt: skip
    assert [data[key] for key in unknown] == [None] * len(unknown)
    assert (data["causes"], data["conventions"], "timing" in data) == ([], [], False)


def test_what_rounding_makes_of_a_right_file_is_not_said(golden):
    """Golden rows drift by the rounding of doubles alone, and two numbers that print alike show no error."""
    rows = {name: golden[name][:11] for name in ("t", "x", "y", "z", "vx", "vy", "vz")}
    lines = str(judge(rows, "paris")).splitlines()
    assert not [line for line in lines if line.strip().startswith("drifts")]
    assert "expected" not in line_of(lines, "worst    ")

    stretched = rows | {"z": rows["z"] - 1e-9}
    assert "|r| - l by 1e-09 m" in line_of(str(judge(stretched, "paris")).splitlines(), "drifts")


def test_inputs_that_are_doubles_have_no_floor_to_compare_with(tmp_path, monkeypatch):
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path))
    site = {"latitude": "45", "gravity": "9.75", "rotation_rate": "0", "inverse_flattening": "inf"}
    scene = make_scene(
        "exact", site=site, release={"x": "0.25", "y": "0.5"}, run={"t_end": "5", "grid_step": "5"}
    )
    third = np.ones(1, np.longdouble) / 3  # so that it is judged by a dataset
    score = judge({"t": [5.0], "x": third, "y": third}, scene, explain=False)
    assert document(score)["error_over_floor"] is None
    assert "the inputs are exact doubles" in line_of(str(score).splitlines(), "largest error")


def test_a_model_is_said_with_how_exact_it_is_and_what_it_costs():
    scene = load_scene("paris", ["run.t_end=600"])
    t = np.linspace(0, 600, 61)
    x, y, *_ = APPROXIMATIONS["linear_recentred"].trajectory(scene, t).T
    score = judge({"t": t, "x": x, "y": y}, scene)
    model = document(score)["model"]
    said = numbers(line_of(str(score).splitlines(), "As that model"))
    assert said == pytest.approx([model["exact_to_m"], model["costs_m"]], rel=0.05)
    assert model["id"] == "linear_recentred" and model["exact_to_m"] < 1e-9
    assert model["costs_m"] == pytest.approx(score.errors.max_m, rel=1e-6)


@pytest.mark.parametrize(
    ("share", "said"),
    [
        (0.0, "0 %"),
        (0.29, "29 %"),
        (1.0, "100 %"),
        (1 - 1.5e-9, "99.9 %"),
        (1 - 0.5e-9, "100 %"),
        (0.012345, "1.23 %"),
    ],
)
def test_a_share_is_rounded_down_to_three_digits_but_for_rounding_errors(share, said):
    assert percent(share) == said
