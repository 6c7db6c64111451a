"""`foucault score` as a user meets it: verdict, exit status, JSON, pictures, and messages about bad input."""

from __future__ import annotations

import json
import os
import shlex
import sys
from dataclasses import replace
from decimal import Context, Decimal, localcontext
from fractions import Fraction

import numpy as np
import pytest

from compare.approximations import APPROXIMATIONS
from compare.candidates.read import read
from compare.score.judge import judge
from compare.score.transit_matching import judged_transits
from reference import InputError, Solution, load, load_scene, solve, trajectory
from reference.dataset.manifest import Possible
from reference.engines.trajectory import Variants
from reference.numbers.columns import STATE
from reference.plain_text import plain

COLUMNS = ("x", "y", "z", "vx", "vy", "vz")
OWN = """id = "mine"
[pendulum]
length = "2"
drag = "{drag}"
[site]
latitude = "{latitude}"
[release]
{release}
[run]
t_end = "{t_end}"
grid_step = "5"
digits = 22
transits = {transits}
"""


@pytest.fixture(scope="module", autouse=True)
def own_cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FOUCAULT_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


def write_times(path, times):
    path.write_text("t\n" + "".join(f"{t!r}\n" for t in np.asarray(times).tolist()))
    return path


def write_csv(path, t, states, columns=COLUMNS, digits=17):
    lines = [",".join(("t", *columns))]
    lines += [
        f"{a:.{digits}g}," + ",".join(f"{v:.{digits}g}" for v in row)
        for a, row in zip(t, states, strict=True)
    ]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture(scope="module")
def golden():
    return load("paris.binary64")


@pytest.fixture(scope="module")
def states(golden):
    return np.column_stack([getattr(golden, name) for name in COLUMNS])


@pytest.fixture(scope="module")
def whole(tmp_path_factory, golden, states):
    return write_csv(tmp_path_factory.mktemp("whole") / "whole.csv", golden.t, states)


@pytest.fixture(scope="module")
def good(tmp_path_factory, golden, states):
    """Every tenth row, to the end: enough where rows are not counted."""
    return write_csv(tmp_path_factory.mktemp("good") / "good.csv", golden.t[::10], states[::10])


def off_by(tmp_path, golden, states, column, error):
    wrong = states.copy()
    wrong[:, COLUMNS.index(column)] += error
    return write_csv(tmp_path / "wrong.csv", golden.t[::10], wrong[::10])


KEYS = {
    "scene",
    "verdict",
    "max_error_m",
    "rms_error_m",
    "end_error_m",
    "digits",
    "tolerance_m",
    "input_floor_m",
}
WORST = {"t", "component", "expected", "got"}
TRANSITS = {"matched", "missed", "extra", "max_error_s", "max_conditioned_error_m"}


def test_the_golden_numbers_agree_and_the_document_has_the_keys_of_the_contract(
    foucault, whole, golden
):
    zeros = golden.path / "transits.csv"
    status, out, err = foucault("score", "paris", whole, "--transits", zeros, "--json")
    said = json.loads(out)
    assert (status, said["verdict"], err) == (0, "agrees", "")
    assert KEYS | {"worst", "transits"} <= set(said)
    assert set(said["worst"]) >= WORST
    assert set(said["transits"]) >= TRANSITS
    assert said["max_error_m"] < 1e-16 * 100
    assert said["transits"]["matched"] == 10514
    assert said["reference"]["level"] == golden.manifest.level
    assert said["problem"]["release"] == {"x": "0.3", "y": "0.4"}
    assert (said["problem"]["pendulum"], len(said["problem"])) == ({"length": "67", "drag": "0"}, 3)
    # rounding the inputs of Paris moves the bob by 5e-13 m in a day
    assert 4e-13 < said["input_floor_m"] < 6e-13


def test_people_are_told_in_words(foucault, whole):
    status, out, _ = foucault("score", "paris", whole)
    assert status == 0
    assert "whole.csv agrees with paris (1441 rows, t = 0 to 86400 of 86400 s: 100 %)" in out


def test_a_wrong_run_disagrees_with_exit_status_1(foucault, tmp_path, golden, states):
    path = off_by(tmp_path, golden, states, "y", 1e-3 * np.sin(golden.t))
    status, out, _ = foucault("score", "paris", path, "--json", "--no-diagnosis")
    said = json.loads(out)
    assert (status, said["verdict"]) == (1, "disagrees")
    assert said["max_error_m"] == pytest.approx(1e-3, rel=0.01)
    assert said["worst"]["component"] == "y"
    assert said["worst"]["got"] - said["worst"]["expected"] == pytest.approx(
        said["worst"]["difference"], rel=1e-9
    )


def test_without_a_diagnosis_nothing_is_claimed_about_one(foucault, tmp_path):
    nowhere = [[0.3, 0.4], [0.1, 0.2], [0.2, -0.3]]
    path = write_csv(tmp_path / "wrong.csv", [0.0, 60.0, 120.0], nowhere, "xy")
    assert "Nothing that was tried" not in foucault("score", "paris", path, "--no-diagnosis")[1]
    assert "Nothing that was tried" in foucault("score", "paris", path)[1]


