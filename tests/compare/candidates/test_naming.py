"""What a user says of a file's columns, what a header says of them, and what their scales say against the scene."""

from __future__ import annotations

import io
import json
import time
from fractions import Fraction

import numpy as np
import pytest

from compare.candidates.names import LENGTHS, LONG_NAMES, TIMES, Naming, defaults, meaning, size_of
from compare.candidates.read import read, read_stream
from reference import InputError, load


def text(*lines):
    return io.BytesIO("\n".join([*lines, ""]).encode())


def said(found):
    return {one.id: one.text for one in found.conventions}


def test_a_header_in_other_words_is_read_and_said():
    found = read_stream(text("step;Time [ms];north;west [cm];energy", "1;500;0.4;-30;7"), "run")
    assert (found.t[0], found.columns["x"][0], found.columns["y"][0]) == (0.5, 0.3, 0.4)
    assert said(found) == {
        "columns": "Time [ms] as t, west [cm] as -x, north as y; not read: step, energy",
        "units": "t from ms, x from cm, converted to SI units",
    }


@pytest.mark.parametrize(
    ("header", "row"),
    [
        ("t,x,y", "1,1,1"),
        ("T,X,Y", "1,1,1"),
        ("# y t x z", "1,1,1,1"),
        ("t [s];x (m);y/m", "1;1;1"),
        ("t,x,y,E", "1,1,1,1"),
    ],
)
def test_what_is_plain_is_not_said(header, row):
    assert read_stream(text(header, row), "run").conventions == ()


@pytest.mark.parametrize(
    ("word", "column"),
    [("v", None), ("energy", None), ("x_error", None), ("x0", None), ("theta", None), ("dx", None), ("t_end", None),
     ("x_px", None), ("vxy", None), ("mean", None), ("n", None), ("ẏ", "vy"), ("y'", "vy"), ("dy/dt", "vy"),
     ("y(t)", "y")],
)  # fmt: skip
def test_names_that_mean_something_else_are_left_alone(word, column):
    found = meaning(word, {})
    assert (found and found.column) == column


def test_the_columns_own_name_wins_over_other_words_for_it():
    found = read_stream(text("X,x,pos_x,t,y,Y", "1,2,3,4,5,6"), "run")
    assert (found.columns["x"][0], found.columns["y"][0]) == (2, 5)


def test_lines_above_the_header_do_no_harm():
    lines = [
        "Foucault pendulum, version 1.2",
        "% l = 67 m",
        "",
        "# t y x",
        "# all in SI units",
        "0 0.4 0.3",
    ]
    found = read_stream(text(*lines), "run")
    assert (found.columns["x"][0], found.columns["y"][0]) == (0.3, 0.4)
    with pytest.raises(InputError, match="a row of numbers on an earlier line"):
        read_stream(text(*["nothing here"] * 1100), "run")


def test_the_nearest_header_counts():
    assert read_stream(text("# t x y", "# t y x", "0 1 2"), "run").columns["x"][0] == 2


@pytest.mark.parametrize(
    ("count", "names"), [(3, "t, x, y"), (4, "t, x, y, z"), (7, "t, x, y, z, vx, vy, vz")]
)
@pytest.mark.parametrize("separator", [",", ";", " ", "\t"])
def test_without_a_header_the_number_of_columns_tells(count, names, separator):
    found = read_stream(text(separator.join(map(str, range(count)))), "run")
    assert ["t", *found.columns] == names.split(", ")
    assert said(found) == {
        "no_header": f"no header: the columns are taken as {names} (--columns names others)"
    }


def test_columns_named_by_the_user(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("# anything\n7 0.4 30 1500\n")
    found = read(path, columns=["-", "y", "x (cm)", "t"], units=["ms"])
    assert (found.t[0], found.columns["x"][0], found.columns["y"][0]) == (1.5, 0.3, 0.4)
    assert "no_header" not in said(found)
    path.write_text("a,b,c\n0,1,2\n")
    # a header that says nothing is overruled
    assert read(path, columns=["t", "x", "y"]).columns["x"][0] == 1


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (["t", "x"], "a name for each of the 3 columns"),
        (["t", "x", "wind"], "got 'wind', expected names among t, x, y, z"),
        (["t", "x", "-"], "no y in t, x, -"),
        (["t", "x", "x"], "one column x"),
    ],
)
def test_what_is_wrong_with_the_users_names_is_said(tmp_path, columns, message):
    path = tmp_path / "a.txt"
    path.write_text("0 1 2\n")
    with pytest.raises(InputError, match=message) as caught:
        read(path, columns=columns)
    assert caught.value.field == "--columns"


def test_names_of_arrays_are_not_given_twice():
    stream = io.BytesIO()
    np.savez(stream, t=[0.0], x=[1.0], y=[2.0])
    stream.seek(0)
    with pytest.raises(InputError, match="arrays with names"):
        read_stream(stream, "run", naming=Naming(("t", "x", "y")))


