"""Each format as its command writes it, made once for all tests of damage."""

from __future__ import annotations

from pathlib import Path

import pytest
from formats import FORMATS, IN_PROCESSES, Foucault, Made


@pytest.fixture(scope="session")
def folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Path]]:
    """Return the folders that were made so far, by format."""
    return {}


@pytest.fixture(params=FORMATS)
def made(
    request: pytest.FixtureRequest,
    folders: dict[str, tuple[Path, Path]],
    tmp_path_factory: pytest.TempPathFactory,
    foucault: Foucault,
) -> Made:
    """Return each format, made by its command, and another one of its kind."""
    chosen = {**FORMATS, IN_PROCESSES.name: IN_PROCESSES}[request.param]
    if chosen.name not in folders:
        place = tmp_path_factory.mktemp(chosen.name)
        folders[chosen.name] = chosen.make(place / "whole"), chosen.make(place / "other", other=True)
    return Made(chosen, *folders[chosen.name], foucault)
