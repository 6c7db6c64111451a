"""The header of a report says so where the machine was busy, or repeats of a run differ."""

from __future__ import annotations

import os

import pytest

from compare.report.study_tables import busy, text_table
from compare.studies.campaign import load_per_core
from compare.studies.row import Row
from reference.status import Status


def rows(load: float | None, spread: float | None) -> list[Row]:
    return [Row("rk4", "plane", 0.1, "step", "binary64", Status.OK, "", 1e-3, cpu_s=1.0, cpu_spread=spread, load=load)]


@pytest.mark.parametrize(
    ("load", "spread", "words"),
    [
        (0.5, 0.05, "0.5 processes for each core (median), 0.5 at most; repeats of a run differ by 5 % (median)"),
        (2.5, 0.05, "The machine was busy: ratios of costs drift too"),
        (0.5, 0.9, "Costs were uneven: ratios of costs drift too"),
        (None, None, "not known"),
    ],
)
def test_a_busy_machine_is_said_to_be_so(load: float | None, spread: float | None, words: str) -> None:
    text = busy(rows(load, spread))
    assert words in text
    assert ("busy" in text) == ((load or 0) > 1)


def test_the_text_has_it_below_the_scene() -> None:
    document = {
        "scene": "paris", "t_end": 60.0, "reference": {"level": "confirmed", "bound_m": 1e-40, "transits": 2},
        "rows": [vars(one) for one in rows(2.5, None)],
    }  # fmt: skip
    assert text_table(document).splitlines()[1].startswith("load: 2.5 processes for each core")


@pytest.mark.skipif(not hasattr(os, "getloadavg"), reason="this system does not tell its load")
def test_the_load_is_that_of_the_system_over_its_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "getloadavg", lambda: (6.0, 1.0, 1.0))
    monkeypatch.setattr(os, "cpu_count", lambda: 4)
    assert load_per_core() == 1.5
    monkeypatch.delattr(os, "getloadavg")
    assert load_per_core() is None
