"""The table of equivalent mutants: each has a reason and is one mutant of today's source."""

from __future__ import annotations

import ast
import importlib.util

import pytest
from places import ROOT

spec = importlib.util.spec_from_file_location("mutants", ROOT / "tests/mutants.py")
mutants = importlib.util.module_from_spec(spec)
spec.loader.exec_module(mutants)


@pytest.fixture(scope="module")
def files():
    return list(mutants.every_mutant())


def test_every_equivalent_has_a_reason_and_is_one_mutant_of_todays_source(files):
    assert list(mutants.stale(mutants.equivalents(), files)) == []


def test_an_entry_that_is_no_mutant_or_without_a_reason_or_twice_is_found(files):
    entry = mutants.equivalents()[0]
    for wrong, said in (
        ([{**entry, "line": "gone"}], "0 mutants of today's source are"),
        ([{**entry, "change": "1 -> 3"}], "0 mutants of today's source are"),
        ([{**entry, "why": " "}], "no reason for"),
        ([entry, entry], "0 mutants of today's source are"),
    ):
        (problem,) = mutants.stale(wrong, files)
        assert said in problem


def test_no_equivalent_is_drawn_and_how_many_are_left_out_is_counted(monkeypatch, files):
    one = mutants.equivalents()[0]
    monkeypatch.setattr(mutants, "every_mutant", lambda: iter(files))
    monkeypatch.setattr(mutants, "equivalents", lambda: [one])
    whole = next(every for every in files if every[0].file == one["file"])
    drawn, left_out = mutants.drawn(10**4, 1, one["file"])
    assert (len(drawn), left_out) == (len(whole) - 1, 1)
    assert one["change"] not in {mutant.change for mutant in drawn if mutant.line == one["line"]}


def test_the_source_of_a_mutant_is_the_file_with_its_change_and_no_other(files):
    for every in files:
        mutant = every[len(every) // 2]
        whole = ast.unparse(ast.parse((ROOT / mutant.file).read_text())).splitlines()
        changed = [pair for pair in zip(whole, mutant.source.splitlines(), strict=True) if pair[0] != pair[1]]
        assert len(changed) == 1, mutant
        before, after = mutant.change.split(" -> ")
        assert before in changed[0][0] and after in changed[0][1], mutant
