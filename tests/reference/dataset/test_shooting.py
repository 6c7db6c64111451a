"""Shooting from row to row: it judges a dataset where no run from the release can, and finds what exceeds 30 bounds."""

from __future__ import annotations

import shutil
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType, SimpleNamespace

import numpy as np
import pytest
from forgery import bound_of, forge, moved
from sampled import one_in
from small_scenes import make_scene

import reference
from reference.dataset.checks import motion, shooting
from reference.dataset.checks.propagation import spreads
from reference.dataset.files import read_files
from reference.dataset.sheets import Sheet
from reference.dataset.verify import verify
from reference.dataset.write import write
from reference.numbers.columns import GRID
from reference.numbers.precision import context, fixed_decimal
from reference.scenes.scene import Scene

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


def bounded(bound, length="1", digits=20, **more):
    """Files of which the checks need only the bounds, the scene and the tables."""
    scene = make_scene(pendulum={"length": length}, site={"rotation_rate": "0", "gravity": "10"}, **more)
    return SimpleNamespace(scene=scene, manifest=SimpleNamespace(digits=digits, bound=bound), tables={})


@pytest.mark.parametrize(
    ("position", "digits", "said"),
    [("1", 106, ""), ("1.1", 20, "so wide"), ("1", 107, "it takes more than 386 bits"), ("1.1", 107, "so wide")],
)
def test_a_dataset_is_shot_through_up_to_a_thousandth_of_the_cord_and_the_most_bits(position, digits, said):
    """The bounds on velocities do not matter; 106 and 107 digits are 353 and 356 bits, and 32 more are taken."""
    files = bounded(lambda _, name: Fraction(99 if name.startswith("v") else position), "1000", digits)
    assert shooting.impossible(files).startswith(said) if not said else said in shooting.impossible(files)


def test_each_row_is_shot_to_the_next_and_may_be_off_by_its_bound_and_what_the_last_ones_spread_to(monkeypatch):
    """A bound of 0.01, and errors that spread to 0.1, 0.2 … 0.6, a hundredth of which is slack."""
    files = bounded(lambda *_: Fraction(1, 100), run={"t_end": "25", "grid_step": "10"})
    states = [[Fraction(k, 10) for k in range(row, row + 6)] for row in range(4)]
    files.tables["grid.csv"] = Sheet(GRID, [tuple(str(float(part)) for part in state) for state in states], {})
    spread = np.tile(np.arange(1, 7) / 10, (3, 1))
    monkeypatch.setattr(shooting, "_spreads", lambda *_: (spread, spread))
    monkeypatch.setattr(shooting, "_completed", lambda _, state, ctx: state * (ctx.prec > 99))  # 67 bits, and 32 more

    def said(part, j, side):
        off = side * Fraction(part) * (Fraction(1, 100) + Fraction(101, 1000) * (j + 1))
        shots = []

        def runs_from(inputs, prec, restarts, seek):
            shots.extend(restarts)
            for i, arrived in enumerate(states[1:]):
                ends = {name: [0, part] for name, part in zip(GRID, arrived, strict=True)}
                ends[GRID[j]][-1] += off if i == 1 else 0
                yield SimpleNamespace(grid=SimpleNamespace(exact=ends.__getitem__), transits=None)

        monkeypatch.setattr(shooting, "runs_from", runs_from)
        found = list(shooting.problems(files, seek=False))
        assert shots == list(zip(states, ((0, 10), (0, 10), (0, 5)), strict=False))
        return found

    for j, name in enumerate(GRID):
        for side in (1, -1):
            assert said("0.999", j, side) == []
            (problem,) = said("1.001", j, side)
            assert problem.startswith(f"grid.csv: t = 20: {name} is off by")
            assert problem.endswith("from where the row before leads to, its bound is 0.01")
    monkeypatch.setattr(shooting, "_spreads", lambda *_: (0 * spread, 0 * spread))
    assert said(Fraction(10, 111), 0, 1) == []  # the bound to the last bit


