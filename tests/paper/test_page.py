"""The page and its files: complete, self-contained, written whole or not at all."""

from __future__ import annotations

import base64
import csv
import json
import os
import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from compare.paper import figures, page
from compare.paper.captions import CAPTIONS
from compare.paper.judge import Row
from reference import InputError

Built = tuple[Path, list[Row]]
ROW = Row("a_b", "Mathar II (1)", "x < y & z", "1.5", "misprint", correction="x > y", remark="both")
FILES = {"index.html": "new", "rows.csv": "new", "rows.json": "new"}


def test_the_folder_holds_the_page_the_figures_and_the_rows(built: Built) -> None:
    numbers = [1, 3, 4, 5, 6, 7, 8, 9]
    assert [caption.number for caption in CAPTIONS] == numbers
    expected = {"index.html", "rows.csv", "rows.json", *(f"figure_{n}.svg" for n in numbers)}
    assert {path.name for path in built[0].iterdir()} == expected


def test_json_and_csv_hold_the_same_rows(built: Built) -> None:
    folder, rows = built
    as_json = json.loads((folder / "rows.json").read_text(encoding="utf-8"))["rows"]
    with (folder / "rows.csv").open(encoding="utf-8", newline="") as handle:
        as_csv = list(csv.DictReader(handle))
    assert as_json == as_csv == [page.document(row) for row in rows]
    assert {"id", "place", "printed", "recomputed", "verdict"} <= set(as_json[0])


def test_the_page_needs_nothing_from_outside_and_shows_each_figure_beside_its_caption(built: Built) -> None:
    text = (built[0] / "index.html").read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)=["'](?!data:|#)""", text)
    assert "http" not in re.sub(r"base64,[^']*", "", text)
    for caption in CAPTIONS:
        drawn = re.search(rf"id='figure-{caption.number}'><img [^>]*base64,([^']*)'", text)
        assert drawn is not None
        assert base64.b64decode(drawn[1]).decode() == (built[0] / f"figure_{caption.number}.svg").read_text("utf-8")
    for row in built[1]:
        assert f"id='{row.id}'" in text


def test_every_figure_is_well_formed_svg_with_text_and_lines_and_no_date(built: Built) -> None:
    for caption in CAPTIONS:
        text = (built[0] / f"figure_{caption.number}.svg").read_text(encoding="utf-8")
        root = ET.fromstring(text)
        words = [node.text for node in root.iter("{http://www.w3.org/2000/svg}text")]
        assert len(words) > 5, caption.number
        assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) > 5
        assert "<dc:date>" not in text


def test_the_same_figure_has_the_same_bytes(built: Built) -> None:
    assert figures.svg(1) == (built[0] / "figure_1.svg").read_text(encoding="utf-8")


def test_what_stands_in_a_row_cannot_break_the_page() -> None:
    text = page.as_html([replace(ROW, printed="<script>alert(1)</script>")], dict.fromkeys(range(10), "<svg/>"))
    assert "<script>alert" not in text
    assert "&lt;script&gt;alert" in text


def test_a_folder_that_an_earlier_run_made_is_replaced(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "page"
    page.write(out, dict.fromkeys(FILES, "old"))
    page.write(out, FILES)
    assert {path.name: path.read_text() for path in out.iterdir()} == FILES
    assert [path.name for path in out.parent.iterdir()] == ["page"]


def test_a_folder_with_anything_else_in_it_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("ten years of work")
    with pytest.raises(InputError, match="a new folder"):
        page.write(tmp_path, FILES)
    assert (tmp_path / "thesis.tex").read_text() == "ten years of work"


def test_an_interrupted_write_leaves_the_old_page_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "page"
    page.write(out, dict.fromkeys(FILES, "old"))
    renamed = os.replace
    calls: list[Sequence[object]] = []

    def second_fails(*paths: str) -> None:
        calls.append(paths)
        if len(calls) == 2:
            raise OSError(28, "No space left on device")
        renamed(*paths)

    monkeypatch.setattr(page.os, "replace", second_fails)
    with pytest.raises(InputError, match="No space left"):
        page.write(out, FILES)
    assert {path.read_text() for path in out.iterdir()} == {"old"}
    assert [path.name for path in tmp_path.iterdir()] == ["page"]


def test_without_matplotlib_the_extra_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import builtins

    imported = builtins.__import__

    def refusing(name: str, *rest: object, **more: object) -> object:
        if name == "matplotlib":
            raise ImportError(name)
        return imported(name, *rest, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(builtins, "__import__", refusing)
    with pytest.raises(InputError, match=r"foucault-reference\[plot\]"):
        figures.svg(1)
