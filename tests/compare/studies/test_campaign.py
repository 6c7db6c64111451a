"""Campaigns: a hang or crash loses only its own item, nothing measured is lost, only what is equal is used again."""

from __future__ import annotations

import json
import os
import platform
from pathlib import Path
from typing import Any

import pytest
from answering import Replies, Reply

from compare.studies.campaign import Counted, campaign
from reference import InputError


def run(
    items: list[tuple[str, str]],
    journal_path: Path | None = None,
    report: Counted | None = None,
    **fields: Any,
) -> list[Reply]:
    return campaign(Replies(**fields), items, journal_path=journal_path, report=report)


@pytest.fixture
def in_process(here: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what is kept, not of processes: answers come from this one."""
    monkeypatch.setenv("OMP_NUM_THREADS", "1")


def loaded(patch: pytest.MonkeyPatch, per_core: float) -> None:
    """Have the system tell how many processes want each core."""
    load = per_core * (os.cpu_count() or 1)
    patch.setattr(os, "getloadavg", lambda: (load, load, load))


def test_an_item_that_hangs_or_dies_is_named_and_the_others_are_done(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    loaded(monkeypatch, per_core=0.5)
    results = run([("m", word) for word in ("a", "dies", "b", "hangs", "c")])
    assert [one.status for one in results] == ["ok", "crashed", "ok", "out_of_time", "ok"]
    assert [results[i].text for i in (0, 2, 3, 4)] == [
        "a 7",
        "b 7",
        "hangs: no answer within 2 s",
        "c 7",
    ]
    assert results[1].text.startswith("dies: its process ended")


def test_on_a_busy_machine_an_answer_is_awaited_longer(monkeypatch: pytest.MonkeyPatch) -> None:
    loaded(monkeypatch, per_core=4.0)
    # the first item has time for imports besides
    _, hung = run([("m", "a"), ("m", "hangs")], patience_s=0.5)
    assert (hung.status, hung.text) == ("out_of_time", "hangs: no answer within 2 s")


def test_items_that_differ_in_their_last_part_share_a_process_with_one_thread(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "5")
    before = dict(os.environ)
    first, other, second = run([("m", "a"), ("n", "a"), ("m", "b")])
    assert first.process == second.process != other.process
    assert {one.threads for one in (first, other, second)} == {"1"}
    assert dict(os.environ) == before


@pytest.mark.usefixtures("in_process")
def test_results_of_the_same_recipe_and_machine_are_not_measured_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, items = tmp_path / "deep" / "rows.jsonl", [("m", "a"), ("m", "b")]
    reports: list[tuple[int, int, str]] = []
    first = run(items[:1], journal_path=path)
    with path.open("a") as stream:
        stream.write('{"recipe": "cut off by an interr\n')

    def measured(**fields: Any) -> tuple[list[Reply], list[tuple[int, int, str]]]:
        reports.clear()
        return run(items, journal_path=path, report=lambda *now: reports.append(now), **fields), [
            *reports
        ]

    again, counted = measured()
    assert again[0] == first[0]
    assert counted == [(1, 2, "m")]
    assert measured() == (again, [])
    both = [(0, 2, "m"), (1, 2, "m")]
    assert measured(recipe="two")[1] == both
    monkeypatch.setattr(platform, "python_version", lambda: "3.99")
    assert measured()[1] == both
    assert len(path.read_text().splitlines()) == 7


def test_after_an_interruption_the_results_before_it_are_there(tmp_path: Path) -> None:
    path = tmp_path / "rows.jsonl"

    def interrupt(finished: int, total: int, now: str) -> None:
        if finished == 2:
            raise KeyboardInterrupt

    items = [("m", "a"), ("m", "b"), ("m", "c")]
    with pytest.raises(KeyboardInterrupt):
        run(items, journal_path=path, report=interrupt)
    assert [json.loads(line)["item"] for line in path.read_text().splitlines()] == [
        ["m", "a"],
        ["m", "b"],
    ]


@pytest.mark.usefixtures("in_process")
@pytest.mark.parametrize(
    "half", ['{"recipe": "cut off by a full di', "\x00\x00", "\udcff not UTF-8"]
)
def test_after_half_a_line_the_next_result_has_a_line_of_its_own(tmp_path: Path, half: str) -> None:
    path, items = tmp_path / "rows.jsonl", [("m", "a"), ("m", "b")]
    first = run(items[:1], journal_path=path)
    with path.open("a", errors="surrogateescape") as stream:
        stream.write(half)
    reports: list[str] = []
    second = run(
        items,
        journal_path=path,
        report=lambda finished, total, now: reports.append(f"{finished} of {total}"),
    )
    assert second[0] == first[0]
    assert run(items, journal_path=path, report=lambda *now: reports.append("again")) == second
    assert reports == ["1 of 2"]


@pytest.mark.usefixtures("in_process")
@pytest.mark.parametrize(
    "line",
    [
        pytest.param('{"recipe": "x", "item": [[1]], "result": {}}', id="an item that has no hash"),
        pytest.param(
            '{"recipe": "MARK", "item": ["m", "a"], "result": {}}', id="a result without a status"
        ),
        pytest.param(
            '{"recipe": "MARK", "item": ["m", "a"], "result": {"text": [], "status": "ok"}}',
            id="other types",
        ),
        pytest.param('{"recipe": "MARK", "item": 7, "result": 7}', id="no lists"),
    ],
)
def test_a_line_that_is_no_result_is_measured_again(tmp_path: Path, line: str) -> None:
    path = tmp_path / "rows.jsonl"
    run([("m", "a")], journal_path=path)
    path.write_text(line.replace("MARK", json.loads(path.read_text())["recipe"]) + "\n")
    assert [one.status for one in run([("m", "a")], journal_path=path)] == ["ok"]
    assert len(path.read_text().splitlines()) == 2


@pytest.mark.parametrize("place", ["file/rows.jsonl", "folder"])
def test_a_journal_that_cannot_be_written_says_so(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="--out"):
        run([("m", "a")], journal_path=tmp_path / place)


def test_methods_none_of_which_can_run_are_refused_before_anything_is_solved(foucault, monkeypatch):
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    for words in (("study", "paris", "--no-formulations"), ("stability", "--scenes", "paris")):
        status, out, err = foucault(*words, "--methods", "rk4")
        assert (status, out) == (2, "")
        assert "expected a method that can run here. rk4: NUMBA_DISABLE_JIT is set" in err
