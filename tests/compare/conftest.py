"""Every row of the papers judged once; the page of some of them built once, with every figure drawn."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from compare import papers
from compare.papers import points
from compare.papers.checks import JudgedRow

EACH = 9  # of so many rows the page shows one
FEW = 1  # random points at which each row is judged; as many as the product takes under --long
LATITUDES = ["-90", "0", points.LATITUDES[-1]]  # whose frequency figure 8 shows then


def fewer(patch: pytest.MonkeyPatch, config: pytest.Config) -> None:
    """Have rows judged at fewer points, and figure 8 drawn of fewer runs, but under --long."""
    if not config.getoption("--long"):
        patch.setattr(points, "COUNT", FEW)
        patch.setattr(points, "LATITUDES", LATITUDES)
    forget()


def forget() -> None:
    """Have the points drawn and the runs made again."""
    points.points.cache_clear()
    points.frequencies.cache_clear()


@pytest.fixture
def few_runs(pytestconfig: pytest.Config) -> Iterator[None]:
    """What the rows are judged by, for a test that asks for the runs itself."""
    with pytest.MonkeyPatch.context() as patch:
        fewer(patch, pytestconfig)
        yield
    forget()


@pytest.fixture(scope="session")
def judged(pytestconfig: pytest.Config) -> dict[str, JudgedRow]:
    pytest.importorskip("numba")
    with pytest.MonkeyPatch.context() as patch:
        fewer(patch, pytestconfig)
        rows = {row.id: row for row in papers.rows()}
    forget()
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
    forget()
    return folder, rows