def test_what_the_bounds_spread_to_is_found_row_by_row_whatever_the_blocks(monkeypatch):
    solution = reference.solve(make_scene(run={"t_end": "100", "grid_step": "20", "digits": 10, "level": "computed"}))
    states = [list(row) for row in zip(*(solution.grid.exact(name) for name in GRID), strict=True)]
    times = [*solution.times[:-1], Fraction(85)]
    files = bounded(lambda _, name: Fraction(GRID.index(name) + 1, 1000))
    files.scene = solution.scene
    monkeypatch.setattr(shooting, "BLOCK", 3)
    last, most = shooting._spreads(files, states, times)
    for i, state in enumerate(states[:-1]):
        row, bounds = np.array([[float(part) for part in state]]), np.arange(1, 7) / 1000
        alone = spreads(solution.scene.exact, row, bounds, float(times[i + 1] - times[i]))
        assert (last[i], most[i]) == (pytest.approx(alone[0][0], rel=1e-12), pytest.approx(alone[1][0], rel=1e-12))
    assert len(last) == len(most) == 5


@pytest.mark.parametrize(("z", "completed"), [("-0.7", "-0.8"), ("0.7", "0.8"), ("0.25", None), ("0.26", "0.8")])
def test_a_state_is_completed_where_the_bob_is_a_quarter_of_the_cord_below_or_above_the_pivot(z, completed):
    state = [*map(Fraction, ("0.36", "0.48", z, "1", "-2", "9"))]
    found = shooting._completed(bounded(None), state, context(200))
    if completed is None:
        assert found == state
    else:
        height = Fraction(completed)
        assert [float(part) for part in found] == [
            0.36,
            0.48,
            float(height),
            1.0,
            -2.0,
            float(Fraction("0.6") / height),
        ]


LIMIT = Fraction(1, 100)
STATE = {"x": "0.96", "y": "1.2", "z": "-1.28", "vy": "0.5"}  # of a cord of 2 m; vz = 0.6/1.28 m/s keeps it there
RATES = {"x": 0.0, "y": 0.5, "z": 0.46875, "vx": 3.184734375, "vy": 3.98091796875}  # per s, with g/l = 5/s²
SPREAD = {"x": 0.125, "y": 0.25, "z": 0.375, "vx": 0.5, "vy": 0.625}


def compared(printed, found, edges, state=STATE, off=MappingProxyType({}), spread=None):
    """What is said of transits printed as (t, bound) and found as (t, direction), all in one state."""
    files = bounded(lambda *_: LIMIT, "2")
    exact = {name: Fraction(text) for name, text in state.items()}
    rows = [
        (t, f"{(-1) ** i:+d}", *(fixed_decimal(exact[name] + off.get(name, 0), 30) for name in state), bound)
        for i, (t, bound) in enumerate(printed)
    ]
    files.tables["transits.csv"] = Sheet(("t", "direction", "x", "y", "z", "vy", "bound"), rows, {})
    spread = np.array([*(spread or dict.fromkeys(SPREAD, 0.0)).values(), 0.0])
    zeros = [(Fraction(t), direction, exact, spread) for t, direction in found]
    return list(shooting._transits(files, zeros, [Fraction(t) for t in edges]))


@pytest.mark.parametrize(("part", "said"), [("0.999", False), ("1.001", True)])
@pytest.mark.parametrize("name", ["x", "y", "z", "vy"])
def test_a_number_of_a_transit_may_be_off_by_its_bound_by_what_spreads_and_by_how_late_it_may_be(name, part, said):
    late = 1.01 * SPREAD["vx"] / RATES["vx"]
    limit = LIMIT + Fraction(1.01 * (SPREAD[name] + RATES[name] * late))
    for side in (1, -1):
        off = {name: side * Fraction(part) * limit}
        found = compared([("10", "0.1")], [("10", 1)], ["0", "20"], off=off, spread=SPREAD)
        assert [problem.partition(" is off")[0] for problem in found] == [f"transits.csv: transit 1: {name}"] * said


