"""docs/studies.md is what the kept results say, word for word; a claim that they do not bear out is not printed."""

from __future__ import annotations

import copy
import itertools
import re
import sys
from contextlib import suppress
from typing import Any

import pytest
from places import ROOT

from reference.status import Status

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
    assert studies.PAGE.read_text(encoding="utf-8") == page, (
        "python tests/bench/studies.py --page writes it anew"
    )


def test_the_page_names_the_one_command_and_each_study(page: str) -> None:
    text = " ".join(page.replace("\\\n", " ").split())
    assert "`make studies`" in text
    assert (
        "tests/bench/studies.py"
        in (ROOT / "Makefile").read_text(encoding="utf-8").partition("\nstudies:")[2]
    )
    for command in studies_page.COMMANDS.values():
        assert command in text


def changed(value: Any, field: str, place: int = 0) -> Any:
    """The same results with another value of one field, each row's by a factor of its own."""
    if isinstance(value, list):
        return [changed(one, field, place) for place, one in enumerate(value)]
    if not isinstance(value, dict):
        return value
    return {
        name: another(one, place) if name == field else changed(one, field, place)
        for name, one in value.items()
    }


def another(value: Any, place: int) -> Any:
    if isinstance(value, list):
        return value[: len(value) // 2]
    if isinstance(value, dict):
        return {name: another(one, place) for name, one in value.items()}
    if isinstance(value, str):
        return (
            ("silently_wrong" if place % 3 else "not_installed")
            if value in [*Status]
            else f"7{value}"
        )
    return (
        value
        if value is None
        else value * (2 + place % 5)
        if isinstance(value, int)
        else value * (1.2 + place % 5 / 9)
    )


FIELDS = (
    *("cpu_s", "asked", "load", "t_end", "error_m", "machine", "title", "exponent"),
    *("limit_s", "reference", "observed", "rows", "setting", "cpu_spread", "status", "digits"),
)
FIRST = 8  # of the fields: these are what today's lines need, and these of one study
ONE_STUDY = (("hard", "setting"), ("stability", "rows"))
DEFINED = (  # lines whose numbers are definitions, and stand in the code that is run
    "## Thirty days", "Position error at the end", "Each method is asked", "| method | CPU s at", "foucault study",
    "- `separatrix`", "  ", "The machine was busy", "## Stiff and extreme",
)  # fmt: skip


def test_every_line_with_a_number_is_held_by_the_results(kept: dict[str, Any]) -> None:
    """Each changes, or is refused, where the results are others; else the number stands in the page itself.

    A field is changed in all results, and then in those of one study at a time, until every line has changed.
    """
    lines = list(studies_page.lines(kept))
    free = {line for line in lines if re.search(r"\d", line) and not line.startswith(DEFINED)}
    all_studies = [([*kept], field) for field in FIELDS]
    one_study = [([name], field) for name, field in (*ONE_STUDY, *itertools.product(kept, FIELDS))]
    for names, field in [
        *all_studies[:FIRST],
        *one_study[: len(ONE_STUDY)],
        *all_studies[FIRST:],
        *one_study,
    ]:
        if not free:
            break
        with suppress(
            studies_page.NotSoError, LookupError, StopIteration, ValueError, TypeError, Warning
        ):
            free &= {
                *studies_page.lines(kept | {name: changed(kept[name], field) for name in names})
            }
    assert free == set()
    assert all(any(line.startswith(words) for line in lines) for words in DEFINED)


@pytest.mark.parametrize(
    ("name", "method", "claim"),
    [
        ("paris", "heyoka_double", "times cheaper than the paper"),
        ("paris", "scipy_dop853", "is not stiff"),
        ("paris_again", "heyoka_double", "rank by cost"),
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
    with pytest.raises(studies_page.NotSoError, match="multistep methods"):
        studies_page.page(others)


def test_the_kept_results_are_small() -> None:
    sizes = [path.stat().st_size for path in studies.KEPT.iterdir()]
    assert len(sizes) == len(studies_page.COMMANDS)
    assert sum(sizes) < 450_000
