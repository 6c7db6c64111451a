"""Long runs, made short: the exponent of time is measured, rows are stored, and a method that cannot run is a row."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from compare.studies.campaign import Reports
from compare.studies.long_runs import laws, long_runs
from reference import load_scene

ITEMS = (("rkmk4", "momentum", 0.1), ("heyoka_double", "plane", 2.0**-52), ("rk4", "plane", 0.1))


@pytest.mark.usefixtures("here")
def test_a_fixed_step_errs_in_proportion_to_time_and_the_rows_are_kept(
    tmp_path: Path, size: Callable[..., int]
) -> None:
    scene = load_scene("paris", ["inputs=binary64", f"run.t_end={size(1800, 7200)}"])
    journal_path = tmp_path / "long.jsonl"
    rows = long_runs(ITEMS[:1], scene, journal_path=journal_path)
    assert rows[0].status == "ok"
    assert rows[0].exponent == pytest.approx(1, abs=0.15)  # a constant error of the frequency
    assert 0 < rows[0].bound_m < 1e-35
    reports: list[str] = []
    again = long_runs(
        ITEMS,
        scene,
        journal_path=journal_path,
        reports=Reports(measuring=lambda *now: reports.append("{} of {}".format(*now))),
    )
    assert again[0] == rows[0]
    assert reports == ["1 of 3", "2 of 3"]
    assert [(row.method, row.formulation, row.setting) for row in again] == list(ITEMS)


@pytest.mark.usefixtures("here")
def test_what_cannot_run_is_a_row_with_its_reason() -> None:
    upright = load_scene("two_radians", ["inputs=binary64", "run.t_end=1", "run.transits=false"])
    (row,) = long_runs([("rk4", "plane", 0.1)], upright)
    assert (row.status, row.exponent, row.law) == ("refused", None, None)
    assert next(laws([row])).startswith("rk4 (plane): refused")


@pytest.mark.long  # a first run in double over thirty days
def test_without_a_scene_the_truth_is_solved_for_over_thirty_days(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path))

    class Enough(Exception):
        pass

    def stop(day: float, days: float) -> None:
        assert 0 < day < days == 30
        raise Enough

    with pytest.raises(Enough):
        long_runs(ITEMS, reports=Reports(solving=stop))
