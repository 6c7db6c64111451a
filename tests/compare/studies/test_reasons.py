"""Reasons of failures: the strongest cause that the numbers point to, in a sentence."""

from __future__ import annotations

from dataclasses import replace

import pytest

from compare.studies.character import Character, reason_of
from compare.studies.row import Row
from reference.status import Status

CALM = Character(0.4, 0.0, 1.0, 2.0, 9.0, 0.001, 0.01, 600.0)
ROW = Row("rk4", "space", 0.1, "step", "binary64", Status.OK, steps=6000, h_drift=1e-7, cpu_s=12.0)


@pytest.mark.parametrize(
    ("status", "row", "traits", "words"),
    [
        (
            Status.OUT_OF_TIME,
            ROW,
            replace(CALM, damping=4000.0, ratio=1e6),
            ["about 12 s", "stiff: rates up to 4e+03/s"],
        ),
        (
            Status.GAVE_UP,
            replace(ROW, reason="Step too small."),
            replace(CALM, least_tension=-9.8),
            ["the rod is pushed", "It reported: Step too small"],
        ),
        (
            Status.SILENTLY_WRONG,
            ROW,
            CALM,
            ["success was reported with 1.0 digits", "local errors of 6000 steps add up", "h drifts"],
        ),
        (Status.SILENTLY_WRONG, ROW, replace(CALM, magnified=1e8), ["amplifies an error at the release 1e+08 times"]),
        (Status.SILENTLY_WRONG, ROW, replace(CALM, amplitude=1e-11), ["cancellation against z ≈ −l costs 11 digits"]),
        (
            Status.SILENTLY_WRONG,
            replace(ROW, formulation="angles"),
            replace(CALM, nearest=1e-9),
            ["passes the vertical within 1e-09"],
        ),
        (
            Status.SILENTLY_WRONG,
            replace(ROW, formulation="plane"),
            replace(CALM, amplitude=1.0),
            ["height of the suspension"],
        ),
        (Status.NOT_FINITE, replace(ROW, reason=""), CALM, ["no measured property of the scene explains it"]),
        (Status.REFUSED, replace(ROW, reason="not below"), CALM, ["not below"]),
    ],
)
def test_each_cause_is_named(status: Status, row: Row, traits: Character, words: list[str]) -> None:
    reason = reason_of(row, status, traits, 1.0, 9.0, 3.0)
    for word in words:
        assert word.lower() in reason.lower()


def test_what_is_right_needs_no_reason() -> None:
    assert reason_of(ROW, Status.OK, CALM, 9.0, 9.0, 3.0) == ""
