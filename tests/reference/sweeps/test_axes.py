"""What a sweep varies: exact values, and errors before any work."""

from __future__ import annotations

import os
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from reference import InputError
from reference.sweeps.axes import MAX_VALUES, axis, combinations, rows_of_file, varied_names


def texts(word: str) -> list[str]:
    return list(axis(word, "decimal").values)


def test_steps_are_exact_decimals_with_both_ends_in():
    assert len(texts("site.latitude=-90:90:1")) == 181
    assert texts("site.latitude=0:1:0.3") == ["0", "0.3", "0.6", "0.9"]
    assert texts("site.latitude=1:0:-0.25") == ["1", "0.75", "0.5", "0.25", "0"]
    assert texts("site.latitude=-0.1:0.1:1e-1") == ["-0.1", "0", "0.1"]
    assert texts("pendulum.length=100:300:100") == ["100", "200", "300"]


@pytest.mark.parametrize(
    "word",
    [
        "site.latitude=-90:90:0.7",
        "release.x=0.1:0.3:0.000001",
        "site.gravity=9.8:9.8000000000000000000001:1e-25",
    ],
)
def test_numbers_are_the_nearest_sums_of_two_doubles(word):
    made = combinations([word], "decimal")
    rows = np.linspace(0, made.count - 1, 50).astype(np.int64)
    (numbers,) = made.numbers(rows, "decimal").values()
    for row, high, low in zip(rows.tolist(), numbers.high, numbers.low, strict=True):
        (text,) = made.texts(row).values()
        exact = Fraction(text)
        assert high == float(exact)
        assert low == float(exact - Fraction(high))
    (doubles,) = made.numbers(rows, "binary64").values()
    assert doubles.high.tolist() == numbers.high.tolist()
    assert (doubles.low == 0).all()


def test_the_rows_of_a_grid_are_all_combinations_the_last_field_fastest():
    made = combinations(["site.latitude=-90:90:0.01", "release.x=0.1,0.2,0.3"], "decimal")
    assert (made.shape, made.count) == ((18_001, 3), 18_001 * 3)
    assert made.texts(0) == {"site.latitude": "-90", "release.x": "0.1"}
    assert made.texts(made.count - 1) == {"site.latitude": "90", "release.x": "0.3"}
    assert made.texts(4) == {"site.latitude": "-89.99", "release.x": "0.2"}
    numbers = made.numbers([2, 3], "decimal")
    assert numbers["release.x"].high.tolist() == [0.3, 0.1]


def test_more_rows_than_can_be_counted_on_are_refused():
    with pytest.raises(InputError, match=r"got 1002001000 rows, expected at most 100,000,000 rows"):
        combinations(
            ["site.latitude=0:1:0.001", "release.x=0:1:0.001", "release.y=0:0.999:0.001"], "decimal"
        )
    with pytest.raises(InputError, match=r"at most 10,000,000 values"):
        axis("site.altitude=0:1:1e-7", "decimal")


@pytest.mark.parametrize(
    ("word", "field", "got"),
    [
        ("site.latitude=0:91:1", "site.latitude", "91"),
        ("site.latitude=-91:0:1", "site.latitude", "-91"),
        ("site.lattitude=0:1:1", "--over", "site.lattitude"),
        ("site.latitude", "--over", "site.latitude"),
        ("site.latitude=", "--over", "site.latitude="),
        ("site.latitude=0:1", "--over", "site.latitude=0:1"),
        ("site.latitude=0:1:0", "--over", "site.latitude=0:1:0"),
        ("site.latitude=0:1:-1", "--over", "site.latitude=0:1:-1"),
        ("site.latitude=0:one:1", "--over", "site.latitude=one"),
        ("site.latitude=1,2,1", "--over", "site.latitude=1,2,1"),
        ("site.latitude=1,,2", "site.latitude", ""),
        ("site.latitude=nan,2", "site.latitude", "nan"),
        ("site.gravity_is=effective,none", "site.gravity_is", "none"),
        ("pendulum.length=0:5:1", "pendulum.length", "0"),
        ("run.digits=1,2", "--over", "run.digits"),
        ("site.altitude=0:1:1e-13", "--over", "site.altitude=0:1:1e-13"),
        ("site.latitude=@/no/such/file.csv", "--over", "/no/such/file.csv"),
    ],
)
def test_a_wrong_axis_is_named(word, field, got):
    with pytest.raises(InputError) as error:
        axis(word, "decimal")
    assert (error.value.field, error.value.got) == (field, got)


@pytest.mark.parametrize(
    ("reading", "word"),
    [
        ("decimal", "site.latitude=1,1.0"),
        ("decimal", "site.latitude=0.5,50e-2"),
        ("decimal", "site.latitude=-0,0"),
        ("decimal", "site.gravity_is=effective,effective"),
        ("binary64", "site.latitude=0.1,0.1000000000000000000001"),
    ],
)
def test_the_same_value_written_twice_is_refused(reading, word):
    with pytest.raises(InputError, match="each value once"):
        axis(word, reading)


def test_decimals_next_to_each_other_are_different_values():
    values = texts("site.latitude=0.1,0.1000000000000000000001")
    assert values == ["0.1", "0.1000000000000000000001"]


def test_a_field_is_varied_once():
    with pytest.raises(InputError, match="each field at most once"):
        combinations(["site.latitude=1,2", "site.latitude=3"], "decimal")


