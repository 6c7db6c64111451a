"""A program of the user's on difficult scenes: right where it is right, and told where, when and how it breaks."""

from __future__ import annotations

import shlex
import sys

import numpy as np
import pytest

from compare.studies.program import measured
from compare.studies.stability import cut, stability
from compare.truth import golden_of
from reference import load_scene, trajectory
from reference.status import Status

PROGRAM = """
import sys
import numpy as np
rows = np.load(sys.argv[1])
end, what = float(sys.argv[2]), sys.argv[3]
print("t,x,y")
for t, x, y in rows[rows[:, 0] <= end]:
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
    np.save(folder / "rows.npy", np.column_stack([times, trajectory(scene, times)[:, :2]]))
    return " ".join(map(shlex.quote, [sys.executable, str(folder / "p.py"), str(folder / "rows.npy")])) + " {t_end} "


@pytest.mark.parametrize(
    ("what", "status", "said"),
    [
        ("works", Status.OK, ""),
        ("stops", Status.GAVE_UP, "its output ends at t = 4 s of 10 s"),
        ("drifts", Status.OK, ""),  # whether that is too much is judged against what it was asked for
        ("blows", Status.NOT_FINITE, "nan in row 22"),
        ("fails", Status.GAVE_UP, "exit status 1"),
        ("dies", Status.CRASHED, "exit status -11"),
        ("hangs", Status.OUT_OF_TIME, "ends within 3 s"),
    ],
)
def test_each_way_to_break_has_its_word(scene, command, what, status, said):
    run = measured("mine", command + what, 0.01, scene, golden_of(scene, 34), 1.0 if what == "hangs" else 20.0)
    assert run.row.status == status
    assert said in run.row.reason
    if what == "works":
        assert run.row.error_m < 1e-9
    if what == "drifts":
        assert run.breaks_at(0.1) == 5.25
        assert run.breaks_at(1.0) is None


def test_the_study_says_from_when_on_a_program_is_wrong(command, tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(
        'id = "short"\n[pendulum]\nlength = "1"\n[release]\nangle = "80"\nazimuth = "10"\n'
        '[run]\nt_end = "10"\ngrid_step = "1"\n'
    )
    scene = cut(load_scene(path))
    times = np.linspace(0, 10, 41)
    np.save(tmp_path / "rows.npy", np.column_stack([times, trajectory(scene, times)[:, :2]]))
    program = tmp_path / "p.py"
    program.write_text(PROGRAM)
    words = " ".join(map(shlex.quote, [sys.executable, str(program), str(tmp_path / "rows.npy")])) + " {t_end} "
    pytest.importorskip("numba")
    programs = {"right": f"{words} works", "drifting": f"{words} drifts"}
    cells = {cell.method: cell for cell in stability([str(path)], ["rk4"], programs=programs)}
    assert (cells["right"].status, cells["right"].wrong_from_s) == (Status.OK, None)
    assert cells["right"].digits > 9
    drifting = cells["drifting"]
    assert (drifting.status, drifting.wrong_from_s, drifting.asked) == (Status.SILENTLY_WRONG, 5.25, 6.0)
    assert drifting.reason.startswith("From t = 5.25 s on it is wrong.")


def test_the_page_names_a_program_once_and_stays_whole(foucault, tmp_path):
    pytest.importorskip("numba")
    pytest.importorskip("matplotlib")
    command = f"{shlex.quote(sys.executable)} -c pass {{x0}} {'x' * 3000}"
    words = ["stability", "--scenes", "hard", "--methods", "rk4", "--run", command, "--name", "<mine>"]
    status, out, _ = foucault(*words, "--out", tmp_path / "out")
    assert status == 0
    assert "<mine> breaks on 1 of 1 scenes: hard (gave up)." in out
    page = (tmp_path / "out/index.html").read_text()
    assert "x" * 500 not in page and "&lt;mine&gt;" in page and "<mine>" not in page
    assert foucault("stability", "--name", "mine")[0] == 2
    assert foucault("stability", "--run", "./p {nonsense}")[0] == 2
