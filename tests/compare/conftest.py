"""Every row of the papers judged once; the page of some of them built once, with every figure drawn."""

from __future__ import annotations

from pathlib import Path

import pytest

from compare import papers
from compare.papers.checks import JudgedRow

EACH = 9  # of so many rows the page shows one


@pytest.fixture(scope="session")
def judged() -> dict[str, JudgedRow]:
    pytest.importorskip("numba")
    return {row.id: row for row in papers.rows()}


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[JudgedRow]]:
    pytest.importorskip("matplotlib")
    pytest.importorskip("numba")
    folder = tmp_path_factory.mktemp("paper") / "page"
    some = papers.declared()[::EACH]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(papers, "declared", lambda: some)
        return folder, papers.build(folder)
