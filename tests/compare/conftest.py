"""Every row of the papers judged once; the page of some of them built once, with every figure drawn."""

from __future__ import annotations

from pathlib import Path

import pytest

from compare import papers
from compare.papers import points
from compare.papers.checks import JudgedRow

EACH = 9  # of so many rows the page shows one
FEW = 2  # random points at which each row is judged; as many as the product takes under --long


@pytest.fixture(scope="session")
def judged(pytestconfig: pytest.Config) -> dict[str, JudgedRow]:
    pytest.importorskip("numba")
    with pytest.MonkeyPatch.context() as patch:
        if not pytestconfig.getoption("--long"):
            patch.setattr(points, "COUNT", FEW)
        points.points.cache_clear()
        rows = {row.id: row for row in papers.rows()}
    points.points.cache_clear()
    return rows


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[JudgedRow]]:
    pytest.importorskip("matplotlib")
    pytest.importorskip("numba")
    folder = tmp_path_factory.mktemp("paper") / "page"
    some = papers.declared()[::EACH]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(papers, "declared", lambda: some)
        return folder, papers.build(folder)
