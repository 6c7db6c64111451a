"""`foucault paper`: every formula of the papers with its verdict, as JSON and as text."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from compare import papers
from compare.papers.checks import VERDICTS


@pytest.mark.long
@pytest.mark.parametrize("as_json", [True, False])
def test_every_formula_is_listed_with_its_verdict(foucault: Any, as_json: bool) -> None:
    pytest.importorskip("numba")
    declared = papers.declared()
    status, out, _ = foucault("paper", *["--json"] * as_json)
    assert status == 0
    if as_json:
        rows = json.loads(out)["rows"]
        assert [row["place"] for row in rows] == [line.place for line in declared]
        assert {row["verdict"] for row in rows} == {*VERDICTS}
        return
    listed, _, counts = out.rpartition("\n\n")
    assert all(line.place in listed for line in declared)
    told = Counter(line.split()[0] for line in listed.splitlines() if not line.startswith(" "))
    assert told.total() == len(declared)
    assert {word: int(count) for word, count in map(str.split, counts.splitlines())} == told


def test_a_folder_that_is_not_ours_is_refused(foucault: Any, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    (tmp_path / "index.html").write_text("mine")
    status, out, err = foucault("paper", "--out", tmp_path)
    assert (status, out) == (2, "") and "--out: got" in err
    assert [path.name for path in tmp_path.iterdir()] == ["index.html"]
    assert (tmp_path / "index.html").read_text() == "mine"
