"""docs/studies.md is what the kept results say, word for word; a claim that they do not bear out is not printed."""

from __future__ import annotations

import copy
import sys
from typing import Any

import pytest
from places import ROOT

sys.path.append(str(ROOT / "tests/bench"))
import studies
import studies_page


@pytest.fixture(scope="module")
def kept() -> dict[str, Any]:
    return studies.kept()


@pytest.fixture(scope="module")
def page(kept: dict[str, Any]) -> str:
    return studies_page.page(kept)


def test_every_sentence_and_figure_of_the_page_follows_from_the_kept_results(page: str) -> None:
    assert studies.PAGE.read_text(encoding="utf-8") == page


def test_the_page_names_the_one_command_and_each_study(page: str) -> None:
    text = " ".join(page.replace("\\\n", " ").split())
    assert "`make studies`" in text
    assert "tests/bench/studies.py" in (ROOT / "Makefile").read_text(encoding="utf-8").partition("\nstudies:")[2]
    for command in studies_page.COMMANDS.values():
        assert command in text


def scaled(document: dict[str, Any], names: tuple[str, ...], factor: float) -> dict[str, Any]:
    rows = document["rows"] + document["long_runs"]
    for row in rows:
        row.update({name: row[name] * factor for name in names if name in row})
    return document


USED = [
    *((name, "cpu_s") for name in studies_page.COMMANDS if name != "stability"),  # of that, ratios only
    *((name, "error_m") for name in ("paris", "hard", "pantheon", "precisions", "long")),
    *((name, "load") for name in studies_page.COMMANDS),
    ("stability", "asked"),
]


@pytest.mark.parametrize(("name", "what"), USED)
def test_no_figure_stands_in_the_page_itself(kept: dict[str, Any], page: str, name: str, what: str) -> None:
    """Where a study's costs, errors or digits are others, the page is another, or refuses to say what it says."""
    others = copy.deepcopy(kept)
    scaled(others[name], (what,), 3.7)
    try:
        text = studies_page.page(others)
    except studies_page.NotSoError:
        return
    assert text != page


@pytest.mark.parametrize(
    ("name", "method", "claim"),
    [
        ("paris", "heyoka_double", "The equations matter"),
        ("paris", "scipy_dop853", "is not stiff"),
        ("paris_again", "heyoka_double", "ranking"),
        ("precisions", "limbs", "cost less than heyoka"),
    ],
)
def test_a_claim_that_the_results_do_not_bear_out_is_refused(
    kept: dict[str, Any], name: str, method: str, claim: str
) -> None:
    others = copy.deepcopy(kept)
    for row in others[name]["rows"]:
        if row["method"] == method and row["formulation"] != "angles" and "cpu_s" in row:
            row["cpu_s"] *= 1e4
    with pytest.raises(studies_page.NotSoError, match=claim):
        studies_page.page(others)


def test_statuses_that_are_others_are_refused_or_counted(kept: dict[str, Any]) -> None:
    others = copy.deepcopy(kept)
    for row in others["stability"]["rows"]:
        row["status"] = "ok"
    with pytest.raises(studies_page.NotSoError, match="The multistep methods"):
        studies_page.page(others)


def test_the_kept_results_are_small() -> None:
    sizes = [path.stat().st_size for path in studies.KEPT.iterdir()]
    assert len(sizes) == len(studies_page.COMMANDS)
    assert sum(sizes) < 400_000
