"""Settings for every test, and the fixture that most of them want."""

from __future__ import annotations

import pytest
from hypothesis import settings
from small_scenes import make_scene

from reference.scene import Scene, load_scene

settings.register_profile("here", deadline=None, derandomize=True)
settings.load_profile("here")

__all__ = ["make_scene"]


@pytest.fixture
def paris() -> Scene:
    return load_scene("paris")
