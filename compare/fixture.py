"""The pytest fixtures `assert_agrees` and `foucault_scene`, found by the entry point of the installed package.

@pytest.mark.foucault_scenes("hard", paris=1e-8)
def test_mine(foucault_scene):
    t, states = simulate(**foucault_scene.inputs)
    foucault_scene.assert_agrees(t, states)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from . import Score
    from .testing import SceneCase

MARKER, FIXTURE = "foucault_scenes", "foucault_scene"


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker `foucault_scenes`."""
    text = "run the test once for each scene, with the tolerance in m where one is given"
    config.addinivalue_line("markers", f"{MARKER}(*scenes, **tolerances): {text}")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Make one test for each scene that the marker names."""
    if FIXTURE not in metafunc.fixturenames:
        return
    scenes: dict[str, float | None] = {}
    for mark in metafunc.definition.iter_markers(MARKER):
        scenes.update(dict.fromkeys(mark.args, None), **mark.kwargs)
    if not scenes:
        raise pytest.UsageError(
            f"{metafunc.definition.nodeid}: name scenes with @pytest.mark.{MARKER}(paris=1e-8)"
        )
    metafunc.parametrize(FIXTURE, list(scenes.items()), ids=list(scenes), indirect=True)


@pytest.fixture(name="assert_agrees")
def assert_agrees_fixture() -> Callable[..., Score]:
    """Assert that a trajectory agrees with the truth of a scene: `compare.assert_agrees`, imported at first use."""
    from .testing import assert_agrees

    return assert_agrees


@pytest.fixture(name=FIXTURE)
def scene_fixture(request: pytest.FixtureRequest) -> SceneCase:
    """One of the scenes that the marker `foucault_scenes` names, with its tolerance and its inputs as numbers."""
    from reference import load_scene

    from .testing import SceneCase

    name, tolerance = request.param
    return SceneCase(load_scene(name), tolerance)
