"""The page and its files: complete, and self-contained; and the numbers behind its figures."""

from __future__ import annotations

import base64
import csv
import json
import re
import sys
import xml.etree.ElementTree as ET
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from compare.papers import figures, papers_page, points
from compare.papers.checks import VERDICTS, JudgedRow
from compare.papers.figures import FIGURES
from reference import InputError, load

Built = tuple[Path, list[JudgedRow]]
ROW = JudgedRow("a_b", "Mathar II (1)", "x < y & z", "1.5", "misprint", correction="x > y", remark="both")


def test_the_folder_holds_the_page_the_figures_and_the_rows(built: Built) -> None:
    numbers = list(FIGURES)
    assert numbers == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    expected = {"SHA256SUMS", "index.html", "rows.csv", "rows.json", *(f"figure_{n}.svg" for n in numbers)}
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
    for name in ("matplotlib", "matplotlib.figure"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(InputError, match=r"foucault-reference\[plot\]"):
        figures.svg(1)


# the numbers behind the figures: here, so that what the page has computed is not computed again -------------------
def test_a_window_shows_the_golden_states() -> None:
    golden = load("paris")
    times, states = points.window(12000, 1)
    row = list(golden.t).index(12000.0)
    assert times[0] == 12000.0
    assert states[0, :2] == pytest.approx([golden.x[row], golden.y[row]], abs=1e-13)


@pytest.mark.usefixtures("few_runs")
def test_frequencies_are_lowest_at_the_equator_and_follow_the_estimate_within_a_nanohertz() -> None:
    frequencies = points.frequencies()
    assert min(frequencies, key=lambda latitude: frequencies[latitude]) == 0
    for latitude, hertz in frequencies.items():
        assert abs(hertz - figures.estimate_at(latitude)) < 2e-9
    assert frequencies[48.846111] == pytest.approx(0.0608436335, abs=1e-10)


def test_a_higher_order_is_nearer_to_the_truth_after_12000_s() -> None:
    pytest.importorskip("numba")
    _, truth = points.window(12000, 20, step=0.5)
    states = figures.orders_at(12000, 20, 0.5)
    worst = [float(np.abs(states[name][:, :3] - truth[:, :3]).max()) for name in ("rk4", "rkng56", "rkng67")]
    assert worst[0] > 100 * worst[1] > 1e4 * worst[2] / 100
