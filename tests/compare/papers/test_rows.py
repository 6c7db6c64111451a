"""The verdicts on the three source papers, against the misprints that were known before, independently."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from places import ROOT

from compare.papers import declared
from compare.papers.checks import VERDICTS, JudgedRow
from reference import load, solve, write
from reference.scenes.shipped import golden_root

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


def test_there_is_a_row_for_more_than_a_hundred_lines_of_all_three_papers(judged: dict[str, JudgedRow]) -> None:
    assert len(judged) >= 250
    for paper in ("mathar_", "gastebois_", "methods_"):
        assert sum(word.startswith(paper) for word in judged) >= 30


def test_ids_are_unique_words(judged: dict[str, JudgedRow]) -> None:
    assert len(judged) == len(declared())
    assert all(re.fullmatch(r"[a-z][a-z0-9_]*", word) for word in judged)


def test_the_misprints_are_these_and_each_correction_says_what_is_right(judged: dict[str, JudgedRow]) -> None:
    known = KNOWN_MISPRINTS | FURTHER_MISPRINTS
    corrections = {word: row.correction for word, row in judged.items() if row.verdict == "misprint"}
    assert set(corrections) == set(known)
    assert {word: corrections[word] for word, part in known.items() if part not in corrections[word]} == {}


def test_the_paper_s_numbered_equations_and_each_power_of_47_are_exact_as_printed(judged: dict[str, JudgedRow]) -> None:
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


def test_recomputed_numbers_have_fifteen_digits_unless_they_end_before(judged: dict[str, JudgedRow]) -> None:
    short = {word for word, row in judged.items() if digits_of(row) < 15}
    assert short == {f"{paper}_{word}" for paper, words in ENDS_BEFORE.items() for word in words.split()}


def test_the_paper_s_two_last_frequencies_are_both_explained(judged: dict[str, JudgedRow]) -> None:
    estimate, run = judged["mathar_vii_estimate"], judged["mathar_vii_frequency"]
    assert (estimate.verdict, run.verdict) == ("reproduced", "reproduced")
    assert estimate.recomputed.startswith("0.06084363411")
    assert run.recomputed.startswith("0.06084363348")
    assert "0.0608436336996" in run.remark
    assert "0.060849421166" in run.remark


def test_the_orders_of_the_approximations_are_those_of_theory(judged: dict[str, JudgedRow]) -> None:
    orders = {
        word: float(match[1]) for word, row in judged.items() if (match := re.search(r"order (\d[.\d]*) in", row.error))
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
