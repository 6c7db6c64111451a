"""The cases 01 to 16 and 41 to 44 of the audit: files as people write them, from the file to the verdict.

Case 43 (a tiny push) is in tests/reference/engines/test_transits.py, case 46 (a byte order mark) in
tests/reference/scenes/test_scene.py.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from spellings import WHOLE, comma, table

from reference import load, solve
from reference.scenes.scene import load_scene

MOVED = ("--set", "x0=1", "--set", "y0=0", "--t-end", "4")  # the release of `WHOLE`
ROWS = 6  # golden ones, a minute apart
T_END = ("--t-end", "300")


@pytest.fixture(scope="module")
def golden():
    """Rows of Paris as texts: t, x, y."""
    grid = load("paris.binary64").grid
    columns = [[repr(float(number)) for number in grid[name][:ROWS]] for name in ("t", "x", "y")]
    return [*zip(*columns, strict=True)]


def files(golden):
    """Texts of the cases by number, with the options that they take."""

    def with_t(spelled):
        return [(spelled(float(t)), x, y) for t, x, y in golden]

    fortran = [(t, f"{float(x):.17e}".replace("e", "d"), y) for t, x, y in golden]
    minutes = with_t(lambda t: f"00:{t / 60:02.0f}:00.000")
    moments = with_t(lambda t: f"2026-03-01T12:{t / 60:02.0f}:00.000Z")
    since_1970 = with_t(lambda t: f"{1760000000 + t:.3f}")
    lost = golden[:3], golden[3:]
    return {
        "01": (table("t;x;y", WHOLE, ";", comma), MOVED),
        "02 tabs": (table("t\tx\ty", WHOLE, "\t", comma), MOVED),
        "04": (table("t x y", [golden[0], *fortran[1:]], " "), T_END),
        "05": (table("t,x,y\ns,m,m", golden), T_END),
        "05 b": (table("t,x,y\n(s),(m),(m)", WHOLE), MOVED),
        "06": (table("t,x,y\ndouble,double,double", golden), T_END),
        "07": (table('Time (s) Run #1,"Position, X (m) Run #1","Position, Y (m) Run #1"', golden), T_END),
        "07 b": (table('"t","x","y"', golden, ",", lambda word: f'"{comma(word)}"'), T_END),
        "08": (table("Latest: Time (s),Latest: X (m),Latest: Y (m)", golden), T_END),
        "09": (table("t_s,x_east_m,y_north_m", golden), T_END),
        "10": (table("t,pos_x_m,y_pos_m", golden), T_END),
        "11": (table("time,x,y", since_1970), T_END),
        "13": (table("time,x,y", minutes), T_END),
        "13 b": (table("time,x,y", moments), T_END),
        "14": (table("t,x,y", [*lost[0], ("130", "nan", "nan"), *lost[1]]), T_END),
        "14 b": (table("t,x,y", [*lost[0], ("130", "", ""), *lost[1]]), T_END),
        "15": (table("t,x,y", golden) + ",,\n,,\n", T_END),
        "16": (table("t;x;y", golden, ";", comma), T_END),
        "16 e": (table("timestamp,x(t),y(t)", golden), T_END),
    }  # fmt: skip


def test_the_files_of_the_audit_agree(foucault, tmp_path, golden):
    for name, (text, options) in files(golden).items():
        path = tmp_path / "run.csv"
        path.write_text(text)
        status, out, err = foucault("score", "paris", path, *options, "--json")
        assert status == 0, (name, out, err)
        score = json.loads(out)
        assert score["verdict"] == "agrees" and score["max_error_m"] < 1e-9, name


CLOCK = "the clock showed 1760000000 s since 1970, 2025-10-09 08:53:20 UTC in the first row, which is at the release"


@pytest.mark.parametrize("unit", ["", "ms"])
def test_a_clock_that_began_in_1970_is_recognised(foucault, tmp_path, golden, unit):
    """Case 12 is in milliseconds, which the user has to say: a column called time may be in seconds as well."""
    size = 1000 if unit else 1
    path = tmp_path / "run.csv"
    path.write_text(
        table("time,x,y", [(f"{(1760000000 + float(t)) * size:.3f}", x, y) for t, x, y in golden])
    )
    status, out, err = foucault(
        "score", "paris", path, *T_END, *(("--units", unit) if unit else ())
    )
    assert status == 0 and CLOCK in out, (out, err)
    if unit:
        status, _, err = foucault("score", "paris", path, *T_END)
        assert (
            status == 2
            and "milliseconds: --units ms reads them so, from 1760000000 s since 1970" in err
        )


def test_a_clock_is_not_guessed_at(foucault, tmp_path, golden):
    """The first row is not the release, so that nobody knows when that was; or it may be a part of a longer run."""
    path = tmp_path / "run.csv"
    path.write_text(table("t,x,y", [(f"{float(t) + 5000}", x, y) for t, x, y in golden[1:]]))
    status, _, err = foucault("score", "paris", path, *T_END)
    assert (
        status == 2
        and "5060 s in the first row" in err
        and "Subtract what the clock showed at the release" in err
    )
    path.write_text(
        table("t,x,y", [(f"12:0{i}:00", x, y) for i, (_, x, y) in enumerate(golden[1:])])
    )
    status, _, err = foucault("score", "paris", path, *T_END)
    assert status == 2 and "43200 s in the first row" in err
    path.write_text(table("t,x,y", [(f"{float(t) + 200}", x, y) for t, x, y in golden]))
    status, _, err = foucault("score", "paris", path, "--set", "run.t_end=300")
    assert status == 2 and "Did the clock start before the release?" in err


def test_transits_are_by_the_clock_of_the_rows(foucault, tmp_path, golden):
    times = load("paris.binary64").transits["t"]
    path, zeros = tmp_path / "run.csv", tmp_path / "zeros.csv"
    path.write_text(table("t,x,y", [(f"{float(t) + 1760000000}", x, y) for t, x, y in golden]))
    zeros.write_text("t\n" + "".join(f"{t + 1760000000:.6f}\n" for t in times[times < 300]))
    status, out, err = foucault("score", "paris", path, "--transits", zeros, *T_END)
    assert status == 0 and "0 missed, 0 extra" in out, (out, err)
    status, _, err = foucault("score", "paris", "--transits", zeros, *T_END)
    assert status == 2 and "Subtract what the clock showed at the release" in err


@pytest.mark.parametrize("with_rows", [False, True])
@pytest.mark.parametrize(
    ("change", "status", "said"),
    [
        (lambda times: [0.0, *times], 0, "0 missed, 0 extra"),
        (lambda times: [1e-12, *times], 0, "0 missed, 0 extra"),
        (lambda times: [*times[:5], times[4], *times[5:]], 1, "0 missed, 1 extra"),
        (lambda times: [*times[:5], *times[6:]], 1, "1 missed, 0 extra"),
        (lambda times: [*times, 300.0], 1, "0 missed, 1 extra"),
    ],
    ids=["at the release", "just after it", "twice", "missed", "at the end"],
)
def test_events_at_the_ends(foucault, tmp_path, golden, change, status, said, with_rows):
    """Cases 41 and 42. A run that ends where an event ends it has a last "event" at its end, which is no transit."""
    times = load("paris.binary64").transits["t"]
    path, zeros = tmp_path / "run.csv", tmp_path / "zeros.csv"
    path.write_text(table("t,x,y", golden))
    zeros.write_text("t\n" + "".join(f"{t!r}\n" for t in change([*map(float, times[times < 300])])))
    files = (path, "--transits", zeros) if with_rows else ("--transits", zeros, *T_END)
    done, out, err = foucault("score", "paris", *files)
    assert done == status and said in out and "shifted" not in out, (out, err)


HALL = """
[pendulum]
length = "20"
[site]
latitude = "50"
gravity = "9.8107"
gravity_is = "effective"
[release]
x = "0.8"
y = "0.6"
[run]
t_end = "60"
grid_step = "10"
level = "computed"
"""
BOX = ("--uncertain", "pendulum.length=0.001", "--uncertain", "release.x=0.005")
GATE = ("--section", "gate 127")


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    """A scene, and the times at which its pendulum passes a gate."""
    path = tmp_path_factory.mktemp("hall") / "hall.toml"
    path.write_text(HALL)
    scene = load_scene(path)
    return path, np.array(
        solve(scene.with_values({"run.sections": "gate 127"})).sections["gate 127"].table["t"],
        float,
    )


@pytest.mark.parametrize("start", [0.0, 12.34, -2.2, 5000.0, 1760000000.0])
def test_passages_are_compared_by_any_clock(foucault, tmp_path, hall, start):
    """Cases 03 and 44: what the clock showed at the release is told, as an interval that holds it."""
    scene, times = hall
    path = tmp_path / "passages.csv"
    path.write_text("t\n" + "".join(f"{t + start:.4f}\n".replace(".", ",") for t in times))
    status, out, err = foucault("score", scene, "--transits", path, *GATE, *BOX, "--json")
    assert status == 0, (out, err)
    document = json.loads(out)
    assert document["verdict"] == "cannot be told apart" and document["transits"] == len(times)
    if start:
        ((low, high),) = document["clock_at_release_s"]
        assert low <= start <= high < low + 0.1
    else:
        assert document["clock_at_release_s"] == []
    moved = times + start + np.where(np.arange(len(times)) == 7, 0.2, 0.0)
    path.write_text("t\n" + "".join(f"{t:.4f}\n" for t in moved))
    done = foucault("score", scene, "--transits", path, *GATE, *BOX)[0]
    assert done == (2 if start > 60 else 1)


def test_a_stopwatch_started_at_the_first_passage_is_a_clock(foucault, tmp_path, hall):
    scene, times = hall
    path = tmp_path / "passages.csv"
    path.write_text("t\n" + "".join(f"{t - times[0]:.4f}\n" for t in times))
    status, out, err = foucault("score", scene, "--transits", path, *GATE, *BOX, "--json")
    ((low, high),) = json.loads(out)["clock_at_release_s"]
    assert status == 0 and low <= -times[0] <= high, err


def test_passages_of_exact_inputs_disagree_by_another_clock_and_are_told_it(
    foucault, tmp_path, hall
):
    """A program's clock starts at the release: that all its times are late is an error, but it is said which."""
    scene, times = hall
    path = tmp_path / "passages.csv"
    path.write_text("t\n" + "".join(f"{t + 12.34:.9f}\n" for t in times[:10]))
    status, out, _ = foucault("score", scene, "--transits", path, *GATE, "--json")
    document = json.loads(out)
    assert status == 1 and document["verdict"] == "disagrees"
    assert any(low <= 12.34 <= high for low, high in document["clock_at_release_s"])
    path.write_text("t\n" + "".join(f"{t:.9f}\n" for t in times))
    status, out, _ = foucault("score", scene, "--transits", path, *GATE, "--json")
    assert status == 0 and json.loads(out)["clock_at_release_s"] == []