def test_values_come_from_a_file(tmp_path):
    (tmp_path / "a.csv").write_text("site.latitude,other\n1,5\n2.5,6\n")
    assert texts(f"site.latitude=@{tmp_path / 'a.csv'}") == ["1", "2.5"]
    (tmp_path / "b.csv").write_text("3\n4\n")
    assert texts(f"site.latitude=@{tmp_path / 'b.csv'}") == ["3", "4"]
    with pytest.raises(InputError, match=r"a column release\.x"):
        axis(f"release.x=@{tmp_path / 'a.csv'}", "decimal")


@pytest.mark.parametrize("option", ["--rows", "--over"])
def test_only_regular_files_hold_values(tmp_path, option):
    def read(path):
        return (
            rows_of_file(Path(path))
            if option == "--rows"
            else axis(f"site.latitude=@{path}", "decimal")
        )

    for name in ("pipe.csv", "pipe.parquet"):
        os.mkfifo(tmp_path / name)
    for path in (tmp_path / "pipe.csv", tmp_path / "pipe.parquet", "/dev/zero"):
        with pytest.raises(InputError, match="a regular file"):
            read(path)
    for path in (tmp_path, tmp_path / "none.csv"):
        with pytest.raises(InputError, match=r"a readable file|a regular file"):
            read(path)


@pytest.mark.parametrize(
    ("name", "count", "said"),
    [
        ("site.latitude", MAX_VALUES + 1, "at most 10,000,000"),
        ("nothing", 1, "a field that a sweep can vary"),
    ],
)
def test_rows_of_parquet_are_counted_before_they_are_read(tmp_path, name, count, said):
    """What stands before the footer is damaged: it is not looked at."""
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "rows.parquet"
    pq.write_table(pa.table({name: pa.nulls(count)}), path)
    data = path.read_bytes()
    footer = 8 + int.from_bytes(data[-8:-4], "little")
    path.write_bytes(data[:4] + bytes(len(data) - 4 - footer) + data[-footer:])
    with pytest.raises(InputError, match=said):
        rows_of_file(path)


@pytest.mark.long  # a gigabyte of memory
def test_more_lines_than_may_be_held_are_refused(tmp_path):
    path = tmp_path / "rows.csv"
    path.write_text("site.latitude\n" + "1\n" * (MAX_VALUES + 1))
    with pytest.raises(InputError, match="1 to 10,000,000 rows"):
        rows_of_file(path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "1 to 10,000,000 rows"),
        ("site.latitude\n", "rows below it"),
        ("lat\n1\n", "a field that a sweep can vary"),
        ("site.latitude,site.latitude\n1,2\n", "each field in at most one column"),
        ("site.latitude,release.x\n1\n", "1 value in line 2"),
    ],
)
def test_a_wrong_file_of_rows_is_named(tmp_path, text, said):
    (tmp_path / "rows.csv").write_text(text)
    with pytest.raises(InputError, match=said):
        rows_of_file(tmp_path / "rows.csv")


def test_a_line_of_a_wrong_length_is_named_by_its_number_in_the_file(tmp_path):
    path = tmp_path / "rows.csv"
    path.write_text("\nsite.latitude,release.x\n\n1,2\n\n3\n")
    with pytest.raises(InputError, match=r"1 value in line 6 of .*rows\.csv"):
        rows_of_file(path)


def test_what_is_wrong_with_rows_is_found_for_each_of_them(tmp_path):
    path = tmp_path / "rows.csv"
    path.write_text("site.latitude\n1\n91\n95\n")
    wrong = rows_of_file(path).wrong(range(3), "decimal")
    assert list(wrong) == [1, 2]
    assert "91" in wrong[1]


def test_rows_of_parquet_are_exactly_the_doubles_that_they_hold(tmp_path):
    pa = pytest.importorskip("pyarrow")
    import pyarrow.parquet as pq

    pq.write_table(
        pa.table({"release.x": [0.1, 0.25], "release.y": ["0.1", "0.3"]}), tmp_path / "rows.parquet"
    )
    table = rows_of_file(tmp_path / "rows.parquet")
    assert Fraction(table.texts(0)["release.x"]) == Fraction(0.1)
    assert table.texts(1) == {"release.x": "0.25", "release.y": "0.3"}
    (tmp_path / "bad.parquet").write_text("nothing")
    with pytest.raises(InputError, match="a readable file"):
        rows_of_file(tmp_path / "bad.parquet")


def test_every_number_of_a_scene_can_be_varied():
    assert {
        "pendulum.length",
        "site.inverse_flattening",
        "release.azimuth_rate",
        "run.t_end",
    } <= set(varied_names())


@pytest.mark.parametrize(
    "text",
    [
        "site.latitude;release.x\n48.85;0.3\n-10;1\n",
        "site.latitude;release.x\n48,85;0,3\n-10;1\n",
        "\ufeffsite.latitude\trelease.x\r\n48.85\t0.3\r\n-10\t1\r\n",
        ",site.latitude,release.x\n0,48.85,0.3\n1,-10,1\n",
        ";site.latitude;release.x\n0;48,85;0,3\n1;-10;1\n;;\n",
    ],
)
def test_rows_are_read_as_spreadsheets_and_data_frames_write_them(tmp_path, text):
    path = tmp_path / "rows.csv"
    path.write_text(text, encoding="utf-8", newline="")
    assert rows_of_file(path).values == {
        "site.latitude": ("48.85", "-10"),
        "release.x": ("0.3", "1"),
    }


def test_a_comma_before_three_digits_is_not_guessed_at(tmp_path):
    path = tmp_path / "rows.csv"
    path.write_text("site.latitude;site.altitude\n48,85;1,250\n")
    with pytest.raises(InputError, match=r"got '1,250', expected a point.*thousands"):
        rows_of_file(path)
