"""The judging itself: a wrong print must be found, and a wrong correction must not pass."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from compare.papers.checks import (
    Answer,
    Approximate,
    Check,
    Identity,
    PrintedNumber,
    Statement,
    UnexplainedError,
)
from compare.papers.digits import MP, mpf, sin
from compare.papers.gastebois import small
from compare.papers.mathar import kinematics, rest
from compare.papers.points import Point


def double_angle(p: Point) -> Any:
    return 2 * sin(p.cord) * MP.cos(p.cord)


def truth(p: Point) -> Any:
    return sin(2 * p.cord)


def wrong(p: Point) -> Any:
    return sin(2 * p.cord) * (1 + MP.mpf("1e-30"))


def test_two_ways_to_write_the_same_are_exact() -> None:
    row = Identity("a", "here", "2 sin cos", double_angle, truth).row()
    assert (row.verdict, row.correction) == ("exact", "")
    assert len(row.recomputed) > 15


def test_a_print_that_is_off_in_the_thirtieth_digit_is_no_identity() -> None:
    with pytest.raises(UnexplainedError, match="no declared correction"):
        Identity("a", "here", "", wrong, truth).row()


def test_a_misprint_needs_a_correction_that_holds() -> None:
    assert (
        Identity("a", "here", "", wrong, truth, "right", double_angle).row().verdict == "misprint"
    )
    with pytest.raises(UnexplainedError, match="no declared correction removes it"):
        Identity("a", "here", "", wrong, truth, "also wrong", wrong).row()


def test_what_is_right_cannot_be_declared_wrong() -> None:
    with pytest.raises(UnexplainedError, match="the printed formula is right"):
        Identity("a", "here", "", double_angle, truth, "another", double_angle).row()
    with pytest.raises(UnexplainedError, match="the sentence is true"):
        Statement("a", "here", "", lambda: Answer(True, "1"), "no", lambda: True).row()


def test_an_approximation_has_the_order_it_declares_or_none() -> None:
    def pair(s: Any) -> tuple[Any, Any]:
        return s, sin(s)

    row = Approximate("a", "here", "sin s = s", pair, 2, "s").row()
    assert row.verdict == "approximation"
    assert row.error == "0.188 (relative); order 2 in s"
    with pytest.raises(UnexplainedError, match="order 2, not 3"):
        Approximate("a", "here", "sin s = s", pair, 3, "s").row()


@pytest.mark.parametrize(
    ("numeral", "value", "verdict", "note"),
    [
        ("67", "67", "exact", ""),
        ("3.142", "3.14159265", "reproduced", ""),
        ("3.141", "3.14159265", "reproduced", "cut off, not rounded"),
        ("3.143", "3.14159265", "misprint", "3.142"),
        ("-66.98", "-66.9981", "misprint", "-67.00"),
        ("5e-9", "5.3e-9", "reproduced", ""),
        ("7.297e-5", "7.292115e-5", "misprint", "7.292e-5"),
        ("-0.3", "-0.39", "reproduced", "cut off, not rounded"),
    ],
)
def test_a_numeral_is_the_value_rounded_or_cut_off_or_a_misprint(
    numeral: str, value: str, verdict: str, note: str
) -> None:
    row = PrintedNumber("a", "here", numeral, numeral, lambda: mpf(value)).row()
    assert row.verdict == verdict
    assert (row.correction if verdict == "misprint" else row.remark).replace(
        "0.00007292", "7.292e-5"
    ) == note


def test_about_means_within_a_tenth_of_what_is_spoken_of() -> None:
    def row(scale: str) -> str:
        return (
            PrintedNumber("a", "", "", "0.5", lambda: mpf("0.549"), about=lambda: mpf(scale))
            .row()
            .verdict
        )

    assert row("1") == "reproduced"  # 0.549 rounds to 0.5
    near = PrintedNumber(
        "a", "", "", "-66.98", lambda: mpf("-66.998"), about=lambda: mpf("0.004"), decimals=3
    ).row()
    assert (near.verdict, near.correction) == ("misprint", "-66.998")
    assert (
        PrintedNumber("a", "", "", "6370", lambda: mpf("6371"), about=lambda: mpf(6371))
        .row()
        .verdict
        == "approximation"
    )


def test_a_numeral_may_follow_from_the_paper_s_own_rounded_inputs() -> None:
    row = PrintedNumber(
        "a",
        "",
        "",
        "5.88",
        lambda: mpf("5.865"),
        from_inputs=lambda: mpf("5.876"),
        inputs="its inputs",
    ).row()
    assert (row.verdict, row.remark) == ("reproduced", "from its inputs: 5.876")


def test_a_sentence_that_fails_needs_one_that_holds() -> None:
    fails = Statement("a", "here", "", lambda: Answer(False, "0"), "the other", lambda: True)
    assert (fails.row().verdict, fails.row().correction) == ("misprint", "the other")
    with pytest.raises(UnexplainedError):
        replace(fails, corrected=lambda: False).row()


@pytest.mark.parametrize(
    "section", [kinematics, rest, small], ids=["Mathar II", "Mathar V", "Gastebois 5, 6.1"]
)
def test_no_identity_survives_a_change_in_its_thirtieth_digit(section: Any, size: Any) -> None:
    declared: list[Check] = section.checks()
    count = 0
    for check in declared[:: size(4, 1)]:
        if not isinstance(check, Identity) or check.row().recomputed.strip("(0., )") == "":
            continue  # a zero times anything is the zero

        def changed(p: Point, check: Identity = check) -> Any:
            value = check.truth(p)
            factor = 1 + MP.mpf("1e-30")
            return (
                tuple(part * factor for part in value)
                if isinstance(value, tuple)
                else value * factor
            )

        with pytest.raises(UnexplainedError):
            replace(check, formula=changed, corrected=None).row()
        count += 1
    assert count >= size(2, 8)
