"""Shooting from row to row: it judges a dataset where no run from the release can, and finds what exceeds 30 bounds."""

from __future__ import annotations

import shutil
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from forgery import bound_of, forge, moved
from sampled import one_in
from small_scenes import make_scene

import reference
from reference.columns import GRID
from reference.dataset.checks import motion, shooting
from reference.dataset.checks.propagation import spreads
from reference.dataset.files import read_files
from reference.dataset.verify import verify
from reference.dataset.write import write
from reference.scene import Scene

WIDE = {"angle": "80", "azimuth": "30", "azimuth_rate": "20"}
SCENES = {
    "small": make_scene(run={"t_end": "300", "digits": 25}),
    "wide": make_scene(pendulum={"length": "1"}, release=WIDE, run={"t_end": "20", "grid_step": "2", "digits": 20}),
    "drag": make_scene(pendulum={"drag": "0.01"}, run={"t_end": "150", "digits": 15}),
}
# the flow magnifies errors some hundred times from row to row
FAST = make_scene(pendulum={"drag": "0.01"}, site={"rotation_rate": "0.01"}, run={"t_end": "250", "digits": 15})

ABOVE = make_scene(
    pendulum={"length": "1"},
    release={"angle": "150", "azimuth": "30"},
    run={"t_end": "2", "grid_step": "0.1", "digits": 15},
)


@pytest.fixture(scope="module", params=SCENES)
def original(request, tmp_path_factory):
    return write(reference.solve(SCENES[request.param]), tmp_path_factory.mktemp("golden") / request.param)


@pytest.fixture
def dataset(original, tmp_path) -> Path:
    return Path(shutil.copytree(original, tmp_path / original.name))


def shot(dataset: Path) -> list[str]:
    return list(shooting.problems(read_files(dataset), seek=True))


def test_an_untouched_dataset_arrives_everywhere(dataset):
    assert shot(dataset) == []


@pytest.mark.parametrize("scene", [FAST, ABOVE], ids=["errors grow", "above the pivot"])
def test_an_untouched_dataset_arrives_all_the_same(tmp_path, scene):
    assert shot(write(reference.solve(scene), tmp_path / "made")) == []


COLUMNS = [*(("grid", name) for name in GRID), *(("transits", name) for name in ("t", "x", "y", "z", "vy"))]


# in each column to one side, to the other under --long
@pytest.mark.parametrize(
    "kind, column, side",
    one_in(2, [(*pair, side) for i, pair in enumerate(COLUMNS) for side in ((1, -1), (-1, 1))[i % 2]]),
)
def test_thirty_bounds_are_found_in_every_column(dataset, kind, column, side):
    def change(rows, header):
        by = side * 30 * bound_of(files, kind, column, 3)
        rows[3][header.index(column)] = moved(rows[3][header.index(column)], by)

    files = read_files(dataset)
    forge(dataset, **{kind: change})
    assert shot(dataset)


@pytest.mark.parametrize("which", [(0, 1), (3, 4), (-2, -1)])
def test_transits_left_out_in_pairs_are_missed(dataset, which):
    def change(rows, _):
        for i in sorted((i % len(rows) for i in which), reverse=True):
            del rows[i]
        for k, row in enumerate(rows, 1):
            row[0] = str(k)

    forge(dataset, transits=change)
    assert any("there is a transit at" in problem for problem in shot(dataset))


def test_a_transit_too_many_is_none_of_the_motions(dataset):
    def change(rows, header):
        last = list(rows[-1])
        t = header.index("t")
        last[t] = moved(last[t], Fraction(1, 10))
        rows.append([str(len(rows) + 1), *last[1:]])

    forge(dataset, transits=change)
    assert any("none of the motion's" in problem for problem in shot(dataset))


def test_verify_shoots_where_the_most_bits_from_the_release_do_not_decide(dataset, monkeypatch):
    monkeypatch.setattr(motion, "_compared", lambda *_: None)
    found = verify(dataset)
    assert (found.problems, found.notes) == ([], [])

    def change(rows, header):
        y = header.index("y")
        rows[2][y] = moved(rows[2][y], 30 * bound_of(read_files(dataset), "grid", "y", 2))

    monkeypatch.setattr("reference.dataset.checks.physics.problems", lambda files: iter(()))
    forge(dataset, grid=change)
    assert any("the row before leads to" in problem for problem in verify(dataset).problems)


def test_bounds_too_wide_to_spread_in_proportion_are_left_alone_and_that_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(motion, "_compared", lambda *_: None)
    scene = make_scene(pendulum={"length": "1"}, release={"x": "0.3", "y": "0.4"}, run={"t_end": "60", "digits": 1})
    (note,) = verify(write(reference.solve(scene), tmp_path / "coarse")).notes
    assert "so wide" in note


def ends(scene: Scene, **release: float) -> np.ndarray:
    """The state after 60 s, of a release changed a little."""
    changed = scene.with_values([f"release.{name}={value!r}" for name, value in release.items()])
    return reference.trajectory(changed, [0.0, 60.0])[-1]


def test_errors_spread_as_differences_of_whole_runs_do():
    """Four columns of the release, each with the error 1, against central differences of runs in double."""
    scene, h = reference.load_scene("paris", ["run.t_end=60"]), 1e-5
    release = {"x": 0.3, "y": 0.4, "vx": 0.0, "vy": 0.0}
    slopes = [
        (ends(scene, **release | {name: value + h}) - ends(scene, **release | {name: value - h})) / (2 * h)
        for name, value in release.items()
    ]
    state = reference.trajectory(scene, [0.0])
    last, most = spreads(scene.exact, state, np.array([1.0, 1, 0, 1, 1, 0]), 60.0)
    assert last[0] == pytest.approx(np.abs(slopes).sum(axis=0), rel=2e-3)
    assert (most >= last).all()
