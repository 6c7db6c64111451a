"""A report's folder: each file is whole, whatever happens, and nobody else's files are touched."""

from __future__ import annotations

import csv
import io
import json
import math
import os
from pathlib import Path

import pytest

from compare.report.folder import check_folder, json_text, write_files
from compare.report.page import PageTable, page
from reference import InputError
from reference.system.checksums import check_sums

FILES = {"rows.csv": "new", "rows.json": "new", "index.html": page("new", [])}
OLD = {"rows.csv": "old", "rows.json": "old", "index.html": page("old", [])}


def contents(folder: Path) -> dict[str, str]:
    """Return what is in a folder but for the checksums, which follow from it."""
    return {path.name: path.read_text() for path in folder.iterdir() if path.name != "SHA256SUMS"}


def test_a_folder_is_made_and_one_that_an_earlier_run_made_is_renewed(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "page"
    write_files(out, OLD)
    write_files(out, FILES)
    assert contents(out) == FILES
    assert [path.name for path in out.parent.iterdir()] == ["page"]


def test_what_else_is_in_the_folder_stays(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("ten years of work")
    write_files(tmp_path, FILES)
    assert contents(tmp_path) == {**FILES, "thesis.tex": "ten years of work"}


@pytest.mark.parametrize("name", ["rows.csv", "index.html"])
def test_a_file_of_somebody_elses_is_not_replaced(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("ten years of work")
    for refused in (write_files, check_folder):
        with pytest.raises(
            InputError,
            match=f"--out: got .*, expected a new folder.* It contains a {name} that no run wrote",
        ):
            refused(tmp_path, FILES)
    assert contents(tmp_path) == {name: "ten years of work"}


def test_a_folder_with_a_page_of_ours_may_be_written_again_whatever_was_added(
    tmp_path: Path,
) -> None:
    write_files(tmp_path, {"index.html": OLD["index.html"]})
    (tmp_path / "rows.csv").write_text("an earlier version's")
    write_files(tmp_path, FILES)
    assert contents(tmp_path) == FILES


@pytest.mark.parametrize("failing", [1, 2, 3])
@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt()])
@pytest.mark.parametrize("before", [{}, OLD])
def test_what_ends_between_two_files_leaves_each_whole_and_the_next_run_goes_on(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    failing: int,
    error: BaseException,
    before: dict[str, str],
) -> None:
    if before:
        write_files(tmp_path, before)
    replaced, left = os.replace, list(range(failing))

    def fails_once(source: Path, target: Path) -> None:
        left.pop()
        if not left:
            raise error
        replaced(source, target)

    with monkeypatch.context() as patch:
        patch.setattr("os.replace", fails_once)
        with pytest.raises(
            InputError if isinstance(error, OSError) else KeyboardInterrupt,
            match=r"No space left|^$",
        ):
            write_files(tmp_path, FILES)
    for name, text in contents(tmp_path).items():
        assert text in (FILES[name], before.get(name))
    write_files(tmp_path, FILES)
    assert contents(tmp_path) == FILES
    assert check_sums(tmp_path) == []


def test_a_folder_in_the_place_of_a_file_is_a_message_and_nothing_is_written(
    tmp_path: Path,
) -> None:
    (tmp_path / "index.html").mkdir()
    with pytest.raises(InputError, match="--out"):
        write_files(tmp_path, FILES)
    assert [path.name for path in tmp_path.iterdir()] == ["index.html"]


@pytest.mark.parametrize("place", ["/proc/x", "/proc/x/y/z", "/dev/null/x"])
def test_a_folder_that_cannot_be_written_is_refused_before_the_work(place: str) -> None:
    with pytest.raises(
        InputError, match=f"--out: got '{place}', expected a folder that can be written to"
    ):
        check_folder(Path(place), FILES)


def test_checking_a_folder_makes_none(tmp_path: Path) -> None:
    check_folder(tmp_path / "deep" / "page", FILES)
    assert contents(tmp_path) == {}


def test_csv_has_one_header_line_all_digits_unix_line_ends_and_nothing_for_none() -> None:
    text = PageTable.of_records(
        ["a", "b"], [{"a": 0.1 + 0.2, "b": None}, {"a": "x,\ny", "b": 1}]
    ).csv()
    assert text.startswith("a,b\n0.30000000000000004,\n")
    assert "\r" not in text
    assert list(csv.reader(io.StringIO(text)))[2] == ["x,\ny", "1"]


def test_numbers_that_are_none_become_null_in_json() -> None:
    text = json_text({"rows": [(math.nan, 1.5), {"deep": -math.inf}], "word": "φ"})
    assert json.loads(text) == {"rows": [[None, 1.5], {"deep": None}], "word": "φ"}
    assert "φ" in text


@pytest.mark.parametrize("text", ["=1+1", "+cmd", "-x", "@SUM(A1)", "\t=1", "\n=1", "-1e", "+-1"])
def test_a_spreadsheet_runs_no_text_of_ours(text):
    assert next(
        csv.reader(io.StringIO(PageTable({"name": ""}, [[text]]).csv().partition("\n")[2]))
    ) == [f"'{text}"]


def test_other_text_stays_as_it_is_in_csv_and_a_carriage_return_begins_no_new_row():
    rows = [[-1.5, "-1.5e-3", "+2", "rk4", None, "external: ./a -x =b"], ["b\rc\x1b", *[None] * 5]]
    lines = PageTable(dict.fromkeys("abcdef", ""), rows).csv().splitlines()
    assert lines[1:] == ["-1.5,-1.5e-3,+2,rk4,,external: ./a -x =b", "b\\rc\\x1b,,,,,"]


def test_names_that_are_no_utf_8_are_written_as_escapes(tmp_path):
    name = os.fsdecode(b"n\xff")
    write_files(
        tmp_path / "out", {"rows.json": json_text({"name": name}), "index.html": page(name, [])}
    )
    assert json.loads((tmp_path / "out/rows.json").read_text("utf-8")) == {"name": name}
    assert r"n\udcff" in (tmp_path / "out/index.html").read_text("utf-8")
