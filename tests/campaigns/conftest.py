"""Each format as its command writes it, made once for all tests of damage."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest
from formats import FORMATS, IN_PROCESSES, Foucault, Made


@pytest.fixture(scope="session")
def places(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return the folder of each format in which it is made once."""
    return cache(tmp_path_factory.mktemp)


@pytest.fixture(params=FORMATS)
def made(request: pytest.FixtureRequest, places: Callable[[str], Path], foucault: Foucault) -> Made:
    """Return each format, made by its command, and another one of its kind."""
    chosen = {**FORMATS, IN_PROCESSES.name: IN_PROCESSES}[request.param]
    for module in chosen.needs:
        pytest.importorskip(module)
    return Made(chosen, places(chosen.name.replace(" ", "_")), foucault)
