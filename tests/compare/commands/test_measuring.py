"""`score` where inputs are uncertain: rows and transits inside what is proved, or outside."""

import json

import numpy as np
import pytest

import reference
from reference.dataset.ranges import write_ranges

BOX = {"pendulum.length": "±0.001", "site.gravity": "±1e-5"}
WORDS = [word for name, width in BOX.items() for word in ("--uncertain", f"{name}={width}")]
# it swings along the gate of azimuth 0
CHANGES = ("release.x=0.4", "release.y=0", "site.gravity_is=effective")
TIMES = [0.0, 10.0, 16.4, 30.0]


@pytest.fixture
def score(foucault):
    """Run `score`; return its exit status, and what it prints."""

    def run(*words):
        status, out, err = foucault("score", *words)
        return status, out + err

    return run


@pytest.fixture(scope="module")
def golden():
    return reference.load("paris.binary64")


@pytest.fixture
def file(golden, tmp_path):
    """A program's rows, right but for what is added to x and to the transits."""

    def written(x=0.0, y=0.0, t=0.0, length="67"):
        made = reference.trajectory(
            reference.load_scene("paris", [f"pendulum.length={length}"]), TIMES
        )
        table = np.column_stack([TIMES, made[:, 0] + x, made[:, 1] + y])
        np.savetxt(
            tmp_path / "rows.csv", table, delimiter=",", header="t,x,y", comments="", fmt="%.17g"
        )
        zeros = golden.transits["t"][:5] + t
        np.savetxt(tmp_path / "zeros.csv", zeros, header="t", comments="", fmt="%.17g")
        return tmp_path / "rows.csv", tmp_path / "zeros.csv"

    return written


def test_what_lies_inside_cannot_be_told_apart(score, file):
    rows, zeros = file()
    status, told = score("paris", rows, "--transits", zeros, *WORDS)
    assert status == 0, told
    assert (
        "cannot be told apart from paris with pendulum.length ±0.001, site.gravity ±0.00001" in told
    )
    assert "4 rows and 5 transits, all inside" in told
    status, told = score("paris", rows, "--transits", zeros, *WORDS, "--json")
    document = json.loads(told)
    assert (status, document["verdict"], document["outside"]) == (0, "cannot be told apart", [])
    assert (document["rows"], document["transits"], document["uncertain"]) == (4, 5, {
        "pendulum.length": "±0.001", "site.gravity": "±0.00001"})  # fmt: skip


def test_a_pendulum_of_the_box_is_inside_and_one_beyond_it_is_not(score, file):
    rows, _ = file(length="67.0009")
    assert score("paris", rows, *WORDS)[0] == 0
    rows, _ = file(length="67.003")
    status, told = score("paris", rows, *WORDS)
    assert status == 1
    assert (
        "disagrees with paris, whatever pendulum.length ±0.001, site.gravity ±0.00001: of 4 rows, "
        in told
    )
    assert "outside)" in told
    assert score("paris", rows, *WORDS, "--tolerance", "0.001")[0] == 0


@pytest.mark.parametrize("t", [0.001, -0.001])
def test_transits_are_held_against_their_intervals_alone_or_beside_rows(score, file, t):
    rows, zeros = file(t=t)
    status, told = score("paris", "--transits", zeros, *WORDS)
    assert status == 1
    assert "of 5 transits, 5 numbers outside" in told
    assert f"all transits are inside if the clock showed {'-' * (t < 0)}0.0" in told
    assert score("paris", rows, "--transits", zeros, *WORDS)[0] == 1
    assert score("paris", rows, *WORDS)[0] == 0


def test_a_transit_that_comes_twice_is_told(score, tmp_path):
    (tmp_path / "twice.csv").write_text("t\n8.2177\n8.21775\n", encoding="utf-8")
    status, told = score("paris", "--transits", tmp_path / "twice.csv", *WORDS)
    assert status == 1
    assert "1 number outside" in told


def test_every_time_at_which_a_stopwatch_may_have_shown_the_release_is_given(score, tmp_path):
    times = reference.load("museum_gate").sections["gate 127"]["t"][:20]
    np.savetxt(tmp_path / "gate.csv", times + 1234.5, header="t", comments="")
    words = ["--section", "gate 127", "--transits", tmp_path / "gate.csv", "--json"]
    status, out = score("museum_gate", *words)
    starts = json.loads(out)["clock_at_release_s"]
    assert status == 0
    # the twenty passages fit a swing earlier as well
    assert any(low < 1234.5 < high for low, high in starts)
    assert any(high < 1234 for _, high in starts)


