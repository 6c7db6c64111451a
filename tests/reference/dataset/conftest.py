"""A dataset of five minutes in Paris, and a copy of it that a test may change."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import reference
from reference.dataset.write import write


@pytest.fixture(scope="session")
def original(tmp_path_factory):
    solution = reference.solve(reference.load_scene("paris"), t_end="300", digits=20, level="confirmed")
    return write(solution, tmp_path_factory.mktemp("golden") / "paris")


@pytest.fixture
def dataset(original, tmp_path) -> Path:
    return Path(shutil.copytree(original, tmp_path / "paris"))
