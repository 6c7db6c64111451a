"""docs/judged.md says what `foucault score` says of the trajectories that ship with the tests."""

from __future__ import annotations

import judged_page
import pytest
import wild_programs as programs

QUICK = ("w01", "w18")  # a linear model and a full one; all under --long


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_the_register_has_each_program_once_with_its_language_and_a_true_head():
    page = judged_page.PAGE.read_text(encoding="utf-8")
    assert page.startswith(judged_page.head())
    listed = [cells(line)[0] for line in page.splitlines() if line.startswith("| w")]
    assert listed == [*programs.SETTINGS]
    assert sorted(name for names in judged_page.LANGUAGES.values() for name in names) == listed


def test_a_row_is_what_the_program_is_judged_to_be(size):
    page = judged_page.PAGE.read_text(encoding="utf-8").splitlines()
    for name in size(QUICK, programs.SETTINGS):
        (kept,) = (cells(line) for line in page if line.startswith(f"| {name} "))
        found = cells(judged_page.row(name))
        assert kept[:4] + kept[5:6] + kept[7:] == found[:4] + found[5:6] + found[7:], (
            "run: python tests/helpers/judged_page.py"
        )
        assert float(kept[4]) == pytest.approx(float(found[4]), abs=0.11)
        assert float(kept[6]) == pytest.approx(float(found[6]), abs=1)