def test_the_tolerance_decides(foucault, tmp_path, golden, states):
    path = off_by(tmp_path, golden, states, "x", 1e-4)
    assert foucault("score", "paris", path, "--tolerance", "2e-4")[0] == 0
    assert foucault("score", "paris", path, "--tolerance", "0.5e-4", "--no-diagnosis")[0] == 1


@pytest.mark.parametrize(("error", "agrees"), [("1e-30", True), ("1e-28", False)])
def test_a_reference_is_never_judged_finer_than_its_own_bound(foucault, tmp_path, error, agrees):
    """Golden rows to 40 digits are held as pairs of doubles, to 3e-30 m: below that nobody is blamed."""
    lines = (load("paris").path / "grid.csv").read_text().splitlines()[:6]
    for i, line in enumerate(lines[1:], 1):
        t, x, others = line.split(",", 2)
        with localcontext(Context(prec=60)):
            lines[i] = f"{t},{Decimal(x) + Decimal(error)},{others}"
    path = tmp_path / "close.csv"
    path.write_text("\n".join([*lines, ""]))
    status, out, _ = foucault(
        "score", "paris", path, "--tolerance", "1e-60", "--json", "--no-diagnosis"
    )
    said = json.loads(out)
    assert status == (0 if agrees else 1)
    assert said["at_or_below_bound"] is agrees
    assert said["max_error_m"] == pytest.approx(float(error), rel=0.1)
    assert 1e-30 < said["reference"]["bound_m"] < 1e-29
    said = foucault("score", "paris", path, "--tolerance", "1e-60", "--no-diagnosis")[1]
    assert ("at or below the reference's bound" in said) is agrees


def test_the_reading_of_the_inputs_is_chosen_and_said(foucault, good):
    read = {}
    for inputs in ("auto", "decimal", "binary64"):
        read[inputs] = json.loads(foucault("score", "paris", good, "--inputs", inputs, "--json")[1])
    assert read["auto"]["inputs"] == "binary64"
    assert "doubles" in read["auto"]["why_inputs"]
    assert read["decimal"]["why_inputs"] == "as asked"
    assert read["auto"]["max_error_m"] == read["binary64"]["max_error_m"]
    # the same numbers in the other reading are off by the input floor
    assert read["decimal"]["max_error_m"] == pytest.approx(read["auto"]["input_floor_m"], rel=0.1)


def test_more_digits_than_a_doubles_are_judged_as_decimals(foucault):
    decimal = load("paris")
    said = json.loads(foucault("score", "paris", decimal.path / "grid.csv", "--json")[1])
    assert (said["inputs"], said["verdict"]) == ("decimal", "agrees")
    assert said["digits"] > 28
    assert "more digits" in said["why_inputs"]


def test_a_good_double_run_is_about_as_good_as_its_inputs(foucault, tmp_path):
    scene = load_scene("paris", ["inputs=binary64"])
    times = np.sort(np.random.default_rng(2).uniform(0, 86400, 500))
    # which loses least in double
    rows = trajectory(scene, np.concatenate([[0.0], times]), formulation="space")
    path = write_csv(tmp_path / "run.csv", times, rows[1:])
    said = json.loads(foucault("score", "paris", path, "--json", "--tolerance", "1e-11")[1])
    assert said["verdict"] == "agrees"
    assert 1e-15 < said["max_error_m"] < 1e-11
    assert said["error_over_floor"] == pytest.approx(said["max_error_m"] / said["input_floor_m"])


def test_several_candidates_are_judged_one_by_one(foucault, good, tmp_path, golden, states):
    wrong = off_by(tmp_path, golden, states, "x", 1.0)
    status, out, _ = foucault("score", "paris", good, wrong, "--json", "--no-diagnosis")
    said = json.loads(out)
    assert (status, said["verdict"]) == (1, "disagrees")
    assert [row["verdict"] for row in said["rows"]] == ["agrees", "disagrees"]


def test_standard_input_is_a_candidate(foucault, good):
    status, out, _ = foucault("score", "paris", "-", stdin=good.read_bytes())
    assert status == 0
    assert "standard input agrees" in out


def test_a_program_is_run_and_timed(foucault, good):
    status, out, _ = foucault(
        "score", "paris", "--run", f"cat {shlex.quote(str(good))}", "--repeats", "1", "--json"
    )
    said = json.loads(out)
    assert status == 0
    assert said["timing"]["runs"] == 1
    assert said["timing"]["warm"]
    assert (
        "no warm-up"
        in foucault("score", "paris", "--run", f"cat {shlex.quote(str(good))}", "--repeats", "0")[1]
    )


def test_missed_and_extra_transits_disagree_and_are_named(foucault, good, golden, tmp_path):
    zeros = np.sort([*np.delete(golden.transits["t"], 100), 1234.5])
    path = write_times(tmp_path / "zeros.csv", zeros)
    status, out, _ = foucault("score", "paris", good, "--transits", path)
    assert status == 1
    assert "10513 matched, 1 missed, 1 extra" in out
    assert f"missed at         {golden.transits['t'][100]:.6f} s" in out
    assert "extra at          1234.500000 s" in out


