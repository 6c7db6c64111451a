"""The pytest fixture `assert_agrees`; pytest finds it by the entry point of the installed package."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from .score.judge import Score


@pytest.fixture(name="assert_agrees")
def assert_agrees_fixture() -> Callable[..., Score]:
    """`compare.assert_agrees`, imported when a test asks for it."""
    from .testing import assert_agrees

    return assert_agrees
