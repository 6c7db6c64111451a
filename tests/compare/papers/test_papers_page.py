"""The page and its files: complete, and self-contained."""

from __future__ import annotations

import base64
import csv
import json
import re
import sys
import xml.etree.ElementTree as ET
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from compare.papers import figures, papers_page
from compare.papers.checks import VERDICTS, JudgedRow
from compare.papers.figures import FIGURES
from reference import InputError

Built = tuple[Path, list[JudgedRow]]
ROW = JudgedRow("a_b", "Mathar II (1)", "x < y & z", "1.5", "misprint", correction="x > y", remark="both")


def test_the_folder_holds_the_page_the_figures_and_the_rows(built: Built) -> None:
    numbers = list(FIGURES)
    assert numbers == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    expected = {"index.html", "rows.csv", "rows.json", *(f"figure_{n}.svg" for n in numbers)}
    assert {path.name for path in built[0].iterdir()} == expected


def test_json_and_csv_hold_the_same_rows(built: Built) -> None:
    folder, rows = built
    as_json = json.loads((folder / "rows.json").read_text(encoding="utf-8"))["rows"]
    with (folder / "rows.csv").open(encoding="utf-8", newline="") as handle:
        as_csv = list(csv.DictReader(handle))
    for row in as_csv:  # what a spreadsheet would run begins with an apostrophe there
        row.update({key: cell[1:] if cell[:1] == "'" and cell[1:2] in "=+-@" else cell for key, cell in row.items()})
    assert as_json == as_csv == [asdict(row) for row in rows]
    assert {"id", "place", "printed", "recomputed", "verdict"} <= set(as_json[0])


def test_the_page_needs_nothing_from_outside_and_shows_each_figure_beside_its_caption(built: Built) -> None:
    text = (built[0] / "index.html").read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)=["'](?!data:|#)""", text)
    assert "http" not in re.sub(r'base64,[^"]*', "", text)
    for number in FIGURES:
        drawn = re.search(rf'id="figure-{number}" class="plate">\n<img [^>]*base64,([^"]*)"', text)
        assert drawn is not None
        assert base64.b64decode(drawn[1]).decode() == (built[0] / f"figure_{number}.svg").read_text("utf-8")
    for row in built[1]:
        assert f'id="{row.id}"' in text


def test_a_box_hides_the_lines_of_its_verdict(built: Built) -> None:
    text = (built[0] / "index.html").read_text(encoding="utf-8")
    for verdict in VERDICTS:
        count = sum(row.verdict == verdict for row in built[1])
        assert count
        assert f'<input type="checkbox" id="show-{verdict}" checked> {verdict} ({count})' in text
        assert f"body:has(#show-{verdict}:not(:checked)) .whole tr.{verdict}" in text
        assert text.count(f'<tr class="{verdict}" id=') == count


def test_every_figure_is_well_formed_svg_with_text_and_lines_and_no_date(built: Built) -> None:
    for number in FIGURES:
        text = (built[0] / f"figure_{number}.svg").read_text(encoding="utf-8")
        root = ET.fromstring(text)
        words = [node.text for node in root.iter("{http://www.w3.org/2000/svg}text")]
        assert len(words) > 5, number
        assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) >= 4  # a triangle and a rod
        assert "<dc:date>" not in text


def test_letters_are_as_large_as_a_telephone_needs_them(built: Built) -> None:
    for number in FIGURES:
        text = (built[0] / f"figure_{number}.svg").read_text(encoding="utf-8")
        width = float(re.search(r'<svg [^>]*?width="([\d.]+)pt"', text)[1])  # type: ignore[index]
        sizes = [float(size) for size in re.findall(r"font(?:-size)?: ([\d.]+)px", text)]
        assert sizes
        assert min(sizes) * 350 / width > 8, number  # the page leaves 350 of 390 pixels to a figure


def test_the_same_figure_has_the_same_bytes(built: Built) -> None:
    assert figures.svg(1) == (built[0] / "figure_1.svg").read_text(encoding="utf-8")


def test_what_stands_in_a_row_cannot_break_the_page() -> None:
    text = papers_page.page_text(
        [replace(ROW, printed="<script>alert(1)</script>")], dict.fromkeys(range(10), "<svg/>")
    )
    assert "<script>alert" not in text
    assert "&lt;script&gt;alert" in text


def test_without_matplotlib_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(InputError, match=r"foucault-reference\[plot\]"):
        figures.svg(1)