@pytest.mark.parametrize(("weighted", "status"), [(0.9, 0), (1.1, 1)])
def test_one_shifted_transit_decides_about_a_perfect_run(
    foucault, good, golden, tmp_path, weighted, status
):
    zeros, tolerance_m, omega = golden.transits["t"].copy(), 1e-5, 2 * np.pi / 16.4
    by = weighted * tolerance_m * omega / abs(golden.transits["ax"][100])
    zeros[100] += by
    path = write_times(tmp_path / "zeros.csv", zeros)
    done, out, _ = foucault("score", "paris", good, "--transits", path, "--tolerance", tolerance_m)
    assert done == status
    assert f"10514 matched{' (1 shifted)' * status}, 0 missed, 0 extra" in out
    assert (f"shifted           {zeros[100] - by:.6f} s by {by:.2g} s" in out) is bool(status)


def test_a_release_at_rest_and_what_lies_beyond_the_end_are_no_extra_transits(
    foucault, good, golden, tmp_path
):
    path = write_times(tmp_path / "zeros.csv", [0.0, *golden.transits["t"], 86400.5])
    assert foucault("score", "paris", good, "--transits", path)[0] == 0


def test_a_moving_release_is_no_transit():
    scene = load_scene("paris", ["release.vx=0.1", "run.t_end=120", "run.level=confirmed"])
    zeros = np.array([float(t) for t in solve(scene).transits.exact("t")])
    assert judge(None, scene, transits=zeros, explain=False).agrees
    assert list(
        judge(None, scene, transits=np.array([0.0, *zeros]), explain=False).transits.extra
    ) == [0.0]


def test_a_picture_is_drawn_and_the_same_one_has_the_same_bytes(foucault, tmp_path, golden, states):
    pytest.importorskip("matplotlib")
    few, wrong = golden.t[:50], states[:50].copy()
    wrong[:, 0] += 1e-6 * few / 60
    path = write_csv(tmp_path / "wrong.csv", few, wrong)
    drawn = tmp_path / "error.svg"
    pictures = []
    for _ in range(2):
        assert foucault("score", "paris", path, path, "--plot", drawn, "--no-diagnosis")[0] == 1
        pictures.append(drawn.read_text())
    assert pictures[0].startswith("<?xml") and "error against time" in pictures[0]
    assert pictures[0] == pictures[1]


@pytest.mark.parametrize(
    ("suffix", "name"),
    [
        ("svg", b"n\xff.csv"),
        ("svg", b"e\x1b[31m\n.csv"),
        pytest.param("svg", rb"$x^$ $\frac.csv", marks=pytest.mark.long),
        pytest.param("png", b"n\xff.csv", marks=pytest.mark.long),
        pytest.param("png", b"e\x1b[31m\n.csv", marks=pytest.mark.long),
        ("png", rb"$x^$ $\frac.csv"),
    ],
)
def test_a_picture_is_drawn_whatever_the_file_is_called(
    foucault, tmp_path, golden, states, suffix, name
):
    pytest.importorskip("matplotlib")
    path = write_csv(tmp_path / os.fsdecode(name), golden.t[:3], states[:3])
    drawn = tmp_path / f"error.{suffix}"
    status, out, err = foucault("score", "paris", path, "--plot", drawn)
    assert (status, err) == (0, "")
    assert out.startswith(f"{tmp_path}/{plain(os.fsdecode(name))} agrees with paris (3 rows")
    if suffix == "svg":
        assert "n\\xff.csv" in drawn.read_text() or name[:1] != b"n"
    else:
        assert drawn.read_bytes().startswith(b"\x89PNG")


def test_rows_and_transits_after_the_end_asked_for_are_ignored(whole, golden):
    for end, ignored in (
        (86340, "1 row after t = 86340 s ignored"),
        (600, "1430 rows after t = 600 s ignored"),
    ):
        note = f"{ignored}, the last at 86400 s"
        score = judge(whole, "paris", t_end=end, transits=golden.transits["t"])
        assert (score.candidate.t[-1], score.notes, score.verdict) == (end, (note,), "agrees")
        assert score.transits.matched == int((golden.transits["t"] <= end).sum())
    all_of_it = judge(whole, "paris", t_end=86400.0)
    assert (len(all_of_it.candidate.t), all_of_it.notes) == (1441, ())


@pytest.mark.parametrize(
    ("option", "values", "words"),
    [
        ("tolerance", [0.0, -1.0, float("inf"), float("nan"), "1"], "a positive number of metres"),
        ("covers", [-0.01, 1.01], "from 0 to 1"),
    ],
)
def test_a_tolerance_is_above_zero_and_finite_and_a_share_at_most_the_whole(
    good, option, values, words
):
    for value in values:
        with pytest.raises(InputError, match=words):
            judge(good, "paris", **{option: value})


def test_the_tolerance_is_a_millionth_of_the_amplitude_and_the_bound_is_added(good, golden):
    score = judge(good, "paris")
    assert score.tolerance_m == pytest.approx(1e-6 * np.hypot(golden.x, golden.y).max(), rel=1e-6)
    assert score.allowed_m == score.tolerance_m + score.errors.bound_m


