"""The three source papers, judged and shown: each verdict, the page and its files, the numbers behind its figures."""

from __future__ import annotations

import base64
import csv
import json
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from places import ROOT

from compare import papers
from compare.papers import declared, figures, papers_page, points
from compare.papers.checks import VERDICTS, JudgedRow
from compare.papers.figures import FIGURES
from reference import InputError, load, solve, write
from reference.scenes.shipped import golden_root

Built = tuple[Path, list[JudgedRow]]
ROW = JudgedRow(
    "a_b", "Mathar II (1)", "x < y & z", "1.5", "misprint", correction="x > y", remark="both"
)

HERE = os.environ | {"PYTHONPATH": str(ROOT)}

# found by deriving the equations symbolically from the kinetic energy, before this code was written
KNOWN_MISPRINTS = {
    "mathar_6_text": "exactly",
    "mathar_32_text": "z⁴",
    "mathar_40_text": "velocities",
    "mathar_44_text": "β_x2",
    "mathar_45": "is y",
    "mathar_51": "dot on",
    "mathar_vii_slow": "2K/π",
    "mathar_viii_steps": "not implemented",
    "mathar_fig5_start": "-66.998",
    "mathar_vii_rest_y": "-0.115205",
    "mathar_vii_amplitude": "0.008898350",
    "mathar_a_prolate": "oblate",
    "mathar_a_flattening": "298.257223563",
    "gastebois_4_2_ga": "Ω⁴",
    "gastebois_5_newton": "m a",
    "gastebois_6_1_part": "réelle",
    "gastebois_6_1_vx": "cos",
    "gastebois_6_3_sense": "counter-clockwise",
    "gastebois_6_3_speed": "+r0",
    "gastebois_6_3_tf": "T_p",
    "gastebois_6_3_rate": "-Ω_z",
    "gastebois_7_1_newton": "m a",
    "gastebois_7_2_general": "dq'",
    "gastebois_7_2_fx": "cosφ",
    "gastebois_7_2_fy": "sinφ",
    "gastebois_7_2_fz": "sinφ",
    "gastebois_7_3_y": "+",
    "methods_2_centrifugal": "+m",
    "methods_2_force": "ω_p × x'",
}
# found by this code
FURTHER_MISPRINTS = {
    "mathar_4_text": "longitude",
    "mathar_a_order_5": "5",
    "mathar_a_order_6": "6",
    "gastebois_2_day": "23.93",
    "gastebois_6_3_apparent": "31.73",
}
ENDS_BEFORE = {  # zeros, exact decimals, and what is known from a double run only
    "mathar": "4_text 6_text 12 27_l 39_bias 44_text 46_root vii_l vii_lat a_g a_omega a_flattening a_radius "
    "a_stages_4 a_stages_5 a_stages_6 a_order_5 a_order_6 viii_steps a_two vi_1_size fig4 fig7_ahead a_parabola",
    "gastebois": "7_1_newton 2_radius 2_rate 4_1_equator",
    "methods": "away 1_rate 3_w end_frame",
}
EXACT_IN_MATHAR = [1, 2, 3, *range(7, 15), 16, 17, 18, 19, 20, 21, 22, 24, 26, 27, 28, 29, 30]
EXACT_IN_MATHAR += [32, 33, 34, 35, 36, 38, 39, 40, 41, 42, 43, 44, "47_2", "47_4", "47_6", 49, 52]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """Every row judged, and the page with every figure."""
    pytest.importorskip("matplotlib")
    pytest.importorskip("numba")
    folder = tmp_path_factory.mktemp("paper") / "page"
    return folder, papers.build(folder)


@pytest.fixture(scope="module")
def judged(built: Built) -> dict[str, JudgedRow]:
    return {row.id: row for row in built[1]}


def test_there_is_a_row_for_more_than_a_hundred_lines_of_all_three_papers(
    judged: dict[str, JudgedRow],
) -> None:
    assert len(judged) >= 250
    for paper in ("mathar_", "gastebois_", "methods_"):
        assert sum(word.startswith(paper) for word in judged) >= 30


def test_ids_are_unique_words(judged: dict[str, JudgedRow]) -> None:
    assert len(judged) == len(declared())
    assert all(re.fullmatch(r"[a-z][a-z0-9_]*", word) for word in judged)


def test_the_misprints_are_these_and_each_correction_says_what_is_right(
    judged: dict[str, JudgedRow],
) -> None:
    known = KNOWN_MISPRINTS | FURTHER_MISPRINTS
    corrections = {
        word: row.correction for word, row in judged.items() if row.verdict == "misprint"
    }
    assert set(corrections) == set(known)
    assert {
        word: corrections[word] for word, part in known.items() if part not in corrections[word]
    } == {}


