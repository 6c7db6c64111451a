"""A program of the user's on difficult scenes: right where it is right, and told where, when and how it breaks."""

from __future__ import annotations

import json
import shlex
import sys

import numpy as np
import pytest

from compare.studies.stability import cut
from compare.studies.users_program import ProgramRun, measured
from compare.truth import golden_of
from reference import load_scene, trajectory
from reference.status import Status

PROGRAM = """
import sys
rows = [map(float, line.split()) for line in open(sys.argv[1])]
end, what = float(sys.argv[2]), sys.argv[3]
print("t,x,y")
for t, x, y in rows:
    if t > end:
        break
    if what == "stops" and t > 4:
        break
    if what == "drifts" and t > 5:
        x += 0.2
    if what == "blows" and t > 5:
        x = float("nan")
    print(t, x, y, sep=",")
if what == "fails":
    sys.exit("no more")
if what == "dies":
    import os
    os.kill(os.getpid(), 11)
if what == "hangs":
    import signal
    signal.pause()
"""


@pytest.fixture(scope="module")
def scene():
    return cut(load_scene("hard", ["run.t_end=10", "run.grid_step=1"]))


@pytest.fixture(scope="module")
def command(tmp_path_factory, scene):
    folder = tmp_path_factory.mktemp("program")
    (folder / "p.py").write_text(PROGRAM)
    times = np.linspace(0, 10, 41)  # other times than those of the grid
    np.savetxt(
        folder / "rows.txt", np.column_stack([times, trajectory(scene, times)[:, :2]]), fmt="%.17g"
    )
    return (
        " ".join(map(shlex.quote, [sys.executable, str(folder / "p.py"), str(folder / "rows.txt")]))
        + " {t_end} "
    )


@pytest.fixture(scope="module")
def golden(scene):
    return golden_of(scene, 34)


@pytest.mark.parametrize(
    ("what", "status", "said"),
    [
        ("works", Status.OK, ""),
        ("stops", Status.GAVE_UP, "its output ends at t = 4 s of 10 s"),
        # whether that is too much is judged against what it was asked for
        ("drifts", Status.OK, ""),
        ("blows", Status.NOT_FINITE, "nan in row 22"),
        ("fails", Status.GAVE_UP, "exit status 1"),
        ("dies", Status.CRASHED, "exit status -11"),
        ("hangs", Status.OUT_OF_TIME, "did not end within 3 s (3 times --limit)"),
    ],
)
def test_each_way_to_break_has_its_word(scene, golden, command, what, status, said):
    limit_s = 1.0 if what == "hangs" else 20.0
    program = ProgramRun("mine", command + what, step_s=0.01, limit_s=limit_s)
    row, wrong_from_s = measured(program, scene, golden, 0.1)
    assert row.status == status
    assert said in row.reason
    assert not row.reason.startswith("-")  # as a table's cell: a spreadsheet takes it for a formula
    assert wrong_from_s == (5.25 if what == "drifts" else None)
    if what == "works":
        assert row.error_m < 1e-9


SHORT = """id = "short"
[pendulum]
length = "1"
[release]
angle = "80"
azimuth = "10"
[run]
t_end = "10"
grid_step = "1"
"""


@pytest.mark.usefixtures("here")
def test_the_study_says_from_when_on_a_program_is_wrong_and_its_page_stays_whole(
    foucault, command, tmp_path
):
    pytest.importorskip("scipy")
    pytest.importorskip("matplotlib")
    path = tmp_path / "short.toml"
    path.write_text(SHORT)
    times = np.linspace(0, 10, 41)
    states = trajectory(cut(load_scene(path)), times)
    np.savetxt(tmp_path / "rows.txt", np.column_stack([times, states[:, :2]]), fmt="%.17g")
    words = command.replace(shlex.split(command)[2], str(tmp_path / "rows.txt"))
    out = tmp_path / "out"
    programs = {"right": f"{words} works", "<drifting>": f"{words} drifts {'x' * 3000}"}
    options = [word for name, run in programs.items() for word in ("--run", run, "--name", name)]
    status, text, _ = foucault(
        "stability", "--scenes", path, "--methods", "scipy_dop853", *options, "--out", out
    )
    assert status == 0
    words = " ".join(text.split())
    assert f"<drifting> breaks on 1 of 1 scenes: {path} (wrong from t = 5.25 s on)." in words
    assert "right breaks on 0 of 1 scenes." in text
    document = json.loads((out / "stability.json").read_text())
    assert document["programs"] == programs
    cells = {row["method"]: row for row in document["rows"]}
    assert (cells["right"]["status"], cells["right"]["wrong_from_s"]) == ("ok", None)
    assert cells["right"]["digits"] > 9
    of_scene = [line.split() for line in text.splitlines() if line.startswith("short.toml ")]
    (kept,) = [words[-2:] for words in of_scene if words[-1] == "ok"]
    assert kept == [f"{cells['right']['digits']:.1f}", "ok"]
    drifting = cells["<drifting>"]
    assert (drifting["status"], drifting["wrong_from_s"], drifting["asked"]) == (
        "silently_wrong",
        5.25,
        6.0,
    )
    assert drifting["reason"].startswith("From t = 5.25 s on it is wrong.")
    page = (out / "index.html").read_text()
    assert "1000 times what was asked for, which is 3 digits fewer" in page
    assert "x" * 500 not in page and "&lt;drifting&gt;" in page and "<drifting>" not in page