def test_the_release_alone_does_not_agree(foucault):
    """A program that dies after its first line has computed nothing."""
    status, out, _ = foucault("score", "paris", "-", stdin=b"t,x,y\n0,0.3,0.4\n")
    assert status == 1
    assert out.startswith("standard input disagrees with paris (1 row, t = 0 to 0 of 86400 s: 0 %)")
    assert "covers nothing      no row after t = 0" in out


@pytest.mark.parametrize(
    ("rows", "share", "status"),
    [(1441, 1, 0), (1440, 1, 1), (1440, 0.999, 0), (721, 0.5, 0), (720, 0.5, 1)],
)
def test_a_share_of_the_span_can_be_demanded(
    foucault, tmp_path, golden, states, rows, share, status
):
    last = slice(max(0, rows - 20), rows)
    score = judge(
        {"t": golden.t[last], "x": states[last, 0], "y": states[last, 1]}, "paris", covers=share
    )
    assert (score.covered, score.passes) == (min(1, (rows - 1) / 1440), not status)
    assert ("covers too little" in str(score)) is bool(status)
    # and so the command, of which these two are enough
    if (rows, share) in ((1440, 1), (721, 0.5)):
        path = write_csv(tmp_path / "part.csv", golden.t[last], states[last])
        done, out, _ = foucault("score", "paris", path, "--covers", share, "--json")
        assert (done, json.loads(out)["covered"]) == (status, score.covered)


@pytest.mark.parametrize("extended", [False, True])
def test_inputs_that_the_scene_says_are_doubles_are_read_so_whatever_the_candidate_holds(
    good, extended
):
    scene = load_scene("paris", ["inputs=binary64"])
    score = judge(load("paris").path / "grid.csv" if extended else good, scene, explain=False)
    assert score.candidate.extended is extended
    assert (score.scene.inputs, score.why_inputs) == ("binary64", "as the scene says")


def test_transits_alone_are_a_candidate(foucault, tmp_path, golden):
    zeros = golden.transits["t"]
    path = tmp_path / "zeros.csv"

    def score(times, *words):
        status, out, _ = foucault(
            "score", "paris", "--transits", write_times(path, times), "--json", *words
        )
        return status, json.loads(out)

    status, said = score([0.0, *zeros, 86400.5], "--covers", 1)
    assert (status, said["covered"], said["transits"]["matched"]) == (0, 1.0, 10514)
    assert said["max_error_m"] < 1e-11
    off = zeros[:100] + 1e-3
    status, said = score(off)
    assert (status, said["verdict"], said["diagnosis"]) == (1, "disagrees", None)
    weighted = np.abs(golden.transits["ax"][:100]).max() * 1e-3 / (2 * np.pi / 16.4356)
    assert said["max_error_m"] == pytest.approx(weighted, rel=1e-3)
    assert said["worst"]["component"] == "vx"
    assert said["covered"] == pytest.approx(zeros[100] / 86400)
    assert score(np.delete(zeros, 7))[1]["transits"]["missed"] == 1
    path.write_text("t\n8.2\n")
    status, _, err = foucault("score", own_scene(tmp_path, transits="false"), "--transits", path)
    assert status == 2
    assert "were not judged" in err and "expected a trajectory" in err


def test_a_doubled_transit_is_an_extra_one(foucault, good, golden, tmp_path):
    path = write_times(
        tmp_path / "zeros.csv", np.repeat(golden.transits["t"], [1] * 99 + [2] + [1] * 10414)
    )
    status, out, _ = foucault("score", "paris", good, "--transits", path)
    assert status == 1
    assert "10514 matched, 0 missed, 1 extra" in out
    assert f"extra at          {golden.transits['t'][99]:.6f} s" in out


def test_the_worst_of_each_column_is_told(foucault, tmp_path, golden, states):
    wrong = states[:20].copy()
    for row, column, error in ((3, "x", 1e-6), (5, "y", -2e-6), (7, "vz", 3e-6)):
        wrong[row, COLUMNS.index(column)] += error
    path = write_csv(tmp_path / "wrong.csv", golden.t[:20], wrong)
    said = json.loads(foucault("score", "paris", path, "--json", "--no-diagnosis")[1])[
        "worst_of_each"
    ]
    assert list(said) == list(COLUMNS)
    assert (said["x"]["t"], said["y"]["t"], said["vz"]["t"]) == (180.0, 300.0, 420.0)
    assert said["y"]["difference"] == pytest.approx(-2e-6)
    assert "x 1e-06 m, y 2e-06 m" in foucault("score", "paris", path, "--no-diagnosis")[1]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "CANDIDATE: got nothing"),
        (["none.csv"], "No such file"),
        (["-", "-"], "only once"),
        (["-", "--transits", "-"], "only once"),
        (["-"], "no header and no rows"),
        (["{good}", "--tolerance", "0"], "--tolerance: got '0'"),
        (["{good}", "--tolerance", "nan"], "--tolerance: got 'nan'"),
        (["{good}", "--tolerance", "soon"], "--tolerance"),
        (["{good}", "--inputs", "exact"], "--inputs"),
        (["{good}", "--transits", "none.csv"], "--transits: got"),
        (["{good}", "--transits", "{good}.npz"], "--transits: got"),
        (["{good}", "--plot", "error.jpeg2"], "--plot: got"),
        (["{good}", "--plot", "no/such/folder/error.svg"], "an existing folder"),
        (["--run", ""], "--run: got"),
        (["--run", "cat {{x9}}"], "--run: got '{x9}'"),
        (["--run", "false"], "exit status 1"),
        (["--run", "true"], "no header and no rows"),
        (["--run", "sleep 9", "--timeout", "0.2"], "ends within 0.2 s"),
        (["--run", "true", "--timeout", "-1"], "--timeout: got"),
        (["--run", "true", "--repeats", "-1"], "--repeats: got"),
        (["{good}", "--set", "site.latitude=91"], "site.latitude: got '91'"),
        (["{good}", "--set", "release.x=a lot"], "release.x: got 'a lot'"),
    ],
)
def test_a_users_mistake_gets_a_message_and_exit_status_2(foucault, good, words, said):
    status, out, err = foucault("score", "paris", *(word.format(good=good) for word in words))
    assert status == 2
    assert said in err
    assert out == ""
    assert "Traceback" not in err


