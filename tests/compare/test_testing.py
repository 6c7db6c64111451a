"""`assert_agrees` and its pytest fixture: silent if a trajectory is right, with an exact message if it is not."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import compare
from compare import assert_agrees
from reference import InputError, load, load_scene, trajectory

TWO_ROWS = [0.0, 60.0], [[0.3, 0.4], [-0.17632673290555428, -0.4158676877474455]]


@pytest.fixture(scope="module")
def golden():
    return load("paris.binary64")


@pytest.fixture(scope="module")
def states(golden):
    return np.column_stack([getattr(golden, name) for name in ("x", "y", "z", "vx", "vy", "vz")])


@pytest.mark.parametrize("columns", [2, 3, 6])
def test_the_golden_numbers_agree(golden, states, columns):
    made = assert_agrees(
        "paris", golden.t, states[:, :columns], tolerance=1e-13, transits=golden.transits["t"]
    )
    assert made.agrees
    assert made.transits.matched == 10514


def test_a_scene_of_ones_own_will_do(golden, states):
    assert_agrees(load_scene("paris"), golden.t[:10], states[:10, :2], tolerance=1e-13)


def test_a_failure_tells_the_worst_row_and_names_the_mistake_as_score_does(golden):
    """The bob of a plane pendulum that does not feel the Earth's rotation."""
    still = load_scene("paris", ["site.rotation_rate=0", "run.t_end=3600", "inputs=binary64"])
    run = trajectory(still, golden.t[:61])[:, :2]
    gap = run - np.column_stack([golden.x, golden.y])[:61]
    row = int(np.hypot(*gap.T).argmax())
    column = int(np.abs(gap[row]).argmax())
    right = (golden.x, golden.y)[column][row]
    with pytest.raises(AssertionError) as caught:
        assert_agrees("paris", golden.t[:61], run)
    said = str(caught.value)
    assert f"{'xy'[column]} at t = {float(golden.t[row])!r} s (row {row + 1})" in said
    assert f"expected   {float(right)!r}" in said
    assert f"got        {float(run[row, column])!r}" in said
    assert f"difference {gap[row, column]:+.3e} m" in said
    assert "allowed 7.112e-07 m" in said  # a millionth of the amplitude, as `foucault score` allows
    assert "leaves out the rotation of the Earth" in said
    assert "worst of each       x 0." in said


def test_agreement_as_a_simpler_model_is_enough_if_that_is_asked_for(golden):
    """The harmonic pendulum on a turntable, of the gravity that an observer measures."""
    t = golden.t[:61]
    motion, other_g = compare.APPROXIMATIONS["linear_g"], load_scene("paris", ["site.gravity=9.81"])
    states = motion.trajectory(load_scene("paris"), t.tolist())[:, :2]
    with pytest.raises(AssertionError) as caught:
        assert_agrees("paris", t, states)
    assert "linear" in str(caught.value)
    score = assert_agrees("paris", t, states, as_model=True)
    assert not score.agrees and score.passes
    with pytest.raises(AssertionError):
        assert_agrees("paris", t, motion.trajectory(other_g, t.tolist())[:, :2], as_model=True)


def test_a_failure_of_transits_tells_which(golden, states):
    zeros = np.delete(golden.transits["t"], [5])
    with pytest.raises(AssertionError, match="missed at") as caught:
        assert_agrees("paris", golden.t, states[:, :2], tolerance=1e-6, transits=zeros)
    said = str(caught.value)
    assert f"missed at         {golden.transits['t'][5]:.6f} s" in said
    assert said.startswith(
        "paris: every position is within the 1.000e-06 m that are allowed, and yet:\n"
    )
    assert "got  " not in said  # of no row that is within the tolerance


def test_what_says_nothing_or_too_little_of_the_motion_fails():
    with pytest.raises(AssertionError, match="covers nothing      no row after t = 0"):
        assert_agrees("paris", [0.0], [[0.3, 0.4]])
    with pytest.raises(AssertionError, match=r"covers too little   0\.0694 %  \(100 % demanded"):
        assert_agrees("paris", *TWO_ROWS, covers=1)
    assert assert_agrees("paris", *TWO_ROWS, covers=60 / 86400).covered == 60 / 86400


def test_long_doubles_keep_their_digits(golden, states):
    wide = states[:3, :2].astype(np.longdouble)
    wide[1, 0] += np.longdouble("1e-18")
    made = assert_agrees("paris", golden.t[:3], wide, tolerance=1e-12, inputs="binary64")
    assert made.candidate.extended


@pytest.mark.parametrize(
    ("t", "rows", "more", "words"),
    [
        ([0.0], [0.3, 0.4], {}, "states: got shape"),
        ([0.0], [[0.3, 0.4, 0, 0]], {}, "states: got shape"),
        ([0.0, 1.0], [[0.3, 0.4]], {}, "2 numbers, as many as t has"),
        ([[0.0]], [[0.3, 0.4]], {}, "states: t"),
        ([0.0], [[0.3, float("nan")]], {}, "nan in row 1"),
        ([0.0], [["0.3", "0.4"]], {}, "real numbers"),
        ([0.0], [[0.3, 0.4j]], {}, "real numbers"),
        ([0.0, 1.0], [[0.3, 0.4], [0.3]], {}, "rows of different lengths"),
        ([0.0], [[0.3, 0.4]], {"transits": ["soon"]}, "transits.*real numbers"),
        ([1.0, 0.0], [[0.3, 0.4]] * 2, {}, "strictly increasing"),
        ([1e9], [[0.3, 0.4]], {}, "from 0 to 86400 s"),
        ([0.0], [[0.3, 0.4]], {"tolerance": -1.0}, "tolerance"),
        ([0.0], [[0.3, 0.4]], {"tolerance": float("nan")}, "tolerance"),
        (
            [60.0],
            [[0.3, 0.4]],
            {"inputs": "Auto"},
            "inputs: got 'Auto', expected auto, decimal or binary64. Did you mean",
        ),
        (
            [60.0],
            [[0.3, 0.4]],
            {"baseline": 3},
            "baseline: got '3', expected a score, a trajectory, the path of a file",
        ),
        ([60.0], [[0.3, 0.4]], {"covers": 2.0}, "covers"),
        ([0.0], [[0.3, 0.4]], {"transits": [2.0, 1.0]}, "transits"),
        ([0.0], [[0.3, 0.4]], {"transits": [float("inf")]}, "transits"),
    ],
)
def test_a_mistake_in_the_call_is_no_failed_assertion(t, rows, more, words):
    with pytest.raises(InputError, match=words):
        assert_agrees("paris", t, rows, **{"tolerance": 1e-6, **more})


