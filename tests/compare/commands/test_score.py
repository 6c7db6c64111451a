"""`foucault score`: where the comparison ends (--t-end), fields by short names, and one JSON document on stdout."""

from __future__ import annotations

import json
import shlex
import subprocess
import sys

import numpy as np
import pytest
from sampled import one_in

from compare.candidates.external import placeholders
from reference import load, load_scene
from reference.scenes.scene import field_names, full_name


@pytest.fixture
def late(tmp_path):
    """Write a candidate that is right for ten minutes and wrong afterwards, and the times of its transits."""
    golden = load("paris.binary64")
    rows = np.column_stack([golden.t, golden.x, golden.y])[:31]
    rows[11:, 1] += 1e-3
    (tmp_path / "mine.csv").write_text(
        "t,x,y\n" + "".join(f"{t!r},{x!r},{y!r}\n" for t, x, y in rows.tolist())
    )
    times = golden.transits["t"][:200].tolist()
    (tmp_path / "zeros.csv").write_text("t\n" + "".join(f"{t!r}\n" for t in times))
    return tmp_path, times


def test_later_rows_and_transits_are_ignored_and_a_note_says_how_many(foucault, late):
    folder, times = late
    words = (
        "score",
        "paris",
        folder / "mine.csv",
        "--transits",
        folder / "zeros.csv",
        "--no-diagnosis",
    )
    assert foucault(*words)[0] == 1
    status, out, _ = foucault(*words, "--t-end", "600")
    assert status == 0
    assert "11 rows, t = 0 to 600 of 600 s" in out
    assert "Note: 20 rows after t = 600 s ignored, the last at 1800 s." in out
    inside = sum(t <= 600 for t in times)
    document = json.loads(foucault(*words, "--t-end", "600", "--json")[1])
    assert document["transits"]["matched"] == inside == 73
    assert document["transits"]["extra"] == 0


def test_nothing_is_said_if_no_row_is_later(foucault, late):
    folder, _ = late
    out = foucault("score", "paris", folder / "mine.csv", "--t-end", "1800", "--no-diagnosis")[1]
    assert "31 rows" in out and "ignored" not in out


def test_an_end_before_the_first_row_is_refused(foucault, tmp_path):
    (tmp_path / "mine.csv").write_text("t,x,y\n120,0.1,0.1\n")
    status, out, err = foucault("score", "paris", tmp_path / "mine.csv", "--t-end", "60")
    assert (status, out) == (2, "")
    assert "t_end: got '60', expected at least 120 s" in err


def test_an_approximation_is_compared_up_to_there(foucault):
    status, out, _ = foucault(
        "score", "paris", "--approximation", "linear_3d", "--t-end", "120", "--no-diagnosis"
    )
    assert status == 1
    assert "3 rows, t = 0 to 120 of 120 s" in out


FALLS = """
for k in range(601):
    t = k / 30
    print(t, 0.3 - {0} * t**2, 0.4 + {0} * t**{1}, sep=",")
"""


@pytest.mark.parametrize(
    ("pull", "power"), one_in(3, [("1e95", "1"), ("168.0", "2"), ("1e-9", "60")])
)
def test_stdout_of_a_program_that_diverges_is_one_json_document(foucault, tmp_path, pull, power):
    """In a process of its own, whose stdout LAPACK would write to."""
    (tmp_path / "falls.py").write_text("print('t,x,y')" + FALLS.format(pull, power))
    run = [
        "--run",
        f"{shlex.quote(sys.executable)} falls.py",
        "--repeats",
        "0",
        "--set",
        "t_end=20",
        "--json",
    ]
    command = [sys.executable, "-m", "foucault", "score", "paris", *run]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    document = json.loads(done.stdout)
    assert document["verdict"] == "disagrees" and document["causes"] == []
    (tmp_path / "nan.csv").write_text("t,x,y\n0,0.3,0.4\n1,inf,nan\n")
    status, out, err = foucault("score", "paris", tmp_path / "nan.csv", "--json")
    assert (status, out) == (2, "") and "nan.csv: x: got inf in row 2" in err


def test_fields_have_the_short_names_of_run_and_one_without_effect_is_a_note(foucault):
    words = ("score", "paris", "--approximation", "linear_3d", "--no-diagnosis", "--json")
    long = foucault(
        *words, "--set", "run.t_end=120", "--set", "release.x=0.2", "--set", "site.latitude=12"
    )
    short = foucault(*words, "--set", "t_end=120", "--set", "x0=0.2", "--set", "latitude=12")
    assert short[:2] == long[:2] and short[0] == 1
    ignored = foucault(
        *words,
        "--set",
        "t_end=120",
        "--set",
        "x0=0.2",
        "--set",
        "latitude=12",
        "--set",
        "level=enclosed",
    )
    assert ignored[:2] == long[:2]
    assert ignored[2] == "--set level=enclosed has no effect here. " + (
        "A candidate is compared with a confirmed solution, or a dataset that ships.\n"
    )
    assert load_scene("paris", ["x0=0.2", "length=60"]) == load_scene(
        "paris", ["release.x=0.2", "pendulum.length=60"]
    )
    # these two follow
    fields = {full_name(word) for word in placeholders(load_scene("paris"))} - {"z0", "vz0"}
    assert fields <= set(field_names())
