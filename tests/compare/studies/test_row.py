"""The status of a row, one enumeration for all of compare; of a run that raised, who stopped it; exact differences."""

from __future__ import annotations

import ast
import json
from fractions import Fraction

import numpy as np
import pytest
from places import ROOT

from compare.report.pareto import rows_of
from compare.report.stability_charts import LETTERS
from compare.studies.row import FAILURES, Row, difference, failure
from reference import InputError, IntegrationError, UnreachableError
from reference.status import Status

THIRD = Fraction(1, 3)
FILES = sorted((ROOT / "compare").rglob("*.py"))


def bare(text: str) -> list[str]:
    """Every literal that is the word of a status."""
    literals = (node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant))
    return [literal for literal in literals if literal in list(Status)]


def test_no_word_of_a_status_stands_in_compare_but_in_the_enumeration() -> None:
    assert bare('status = "gave_up"') == ["gave_up"]
    assert {path.name: bare(path.read_text()) for path in FILES if bare(path.read_text())} == {}


@pytest.mark.parametrize("status", Status)
def test_a_status_goes_through_json_and_comes_back(status: Status) -> None:
    row = Row("rk4", "plane", 0.1, "step", "binary64", status)
    document = json.loads(json.dumps(vars(row)))
    assert document["status"] == str(status)
    (parsed,) = rows_of({"rows": [document | {"of a later version": 1}]})
    assert parsed == row
    assert parsed.status is status


def test_what_can_go_wrong_says_what_to_do_and_has_a_letter_of_its_own() -> None:
    assert all(status.advice for status in LETTERS)
    assert len(set(LETTERS.values())) == len(LETTERS)


@pytest.mark.parametrize(
    ("error", "status", "reason"),
    [
        (
            IntegrationError("heyoka stopped at t = 9.8 s."),
            Status.GAVE_UP,
            "heyoka stopped at t = 9.8 s.",
        ),
        (
            UnreachableError("no circle.", "Take another."),
            Status.REFUSED,
            "no circle. Take another.",
        ),
        (
            InputError("t_end", "0", "a time above 0"),
            Status.REFUSED,
            "t_end: got '0', expected a time above 0.",
        ),
        (
            ZeroDivisionError("division by zero"),
            Status.GAVE_UP,
            "ZeroDivisionError: division by zero",
        ),
    ],
)
def test_an_integrator_gives_up_and_a_method_refuses(error, status, reason):
    assert isinstance(error, FAILURES)
    assert failure(error) == (status, reason)


def test_exact_numbers_keep_a_difference_of_any_size() -> None:
    tiny = Fraction(1, 10**60)
    assert difference([THIRD + tiny, THIRD], [THIRD, THIRD + 2 * tiny]) == pytest.approx(
        [1e-60, -2e-60], rel=1e-15
    )


def test_a_double_is_taken_as_it_stands_beside_an_exact_number() -> None:
    doubles = np.array([float(THIRD)])
    # 1.9e-17, which a subtraction of doubles would lose
    off = float(Fraction(float(THIRD)) - THIRD)
    assert off != 0
    assert difference(doubles, [THIRD]) == [off]
    assert difference([THIRD], doubles) == [-off]


def test_columns_of_unlike_length_are_no_trajectories_at_the_same_times() -> None:
    with pytest.raises(ValueError, match="zip"):
        difference([THIRD], [THIRD, THIRD])
