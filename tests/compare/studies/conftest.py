"""Campaigns that measure in the process of the test."""

from __future__ import annotations

import pytest
from here import measured_here


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    measured_here(monkeypatch)