def own_scene(
    tmp_path,
    drag="0",
    latitude="48.846111",
    release='x = "0.1"\ny = "0.2"',
    t_end="60",
    transits="true",
):
    path = tmp_path / "mine.toml"
    path.write_text(
        OWN.format(drag=drag, latitude=latitude, release=release, t_end=t_end, transits=transits)
    )
    return path


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"drag": "0.05"},
        # the last two are at the pole as well
        pytest.param({"latitude": "90"}, marks=pytest.mark.long),
        {"release": 'angle = "120"\nazimuth = "30"\nazimuth_rate = "20"', "t_end": "20"},
        {"release": 'angle = "0"\nazimuth = "0"', "latitude": "90", "transits": "false"},  # at rest
        # upside down
        {"release": 'angle = "180"\nazimuth = "0"', "latitude": "90", "transits": "false"},
    ],
    ids=["plain", "drag", "pole", "above", "at_rest", "inverted"],
)
def test_a_scene_of_the_users_own_is_judged(foucault, tmp_path, changes):
    path = own_scene(tmp_path, **changes)
    scene = load_scene(path, ["inputs=binary64"])
    times = np.linspace(0, float(scene.run.t_end), 77)
    states = trajectory(scene, times)
    rows = write_csv(tmp_path / "run.csv", times, states)
    status, out, _ = foucault("score", path, rows, "--json", "--tolerance", "1e-8")
    said = json.loads(out)
    assert (status, said["verdict"]) == (0, "agrees")
    rows = write_csv(tmp_path / "run.csv", times, states + 1e-3)
    assert foucault("score", path, rows, "--no-diagnosis")[0] == 1


def test_transits_that_the_scene_does_not_ask_for_are_not_judged(foucault, tmp_path):
    path = own_scene(tmp_path, transits="false")
    zeros = write_times(tmp_path / "zeros.csv", [1, 2, 3])
    scene = load_scene(path, ["inputs=binary64"])
    rows = write_csv(
        tmp_path / "run.csv", np.linspace(0, 60, 5), trajectory(scene, np.linspace(0, 60, 5))
    )
    status, out, _ = foucault("score", path, rows, "--transits", zeros)
    assert status == 0
    assert "were not judged" in out


def test_transits_of_a_motion_that_is_in_one_plane_are_not_judged(foucault, tmp_path):
    path = own_scene(tmp_path, release='x = "0"\ny = "0.2"')
    changes = ["site.rotation_rate=0", "inputs=binary64"]
    times = np.linspace(0, 60, 5)
    rows = write_csv(tmp_path / "run.csv", times, trajectory(load_scene(path, changes), times))
    zeros = write_times(tmp_path / "zeros.csv", [1, 2])
    status, out, _ = foucault("score", path, rows, "--transits", zeros, "--set", changes[0])
    assert status == 0
    assert "xdot is identically zero, so the candidate's transits were not judged" in out


@pytest.mark.parametrize("columns", [("x", "y"), ("y", "x", "vz")])
def test_one_row_of_two_columns_is_enough(foucault, tmp_path, golden, states, columns):
    picked = states[7:8, [COLUMNS.index(name) for name in columns]]
    path = write_csv(tmp_path / "one.csv", golden.t[7:8], picked, columns)
    status, out, _ = foucault("score", "paris", path)
    assert status == 0
    assert "(1 row, t = 420 to 420 of 86400 s: 0.486 %)" in out


def test_errors_as_large_as_numbers_go_are_judged(foucault, tmp_path, golden, states):
    path = write_csv(tmp_path / "big.csv", golden.t[:61], states[:61] * 1e90)
    status, out, _ = foucault("score", "paris", path, "--json")
    said = json.loads(out)
    assert status == 1
    assert said["diagnosis"] is None
    assert all(
        np.isfinite(said[key]) for key in ("max_error_m", "rms_error_m", "digits", "h_drift_m2_s2")
    )


