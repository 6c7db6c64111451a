"""Progress of a proof: its parts count by what they cost, and each is named while it goes on."""

from __future__ import annotations

import time

import child
import pytest

from reference import solve
from reference.engines.registry import in_background
from reference.solver.workload import Workload
from reference.system.channel import ACTIVITY
from reference.system.workers import usable_cores

END_S = 60.0


def test_parts_count_by_their_cost_and_are_named_while_they_go_on():
    told: list[float] = []
    words: list[str] = []
    workload = Workload(told.append, END_S, {"proving": 3.0, "seeing": 1.0})
    proving, seeing = workload.part("proving"), workload.part("seeing")
    with ACTIVITY.heard_by(words.append):
        proving(20.0)
        proving(10.0)  # it started again, in more bits
        workload.finish("proving")
        seeing(30.0)
        seeing(60.0)
    assert told == pytest.approx([15.0, 15.0, 52.5, 60.0])
    assert words == ["proving", "proving", "seeing"]


@pytest.mark.skipif(usable_cores() < 2, reason="nothing is done in the background on one core")
def test_of_work_done_at_the_same_time_the_slower_part_counts(tmp_path):
    told: list[float] = []
    words: list[str] = []
    workload = Workload(told.append, END_S, {"proving": 1.0, "confirming": 1.0})
    with in_background(True, child.report_and_wait, 6.0, str(tmp_path / "go_on")) as work:
        workload.watch("confirming", work)
        while work.reached < 6.0:
            time.sleep(0.01)
        with ACTIVITY.heard_by(words.append):
            workload.part("proving")(30.0)
        (tmp_path / "go_on").touch()
        assert work.result() == "done"
        workload.part("proving")(60.0)
    # a half of the proof is done, but nine tenths of the confirmation are to come
    assert told == pytest.approx([6.0, 60.0])
    assert words == ["proving and confirming"]


def test_nobody_asks_and_nothing_is_told():
    assert Workload(None, END_S, {"proving": 1.0}).part("proving") is None


def test_a_proof_reports_its_parts_in_order_and_up_to_its_end():
    told: list[float] = []
    words: list[str] = []
    with ACTIVITY.heard_by(words.append):
        solve(
            "paris",
            t_end=60,
            digits=15,
            level="enclosed",
            audit=True,
            confirm="sampled",
            report=told.append,
        )
    assert told == sorted(told) and told[0] >= 0 and told[-1] == pytest.approx(60.0)
    activities = [word for word in words if "compiling" not in word]
    assert activities[0] == "measuring how errors grow" and "proving" in activities


def test_a_single_run_reports_its_pilot_too():
    """heyoka's pilot is four runs, a third of the work."""
    told: list[tuple[str, float]] = []
    words = [""]
    with ACTIVITY.heard_by(words.append):
        solve(
            "paris",
            t_end=4000,
            digits=25,
            level="computed",
            transits=False,
            engine="heyoka",
            report=lambda t: told.append((words[-1], t)),
        )
    pilot = [t for word, t in told if word == "measuring how errors grow"]
    run = [t for word, t in told if word == "integrating"]
    assert pilot == sorted(pilot) and run == sorted(run)
    assert 400 < pilot[-1] < run[0]
    assert run[-1] <= 4000
