"""The pytest fixture `assert_agrees`, which pytest finds by the entry point of the installed package."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from .score.judge import Score


@pytest.fixture(name="assert_agrees")
def assert_agrees_fixture() -> Callable[..., Score]:
    """Assert that a trajectory agrees with the truth of a scene: `compare.assert_agrees`, imported at first use."""
    from .testing import assert_agrees

    return assert_agrees