def test_of_collinear_inputs_the_height_is_named(foucault, tmp_path):
    """The Earth's size and shape and the height enter by one number only, the distance from the axis."""
    scene = load_scene("paris", ["inputs=binary64"])
    times = np.linspace(0, 7200, 200)
    higher = Variants().states(scene.with_values(["site.altitude=1000"]).exact, times)
    path = write_csv(tmp_path / "high.csv", times, higher)
    found = json.loads(foucault("score", "paris", path, "--json")[1])["diagnosis"]
    assert found["id"] == "site.altitude"
    assert found["shift"] == pytest.approx(1000, rel=1e-3)
    assert found["also"] == []


def calls_of(work):
    """Return how many functions, Python's and C's, are called by a piece of work."""
    calls = 0

    def called(_, event, __):
        nonlocal calls
        calls += event in ("call", "c_call")

    sys.setprofile(called)
    try:
        work()
    finally:
        sys.setprofile(None)
    return calls


def test_ten_times_the_rows_of_a_day_take_hardly_more_calls_and_nothing_is_solved(tmp_path):
    """The truth at their times is evaluated by the golden function."""
    paris = load_scene("paris", ["inputs=binary64"])
    told = []

    def calls(rows):
        times = np.linspace(0, 86400, rows)
        np.savez(
            tmp_path / "day.npz",
            t=times,
            **dict(zip(COLUMNS, trajectory(paris, times).T, strict=True)),
        )
        return calls_of(
            lambda: judge(
                read(tmp_path / "day.npz"), paris, announce=told.append, report=told.append
            )
        )

    calls(100)  # imports and compiles
    few, many = calls(10_000), calls(100_000)
    assert many < 1.1 * few
    assert told == []


@pytest.mark.parametrize(
    ("site", "warned"),
    [
        (["site.gravity=0.01"], True),  # RΩ² is 0.022 m/s² at Paris
        (["site.gravity=0.03"], False),
        (["site.rotation_rate=0.07"], True),  # a program that speeds the Earth up
        (["site.rotation_rate=0.07", "site.gravity_is=effective"], False),
        (["site.rotation_rate=0.07", "site.equatorial_radius=0"], False),
        # without any force there is none larger than g
        (["site.gravity=0", "site.rotation_rate=0"], False),
    ],
)
def test_a_centrifugal_force_larger_than_g_is_warned_of(tmp_path, site, warned):
    scene = load_scene(
        "paris",
        [*site, "run.t_end=2", "run.grid_step=1", "run.level=self_consistent", "run.digits=10"],
    )
    path = write_csv(tmp_path / "at_rest.csv", [0.0, 1.0], [[0.3, 0.4]] * 2, "xy")
    notes = [note for note in judge(path, scene, explain=False).notes if "larger than g" in note]
    assert bool(notes) is warned
    assert all("site.gravity_is=effective" in note for note in notes)


@pytest.mark.parametrize(
    ("early", "whole"),
    [(-3e-16, True), (1e-13, True), (0.9e-6, True), (1e-6, True), (1.1e-6, False)],
)
def test_a_file_that_ends_a_rounding_off_the_end_covers_all_of_it(
    tmp_path, golden, states, early, whole
):
    path = write_csv(
        tmp_path / "short.csv", np.append(golden.t[-3:-1], 86400 * (1 - early)), states[-3:]
    )
    assert (judge(path, "paris", explain=False).covered == 1.0) is whole


def test_a_transit_at_the_end_asked_for_is_judged(golden):
    zeros = golden.transits["t"]
    score = judge(None, "paris", transits=zeros, t_end=zeros[10])
    assert (score.transits.matched, score.transits.missed, score.transits.extra) == (11, [], [])


def test_a_transit_at_the_end_of_the_span_is_judged(golden):
    score = judge(None, "paris", transits=np.append(golden.transits["t"], 86400.0), explain=False)
    assert score.transits.extra == [86400.0]


def test_transits_within_an_interval_that_the_truth_leaves_open_are_not_judged(good, golden):
    errors = judge(good, "paris", explain=False).errors
    possible = [Possible(from_s="10", to_s="11", parity="even")]
    unsure = replace(golden, manifest=golden.manifest.model_copy(update={"possible": possible}))
    found = judged_transits(np.array([9.0, 10.0, 10.5, 11.0, 12.0]), unsure, errors, 1e-6)
    assert np.sort([*found.at + found.errors_s, *found.extra]).tolist() == [9.0, 12.0]


def test_a_transit_between_the_last_two_rows_is_missed_and_none_after_them(
    tmp_path, golden, states
):
    zeros = golden.transits["t"]
    last = zeros[zeros <= golden.t[10]][-1]
    assert golden.t[9] < last < golden.t[10]
    path = write_csv(tmp_path / "part.csv", golden.t[:11], states[:11])
    assert judge(path, "paris", transits=zeros[zeros < last], explain=False).transits.missed == [
        last
    ]
    assert judge(path, "paris", transits=zeros[zeros <= last], explain=False).agrees