def test_ranges_on_disk_take_the_place_of_the_scene(score, file, tmp_path):
    ranges = reference.prove_ranges("paris", t_end="60", widths=BOX)
    folder = write_ranges(ranges, tmp_path / "ranges")
    rows, zeros = file()
    assert score(folder, rows, "--transits", zeros)[0] == 0
    (tmp_path / "end.csv").write_text("t,x,y\n60,0.3,0.4\n70,1,1\n", encoding="utf-8")
    status, told = score(folder, tmp_path / "end.csv")
    assert status == 1
    assert "of 1 row, 2 numbers outside" in told
    assert "Note: after 60 s 1 time left out." in told


@pytest.mark.parametrize(
    "words, told",
    [
        ((), "a file, - for stdin, or --transits"),
        (("rows", "--plot", "a.svg"), "has no effect while inputs are uncertain"),
        (("rows", "--run", "program"), "has no effect while inputs are uncertain"),
        (("rows", "--uncertain", "length=±70"), "expected a number above 0"),
        (("-", "--transits", "-"), "- once"),
        (("late",), "no row within the scene's span"),
    ],
)
def test_what_cannot_be_held_is_told(score, file, tmp_path, words, told):
    (tmp_path / "late.csv").write_text("t,x,y\n1e6,0,0\n", encoding="utf-8")
    places = {"rows": file()[0], "late": tmp_path / "late.csv"}
    box = [] if "length=±70" in words else WORDS
    status, said = score("paris", *(places.get(word, word) for word in words), *box)
    assert status != 0 and told in said


def test_passages_of_a_section_are_scored_where_all_inputs_are_certain(
    score, foucault, file, tmp_path
):
    solution = reference.solve("paris", t_end="20", digits=18, sections="gate 30", transits=False)
    times = solution.sections["gate 30"].table["t"]
    np.savetxt(tmp_path / "gate.csv", times, header="t", comments="", fmt="%.17g")
    words = ("paris", "--transits", tmp_path / "gate.csv", "--t-end", "20", "--section", "gate 30")
    status, told = score(*words)
    assert status == 0, told
    assert f"agrees with paris ({len(times)} passages of gate 30" in told
    assert f"{len(times)} matched, 0 missed, 0 extra" in told
    # that it is solved is told on stderr
    status, out, _ = foucault("score", *words[:-1], "gate 31", "--json")
    document = json.loads(out)
    assert (status, document["verdict"], document["section"]) == (1, "disagrees", "gate 31")
    assert document["transits"]["matched"] == document["transits"]["shifted"] == len(times)
    status, told = score(*words, file()[0])
    assert status == 2 and "the file of --transits alone" in told
    status, told = score("paris", "--section", "gate 30")
    assert status == 2 and "--section: has no effect without --transits" in told


def test_times_at_which_a_section_is_not_decided_are_no_agreement(score, file, tmp_path):
    """A gate along the swing: the bob passes it at no clear moment."""
    box = ("--uncertain", "x0=±0.01", "--uncertain", "y0=±0.01", "--t-end", "60")
    scene = ("paris", *(word for change in CHANGES for word in ("--set", change)), *box)
    (tmp_path / "gate.csv").write_text("t\n20.5\n", encoding="utf-8")
    words = ("--transits", tmp_path / "gate.csv", "--section", "gate 0")
    status, told = score(*scene, *words)
    assert status == 2 and "nothing is proved" in told
    rows, _ = file()
    status, told = score(*scene, rows, *words)
    assert status == 1 and "0 passages of gate 0" in told
    assert "Note: 1 time left out, at which the proof does not decide gate 0." in told


def test_where_a_scene_asks_for_a_gate_times_that_disagree_as_transits_are_told_of_it(
    score, tmp_path
):
    (tmp_path / "gate.csv").write_text("t\n4.2\n", encoding="utf-8")
    words = (
        "paris",
        "--set",
        "run.sections=gate 30",
        "--t-end",
        "60",
        "--transits",
        tmp_path / "gate.csv",
        *WORDS,
    )
    status, told = score(*words)
    assert status == 1 and "Note: for passages of gate 30 write --section 'gate 30'." in told
