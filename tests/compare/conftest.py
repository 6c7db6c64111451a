"""Every row of the papers judged once; the page of some of them built once, with every figure drawn."""

from __future__ import annotations

from pathlib import Path

import pytest

from compare import papers
from compare.papers import points
from compare.papers.checks import JudgedRow

EACH = 9  # of so many rows the page shows one
FEW = 1  # random points at which each row is judged; as many as the product takes under --long
EVERY_TENTH, POLE_AND_EQUATOR = (
    (-90, 91, 10),
    (-90, 1, 90),
)  # latitudes whose frequency figure 8 shows, beside that of Paris


def fewer(patch: pytest.MonkeyPatch, config: pytest.Config) -> None:
    """Have rows judged at fewer points, and figure 8 drawn of fewer runs, but under --long."""
    if not config.getoption("--long"):
        patch.setattr(points, "COUNT", FEW)
        few = {EVERY_TENTH: POLE_AND_EQUATOR}
        patch.setattr(points, "range", lambda *ends: range(*few.get(ends, ends)), raising=False)
    points.points.cache_clear()


@pytest.fixture(scope="session")
def judged(pytestconfig: pytest.Config) -> dict[str, JudgedRow]:
    pytest.importorskip("numba")
    with pytest.MonkeyPatch.context() as patch:
        fewer(patch, pytestconfig)
        rows = {row.id: row for row in papers.rows()}
    points.points.cache_clear()
    return rows


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory, pytestconfig: pytest.Config) -> tuple[Path, list[JudgedRow]]:
    pytest.importorskip("matplotlib")
    pytest.importorskip("numba")
    folder = tmp_path_factory.mktemp("paper") / "page"
    some = papers.declared()[::EACH]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(papers, "declared", lambda: some)
        fewer(patch, pytestconfig)
        rows = papers.build(folder)
    points.points.cache_clear()
    return folder, rows