@pytest.mark.parametrize(("early", "after"), [(0.0, 5), (0.9, 5), (1.1, 4)])
def test_transits_alone_cover_the_motion_up_to_the_next_one_beyond_the_tolerance(
    golden, early, after
):
    """The last of five is early by so many times what the fastest bob takes for the tolerance."""
    zeros, tolerance_m = golden.transits["t"], 0.1
    speed_m_s = judge(None, "paris", transits=zeros[:5], explain=False).errors.speed_m_s
    last = zeros[4] - early * tolerance_m / speed_m_s
    part = judge(None, "paris", transits=[*zeros[:4], last], tolerance=tolerance_m, explain=False)
    assert part.covered == zeros[after] / 86400


def test_a_named_model_passes_where_that_is_asked_for():
    scene = load_scene("paris", ["run.t_end=600"])
    t = np.linspace(0, 600, 61)
    x, y, *_ = APPROXIMATIONS["linear_recentred"].trajectory(scene, t).T
    rows, zeros = {"t": t, "x": x, "y": y}, load("paris.binary64").transits["t"]
    hint = "--as-model takes that as enough"
    plain_score, as_model = judge(rows, scene), judge(rows, scene, as_model=True)
    assert (plain_score.verdict, plain_score.passes, as_model.passes) == ("disagrees", False, True)
    assert plain_score.grade == as_model.grade
    assert plain_score.grade.startswith("agrees as the model: harmonic pendulum on a turntable")
    assert hint in str(plain_score) and hint not in str(as_model)
    # a model says nothing of transits
    with_transits = judge(rows, scene, transits=zeros, as_model=True)
    assert not with_transits.passes and hint not in str(with_transits)


def test_columns_in_the_place_of_the_scene_are_refused():
    with pytest.raises(InputError, match=r"call judge\(rows, scene\)"):
        judge("paris", {"t": [0.0], "x": [0.3], "y": [0.4]})


@pytest.mark.parametrize(
    ("part", "of_its_own"), [(0.0, False), (0.05, True), (0.15, False), (1.0, False)]
)
def test_a_candidate_that_swings_less_than_a_tenth_has_a_tolerance_of_its_own_size(
    golden, part, of_its_own
):
    rows = {"t": golden.t, "x": part * golden.x, "y": part * golden.y}
    score = judge(rows, "paris", explain=False)
    own = part if of_its_own else 1.0
    assert score.tolerance_m == pytest.approx(1e-6 * own * score.errors.amplitude_m)


def beyond_the_cord(*points, times=(0.0, 60.0), scene="paris"):
    """Return what is said of positions that the cord does not let the bob reach."""
    x, y = np.array(points).T
    score = judge({"t": times, "x": x, "y": y}, scene, explain=False)
    return [one.text for one in score.candidate.conventions]


@pytest.mark.parametrize(
    ("scale", "words"),
    [
        (1000.9, "they are millimetres; --units mm reads them so"),
        (1001.1, "is it another pendulum, or are 1001.1 pixels"),
        (1000 * (1 + 0.9e-3j), "they are millimetres; --units mm reads them so"),
        # they do not begin in the direction of the release
        (1000 * (1 + 1.1e-3j), "Metres are wanted"),
        (-1000, "Metres are wanted"),
        (0, "Metres are wanted"),
    ],
)
def test_positions_beyond_the_cord_are_in_a_unit_that_fits_to_a_thousandth(golden, scale, words):
    first = scale * (0.3 + 0.4j)
    (said,) = beyond_the_cord((first.real, first.imag), (1000 * golden.x[1], 1000 * golden.y[1]))
    assert words in said


def test_beyond_the_cord_begins_a_hundredth_beyond_it(golden):
    assert beyond_the_cord((0.3, 0.4), (1.009 * 67, 0)) == []
    assert len(beyond_the_cord((0.3, 0.4), (1.011 * 67, 0))) == 1
    # nothing is known of its release
    (late,) = beyond_the_cord((300, 400), (0, 0), times=(0.5, 60.0))
    assert "Metres are wanted" in late
    (elsewhere,) = beyond_the_cord((300, 400), (-1000 * golden.x[1], -1000 * golden.y[1]))
    assert elsewhere.endswith("is it another pendulum, or millimetres? --units mm reads them so")
    # no scale of a release at the origin
    (at_rest,) = beyond_the_cord((99, 0), times=(0.0,), scene="at_rest")
    assert "Metres are wanted" in at_rest