def test_units_of_the_user_hold_where_the_header_names_none():
    assert defaults(("ms", "cm")) == {
        "t": "ms",
        **dict.fromkeys("xyz", "cm"),
        **dict.fromkeys(("vx", "vy", "vz"), "cm/s"),
    }
    found = read_stream(
        text("t,x,y,vx", "2000,30,40,5"), "run", naming=Naming((), ("milliseconds", "cm"))
    )
    assert (found.t[0], found.columns["x"][0], found.columns["vx"][0]) == (2.0, 0.3, 0.05)
    with pytest.raises(InputError, match="expected min, the unit of t in the header"):
        read_stream(text("t (min),x,y", "2,30,40"), "run", naming=Naming((), ("ms",)))


def test_digits_beyond_a_double_survive_a_unit():
    found = read_stream(text("t,x (cm),y", "0,30.000000000000000000000012345,0.4"), "run")
    assert found.extended
    assert found.columns["x"][0] == 0.3
    exact = Fraction("0.30000000000000000000000012345") - Fraction(0.3)
    assert found.low["x"][0] == pytest.approx(float(exact), rel=1e-12)


def test_a_word_longer_than_any_name_is_none():
    assert meaning("x" + " " * 90 + "(m)", {}).column == "x"
    assert meaning("x" + " " * 100 + "(m)", {}) is None


@pytest.mark.parametrize("piece", ["( ", "[", " ", "a in ", "_per_", "/", "- "])
def test_a_line_takes_no_longer_than_its_length_tells(piece):
    """Four times the length takes four times as long; of a pattern that backtracks it would be sixteen times."""

    def cost(length):
        line = f"a{piece * (length // len(piece))}b\n".encode()
        taken = []
        for _ in range(3):
            before = time.process_time()
            with pytest.raises(InputError):
                read_stream(io.BytesIO(line), "a line")
            taken.append(time.process_time() - before)
        return min(taken)

    assert cost(16_000) < 10 * max(cost(4_000), 0.01)


def test_every_unit_has_a_long_name_for_messages():
    assert {*TIMES, *LENGTHS} - {"s", "m"} == {*LONG_NAMES}


def test_units_of_speed():
    assert size_of("km/h", "vx") * 36 == 10
    assert all(
        size_of(word, "vx") == 1
        for word in ("m/s", "mps", "m_s", "m s^-1", "m·s⁻¹", "ms", "m per s")
    )
    assert (
        size_of("m", "vx") is None and size_of("s", "x") is None and size_of("furlong", "x") is None
    )


def score(foucault, tmp_path, scale, *words, times=1.0, name="mine.csv"):
    golden = load("paris.binary64")
    rows = np.column_stack([golden.t * times, golden.x * scale, golden.y * scale])[:31].tolist()
    (tmp_path / name).write_text("t,x,y\n" + "".join(f"{t!r},{x!r},{y!r}\n" for t, x, y in rows))
    return foucault("score", "paris", tmp_path / name, "--no-diagnosis", *words)


@pytest.mark.parametrize(
    ("scale", "words", "id_"),
    [
        (1000.0, "they are millimetres; --units mm reads them so", "scale"),
        (150.0, "are 150 pixels, or", "scale"),
    ],
)
def test_positions_beyond_the_cord_are_said_to_be_in_another_unit(
    foucault, tmp_path, scale, words, id_
):
    status, out, _ = score(foucault, tmp_path, scale, "--json")
    (convention,) = json.loads(out)["conventions"]
    assert status == 1
    assert convention["id"] == id_ and words in convention["text"]
    if scale == 1000:
        assert score(foucault, tmp_path, scale, "--units", "mm")[0] == 0


def test_pixels_with_another_origin_are_not_given_a_scale(foucault, tmp_path):
    (tmp_path / "px.csv").write_text("t,x,y\n0,320,240\n1,330,250\n")
    status, out, _ = foucault("score", "paris", tmp_path / "px.csv", "--no-diagnosis", "--json")
    (convention,) = json.loads(out)["conventions"]
    assert status == 1
    assert (
        convention["id"] == "beyond_the_cord"
        and "pixels, another unit, or another pendulum?" in convention["text"]
    )


@pytest.mark.parametrize(
    ("times", "said"),
    [
        (1e3, "They look like milliseconds: --units ms reads them so, and they end at 1800 s."),
        (1e6, "They look like microseconds: --units us"),
        (
            50.0,
            "--t-end 86400 leaves out later rows, --set run.t_end=90000 makes the scene longer.",
        ),
    ],
)
def test_times_beyond_the_end_are_told_what_they_may_be(foucault, tmp_path, times, said):
    status, out, err = score(foucault, tmp_path, 1.0, times=times)
    assert (status, out) == (2, "")
    assert said in err
    if times == 1e3:
        assert score(foucault, tmp_path, 1.0, "--units", "ms", times=times)[0] == 0