@pytest.mark.parametrize(("part", "said"), [("0.999", False), ("1.001", True)])
def test_where_the_cord_is_level_the_bob_is_not_taken_to_rise(part, said):
    level = {"x": "1.2", "y": "1.6", "z": "0", "vy": "1"}
    off = {"z": Fraction(part) * (LIMIT + Fraction("1.01") * Fraction("0.375"))}
    assert bool(compared([("10", "9")], [("10", 1)], ["0", "20"], level, off, SPREAD)) is said
    off = {"vy": Fraction(part) * (LIMIT + Fraction(1.01 * (0.625 + 0.8 / 0.6 * 1.01 * 0.5)))}
    assert bool(compared([("10", "9")], [("10", 1)], ["0", "20"], level, off, SPREAD)) is said


@pytest.mark.parametrize(("part", "said"), [("0.999", False), ("1.001", True)])
def test_the_time_of_a_transit_may_be_off_by_its_bound_and_by_how_late_it_may_be(part, said):
    late = Fraction(1.01 * SPREAD["vx"] / RATES["vx"])
    for side in (1, -1):
        t = str(10 + side * Fraction(part) * (Fraction("0.25") + late))
        found = compared([("10", "0.25"), ("20", "0.25")], [(t, 1), ("20", -1)], ["0", "40"], spread=SPREAD)
        assert [problem.startswith("transits.csv: there is a transit at t = ") for problem in found] == [True] * said


THREE = [("10", "0.25"), ("20", "0.25"), ("30", "0.25")]


@pytest.mark.parametrize(
    ("found", "edges", "said"),
    [
        ([("10", 1), ("20", -1), ("30", 1)], ["0", "40"], ""),
        ([("10", 1), ("20.25", -1), ("29.75", 1)], ["0", "40"], ""),
        ([("10", 1), ("20", 1), ("30", 1)], ["0", "40"], "transit 2: its direction is +1"),
        ([("10", 1), ("20", -1)], ["0", "40"], "transit 3 at t = 30 s is none of the motion's"),
        ([("10", 1), ("15", -1), ("20", -1), ("30", 1)], ["0", "40"],
         "there is a transit at t = 15, transit 2 is another or none"),
        ([("10", 1), ("20", -1), ("30", 1), ("35", -1)], ["0", "40"],
         "there is a transit at t = 35, transit 4 is another or none"),
        ([("10", 1), ("15", -1), ("20", -1), ("30", 1)], ["0", "15", "40"], ""),  # a row's error may make or take one
        ([("10", 1), ("20", -1), ("30", 1), ("35", -1)], ["0", "35"], ""),
        ([("10", 1), ("10.25", 1), ("20", -1), ("20.25", -1), ("30", 1), ("30.25", 1)],
         ["0", "10.25", "20.25", "30.25"], ""),  # from the row before and from the row after
        ([("10", 1), ("20", -1), ("20.25", -1), ("30", 1)], ["0", "20", "40"],
         "there is a transit at t = 20.25, transit 3 is another or none"),
    ],
)  # fmt: skip
def test_the_zeros_found_are_the_transits_in_order_but_near_a_row(found, edges, said):
    assert compared(THREE, found, edges) == [f"transits.csv: {said}"] * bool(said)


def test_a_number_of_a_transit_may_be_off_by_its_bound_to_the_last_bit():
    zeros = [("10", 1), ("20", -1), ("30", 1)]
    assert compared(THREE, zeros, ["0", "40"], off=dict.fromkeys(STATE, LIMIT)) == []


def test_a_zero_found_on_both_sides_of_a_row_is_not_taken_for_the_next_transit():
    """The next one's bound reaches over it; the bound of the one before does not reach as far as its own."""
    printed = [("10", "0.01"), ("20", "0.125"), ("20.25", "0.25"), ("30", "0.01")]
    found = [("10", 1), ("20", -1), ("20.125", -1), ("20.25", 1), ("30", -1)]
    assert compared(printed, found, ["0", "20.125", "20.25", "40"]) == []
