"""The page is built once for all tests: every row judged, every figure drawn."""

from __future__ import annotations

from pathlib import Path

import pytest

from compare.papers import build
from compare.papers.checks import JudgedRow


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[JudgedRow]]:
    pytest.importorskip("matplotlib")
    pytest.importorskip("numba")
    folder = tmp_path_factory.mktemp("paper") / "page"
    return folder, build(folder)


@pytest.fixture(scope="session")
def judged(built: tuple[Path, list[JudgedRow]]) -> dict[str, JudgedRow]:
    return {row.id: row for row in built[1]}