def test_times_may_end_a_grid_step_late_and_ten_spans_look_like_another_unit(tmp_path):
    scene = load_scene(own_scene(tmp_path))  # of 60 s, with a row every 5 s

    def ends_at(last):
        return judge({"t": [0.0, last], "x": [0.1, 0.1], "y": [0.2, 0.2]}, scene, explain=False)

    assert ends_at(65.0).candidate.t[-1] == 65
    for last, words in (
        (65.1, "leaves out later rows"), (600.0, "leaves out later rows"), (600.1, "like milliseconds"),
        (60050.0, "like milliseconds: --units ms reads them so, and they end at 60.05 s"),
        (60070.0, "like microseconds"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words):
            ends_at(last)


@pytest.mark.parametrize("name", ["weightless", "force_free"])
def test_without_a_rest_position_the_swing_plane_is_measured_about_the_vertical(name):
    rows = load(name)
    score = judge({"t": rows.t, "x": rows.x, "y": rows.y}, name)
    assert score.agrees and score.swing.largest_turn < 1e-9


def test_a_run_that_ends_before_the_first_transit_has_none_and_one_more_is_told(tmp_path):
    scene = own_scene(tmp_path, t_end="1")
    times = np.linspace(0, 1, 5)
    rows = write_csv(tmp_path / "run.csv", times, trajectory(load_scene(scene), times))
    score = judge(rows, scene, transits=np.array([]))
    assert score.agrees and score.transits.matched == 0
    assert list(judge(None, scene, transits=np.array([0.5]), explain=False).transits.extra) == [0.5]


def test_a_new_scene_is_solved_cheaply_and_again_where_that_leaves_the_verdict_in_doubt(tmp_path):
    path = own_scene(tmp_path)
    scene = load_scene(path, ["inputs=binary64"])
    times = np.linspace(0, 60, 77)
    rows = write_csv(tmp_path / "run.csv", times, trajectory(scene, times))
    true = solve(scene, level="confirmed", digits=12).transits["t"]
    score = judge(rows, path, transits=np.sort([*true, 10.0]))
    assert isinstance(score.golden, Solution) and score.golden.run.number == "long_double"
    assert (score.transits.matched, score.transits.extra) == (len(true), [10.0])
    assert "input floor" not in str(score)
    rough = judge(rows, path, explain=False).errors.bound_m
    # a bound of a thousandth of the tolerance is enough
    for part, enough in ((0.9, False), (1.1, True)):
        known = judge(rows, path, tolerance=part * 1000 * rough, explain=False).errors.bound_m
        assert (known == rough) is enough


def test_a_verdict_that_the_references_error_could_change_is_made_with_a_closer_one(tmp_path):
    """The reference may be off by its bound in each of three coordinates."""
    path = own_scene(tmp_path, transits="false")
    times = np.linspace(0, 60, 77)
    x, y, *_ = trajectory(load_scene(path, ["inputs=binary64"]), times).T
    rows = {"t": times, "x": x + 1e-3, "y": y}
    rough = judge(rows, path, explain=False).errors
    for bounds, closer in ((2, True), (10, False)):
        found = judge(
            rows, path, tolerance=rough.max_m + bounds * rough.bound_m, explain=False
        ).errors
        assert (found.bound_m < rough.bound_m / 3) is closer


def test_velocities_are_told_and_not_judged(golden):
    columns = {name: golden.grid[name] for name in ("t", *STATE)}
    assert "not judged" not in str(judge(columns, golden.scene))
    score = judge(columns | {"vx": 2 * columns["vx"]}, golden.scene)
    assert score.agrees
    assert "velocities          not judged  (vx off by more than" in str(score)


def test_rounding_to_single_precision_is_all_that_is_said_of_it(golden):
    rounded = {name: golden.grid[name].astype(np.float32).astype(float) for name in ("x", "y", "z")}
    said = str(judge({"t": golden.t, **rounded}, golden.scene))
    assert "Your file holds numbers in single precision" in said
    assert "The rounding of its numbers explains the error." in said


def test_metres_under_a_header_of_centimetres_are_told_and_a_right_z_is_left_alone(golden):
    columns = {name: golden.grid[name] / (1 if name == "z" else 100) for name in ("x", "y", "z")}
    said = str(judge({"t": golden.t, **columns}, golden.scene))
    assert "Your file prints x and y times 0.01.\n" in said and "With this corrected, " in said
    assert "|r| = l" not in said
    said = str(judge({"t": golden.t, **{name: columns[name] for name in "xy"}}, golden.scene))
    assert "Your file counts metres as centimetres.\n" in said


def test_a_tolerance_and_an_end_may_be_any_real_number():
    golden = load("paris")
    rows = {"t": golden.t[:5], "x": golden.x[:5], "y": golden.y[:5]}
    score = judge(rows, "paris", tolerance=Fraction(1, 1000), t_end=Fraction(120))
    assert "tolerance 0.001 m" in str(score) and len(score.errors.t) == 3


def rows_of(name):
    golden = load(name)
    return {"t": golden.t, "x": golden.x, "y": golden.y, "z": golden.z}


@pytest.mark.parametrize(
    ("name", "tolerance", "where"),
    [
        ("nanometre_paris", None, "at its rest position"),
        ("nanometre_paris", 1e-12, None),
        ("at_rest", None, "where it is released"),
        ("millimetre", None, None),
        ("vertical_picometre", None, None),
    ],
)
def test_a_judge_that_a_bob_without_motion_would_pass_says_so(name, tolerance, where):
    rows = rows_of(name)
    score = judge(rows, name, tolerance=tolerance)
    notes = [note for note in score.notes if "would agree as well" in note]
    assert (score.verdict, len(notes)) == ("agrees", where is not None)
    assert where is None or where in notes[0]
    assert [f"Note: {note}." in str(score) for note in notes] == [True] * len(notes)
    # it is as the note says
    still = {
        **rows,
        **{axis: np.full(len(rows["t"]), rows[axis].mean()) for axis in ("x", "y", "z")},
    }
    assert (judge(still, name, tolerance=tolerance, explain=False).verdict == "agrees") == (
        where is not None
    )
