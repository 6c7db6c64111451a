"""Settings for every test, and the fixture that most of them want."""

from __future__ import annotations

import signal

import pytest
from hypothesis import settings
from small_scenes import make_scene

from reference.scene import Scene, load_scene

settings.register_profile("here", deadline=None, derandomize=True)
settings.load_profile("here")

# tests interrupt what they start; a shell's background job would have it ignore that
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)

__all__ = ["make_scene"]


@pytest.fixture
def paris() -> Scene:
    return load_scene("paris")
