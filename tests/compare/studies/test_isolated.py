"""Child processes and journals: a hang or crash loses only its own item, and nothing measured is lost."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from compare.studies.isolated import isolated
from compare.studies.journal import Journal
from reference import InputError
from reference.process import Emit


def answers(emit: Emit, offset: int, items: list[str]) -> None:
    for item in items:
        if item == "hangs":
            time.sleep(600)
        if item == "dies":
            os._exit(3)
        emit(f"{item} {offset}")


def failed(item: str, timed_out: bool, reason: str) -> str:
    return f"{item} failed: {'timed out' if timed_out else 'ended'}"


def test_an_item_that_hangs_or_dies_is_named_and_the_others_are_done(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compare.studies.isolated.STARTING_S", 5.0)
    results = list(isolated(answers, (7,), ["a", "dies", "b", "hangs", "c"], 0.5, failed))
    assert results == ["a 7", "dies failed: ended", "b 7", "hangs failed: timed out", "c 7"]


def test_a_journal_gives_back_results_of_its_recipe_only(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "rows.jsonl"
    Journal(path, "one").add({"x": 1})
    Journal(path, "two").add({"x": 2})
    with path.open("a") as stream:
        stream.write('{"recipe": "one", "resu')  # where an interrupt cut it off
    assert list(Journal(path, "one")) == [{"x": 1}]
    assert list(Journal(None, "one")) == []


def test_a_journal_that_cannot_be_written_says_so(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="--out"):
        Journal(tmp_path / "file" / "rows.jsonl", "one").add({})