def test_the_names_of_the_package_are_there():
    for name in compare.__all__:
        assert getattr(compare, name)
    assert set(compare.__all__) <= set(dir(compare))


def test_an_unknown_name_is_answered_with_those_that_exist_the_nearest_first():
    with pytest.raises(
        AttributeError, match="'compare' has no attribute 'jugde'; it has judge, "
    ) as caught:
        _ = compare.jugde
    assert all(name in str(caught.value) for name in compare.__all__)


def test_a_file_is_judged_by_path_and_id(golden, states, tmp_path):
    path = tmp_path / "mine.csv"
    rows = np.column_stack([golden.t, states])[:50]
    rows[30, 2] += 1e-3
    path.write_text(
        "t,x,y\n" + "".join(",".join(map(repr, row[:3].tolist())) + "\n" for row in rows)
    )
    score = compare.judge(path, "paris", explain=False)
    assert repr(score) == "Score(disagrees with paris: 0.001 m)"
    assert repr(score.errors).startswith("TrajectoryErrors(50 rows, max_m=0.001,")
    times = golden.transits["t"][golden.transits["t"] < 2940.0]
    again = compare.judge(
        compare.read(path), load_scene("paris"), transits=np.delete(times, 5), explain=False
    )
    assert np.array_equal(again.errors.position, score.errors.position)
    assert repr(again.transits) == f"TransitErrors({len(times) - 1} matched, 1 missed, 0 extra)"
    assert repr(again.candidate) == "Candidate(mine.csv: 50 rows of t, x, y)"
    assert len(repr(again.swing)) < 100


OTHERS = """
def test_right(assert_agrees):
    assert_agrees("paris", [0.0, 60.0], [[0.3, 0.4], [-0.176326733, -0.415867688]], tolerance=1e-8)

def test_wrong(assert_agrees):
    assert_agrees("paris", [0.0, 60.0], [[0.3, 0.5], [-0.176326733, -0.415867688]], tolerance=1e-8)
"""


SCENES = """
import numpy as np, pytest
from reference import load

@pytest.mark.foucault_scenes("conical", paris=1e-9)
def test_right(foucault_scene):
    golden = load(f"{foucault_scene.scene.id}.binary64")
    foucault_scene.assert_agrees(foucault_scene.t[:5], np.column_stack([golden.x, golden.y])[:5])

@pytest.mark.foucault_scenes(paris=1e-9, hard=1.0)
def test_release(foucault_scene):
    x0, y0 = foucault_scene.inputs["x0"], foucault_scene.inputs["y0"]
    foucault_scene.assert_agrees([0.0, 1e-4], [[x0, y0], [x0 + 1e-6, y0]])

def test_without_scenes(assert_agrees):
    pass
"""


def run_tests(folder):
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-W",
        "error",
        "--strict-markers",
        "-p",
        "no:cacheprovider",
        "-rA",
    ]
    return subprocess.run(
        [*words, str(folder)], cwd=folder, capture_output=True, text=True, check=False
    )


def test_the_fixtures_are_found_in_somebody_elses_tests_with_a_tolerance_for_each_scene(tmp_path):
    (tmp_path / "test_theirs.py").write_text(OTHERS)
    (tmp_path / "test_scenes.py").write_text(SCENES)
    said = run_tests(tmp_path).stdout
    assert "2 failed, 5 passed" in said, said
    assert "y at t = 0.0 s (row 1)" in said
    assert "got        0.5" in said
    for name in ("right[conical]", "right[paris]", "release[hard]"):
        assert f"PASSED test_scenes.py::test_{name}" in said
    for name in ("theirs.py::test_wrong", "scenes.py::test_release[paris]"):
        assert f"FAILED test_{name}" in said


def test_a_test_over_scenes_has_to_name_them(tmp_path):
    (tmp_path / "test_theirs.py").write_text("def test_mine(foucault_scene):\n    pass\n")
    done = run_tests(tmp_path)
    assert done.returncode != 0
    assert "name scenes with @pytest.mark.foucault_scenes(paris=1e-8)" in done.stdout + done.stderr


@pytest.mark.parametrize("columns", [2, 4, 6])
def test_states_that_stand_in_columns_are_said_to_be_transposed(golden, columns):
    states = np.column_stack(
        [getattr(golden, name)[:50] for name in ("x", "y", "vx", "vy", "z", "vz")[:columns]]
    )
    with pytest.raises(
        InputError,
        match=rf"shape \({columns}, 50\) for 50 times.*transpose the array, as in sol\.y\.T",
    ):
        assert_agrees("paris", golden.t[:50], states.T)