def test_the_paper_s_numbered_equations_and_each_power_of_47_are_exact_as_printed(
    judged: dict[str, JudgedRow],
) -> None:
    verdicts = {number: judged[f"mathar_{number}"].verdict for number in EXACT_IN_MATHAR}
    assert verdicts == dict.fromkeys(EXACT_IN_MATHAR, "exact")


def test_every_row_says_what_its_verdict_asks_for(judged: dict[str, JudgedRow]) -> None:
    for row in judged.values():
        assert row.verdict in VERDICTS
        assert row.place
        assert row.printed
        assert row.recomputed
        assert bool(row.error) == (row.verdict == "approximation"), row.id
        assert bool(row.correction) == (row.verdict == "misprint"), row.id


def digits_of(row: JudgedRow) -> int:
    """Significant digits of the longest number."""
    numbers = re.findall(r"\d+\.?\d*", row.recomputed)
    return max(len(number.replace(".", "").strip("0")) for number in numbers)


def test_recomputed_numbers_have_fifteen_digits_unless_they_end_before(
    judged: dict[str, JudgedRow],
) -> None:
    short = {word for word, row in judged.items() if digits_of(row) < 15}
    assert short == {
        f"{paper}_{word}" for paper, words in ENDS_BEFORE.items() for word in words.split()
    }


def test_the_paper_s_two_last_frequencies_are_both_explained(judged: dict[str, JudgedRow]) -> None:
    estimate, run = judged["mathar_vii_estimate"], judged["mathar_vii_frequency"]
    assert (estimate.verdict, run.verdict) == ("reproduced", "reproduced")
    assert estimate.recomputed.startswith("0.06084363411")
    assert run.recomputed.startswith("0.06084363348")
    assert "0.0608436336996" in run.remark
    assert "0.060849421166" in run.remark


def test_the_orders_of_the_approximations_are_those_of_theory(judged: dict[str, JudgedRow]) -> None:
    orders = {
        word: float(match[1])
        for word, row in judged.items()
        if (match := re.search(r"order (\d[.\d]*) in", row.error))
    }
    assert len(orders) >= 25
    assert orders["mathar_vi_2"] == pytest.approx(2, abs=0.05)
    assert orders["mathar_50_two"] == pytest.approx(3, abs=0.05)
    assert orders["gastebois_6_3_wide"] == pytest.approx(4, abs=0.05)


def test_a_dataset_of_ones_own_in_the_current_folder_changes_no_verdict(tmp_path: Path) -> None:
    """`load("paris")` means ./golden/paris where there is one, which may be shorter and less exact."""
    write(solve("paris", t_end=20, digits=8, level="computed"), tmp_path / "golden/paris")
    program = "from compare.papers.points import transits; print(len(transits('t')))"
    printed = subprocess.check_output([sys.executable, "-c", program], cwd=tmp_path, env=HERE)
    assert int(printed) == len(load(golden_root() / "paris").transits)


# the page ------------------------------------------------------------------------------------------------------------
def test_the_folder_holds_the_page_the_figures_and_the_rows(built: Built) -> None:
    numbers = list(FIGURES)
    assert numbers == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    expected = {
        "SHA256SUMS",
        "index.html",
        "rows.csv",
        "rows.json",
        *(f"figure_{n}.svg" for n in numbers),
    }
    assert {path.name for path in built[0].iterdir()} == expected


def test_json_and_csv_hold_the_same_rows(built: Built) -> None:
    folder, rows = built
    as_json = json.loads((folder / "rows.json").read_text(encoding="utf-8"))["rows"]
    with (folder / "rows.csv").open(encoding="utf-8", newline="") as handle:
        as_csv = list(csv.DictReader(handle))
    for row in as_csv:  # what a spreadsheet would run begins with an apostrophe there
        row.update(
            {
                key: cell[1:] if cell[:1] == "'" and cell[1:2] in "=+-@" else cell
                for key, cell in row.items()
            }
        )
    assert as_json == as_csv == [asdict(row) for row in rows]
    assert {"id", "place", "printed", "recomputed", "verdict"} <= set(as_json[0])


def test_the_page_needs_nothing_from_outside_and_shows_each_figure_beside_its_caption(
    built: Built,
) -> None:
    text = (built[0] / "index.html").read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)=["'](?!data:|#)""", text)
    assert "http" not in re.sub(r'base64,[^"]*', "", text)
    for number in FIGURES:
        drawn = re.search(rf'id="figure-{number}" class="plate">\n<img [^>]*base64,([^"]*)"', text)
        assert drawn is not None
        assert base64.b64decode(drawn[1]).decode() == (built[0] / f"figure_{number}.svg").read_text(
            "utf-8"
        )
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


@pytest.mark.usefixtures("built")  # which has made the runs
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
    worst = [
        float(np.abs(states[name][:, :3] - truth[:, :3]).max())
        for name in ("rk4", "rkng56", "rkng67")
    ]
    assert worst[0] > 100 * worst[1] > 1e4 * worst[2] / 100
