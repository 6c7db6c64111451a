"""A dataset of five minutes in Paris, and a copy of it that a test may change."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from small_scenes import make_scene

import reference
from reference.dataset.write import write


@pytest.fixture(scope="session")
def original(tmp_path_factory):
    solution = reference.solve(
        reference.load_scene("paris"), t_end="300", digits=20, level="confirmed"
    )
    return write(solution, tmp_path_factory.mktemp("golden") / "paris")


@pytest.fixture
def dataset(original, tmp_path) -> Path:
    return Path(shutil.copytree(original, tmp_path / "paris"))


@pytest.fixture(scope="session")
def passing(tmp_path_factory) -> Path:
    """A spherical pendulum on an Earth at rest, with its highest points and its passages of a gate."""
    scene = make_scene(
        "spherical_swing",
        pendulum={"length": "10"},
        site={"rotation_rate": "0", "gravity": "9.8", "gravity_is": "effective"},
        release={"x": "3", "y": "1", "vx": "1", "vy": "-2"},
        run={"t_end": "20", "grid_step": "10", "digits": 15, "sections": ["highest", "gate 30"]},
    )
    return write(reference.solve(scene), tmp_path_factory.mktemp("passing") / "spherical_swing")
