"""Where the truth comes from: a dataset that ships, or one that is solved once and cached; never an incomplete one."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
from interruption import gone_within, interrupted
from small_scenes import make_scene

from compare import judge
from compare.score.input_floor import floor_of_what_ships
from compare.truth import Progress, by_function, golden_of, shipping, solves, truth_at
from reference import load, load_scene
from reference.solver.sensitivity import Sensitivity
from reference.system import cache

RUN = {"t_end": "20", "grid_step": "5", "digits": 22}


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("FOUCAULT_CACHE_SAID", "")
    return tmp_path / "cache"


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """A cache that holds the solution of one scene, made once for all tests."""
    folder = tmp_path_factory.mktemp("solved")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FOUCAULT_CACHE", str(folder))
        golden_of(make_scene("mine", pendulum={"length": "5"}, run=RUN))
    return folder


@pytest.fixture
def kept(solved, own_cache):
    """Have the solution in this test's own cache."""
    shutil.copytree(solved, own_cache)


@pytest.mark.parametrize(
    ("inputs", "folder"), [("decimal", "paris"), ("binary64", "paris.binary64")]
)
def test_a_shipped_dataset_is_taken_in_the_reading_asked(inputs, folder, own_cache):
    golden = golden_of(load_scene("paris", [f"inputs={inputs}"]))
    assert golden.path.name == folder
    assert not (own_cache / "golden").exists()


def test_a_dataset_solves_a_scene_only_with_its_inputs_span_and_transits():
    paris = load_scene("paris")
    golden = load("paris")
    assert solves(golden, paris)
    assert solves(golden, paris.with_values(["run.t_end=100", "run.grid_step=7"]))
    for change in (
        "site.latitude=1",
        "inputs=binary64",
        "run.t_end=86401",
        "release.x=0.31",
        "pendulum.drag=1e-9",
    ):
        assert not solves(golden, paris.with_values([change]))
    assert shipping(make_scene("unheard_of")) is None


def test_a_scene_of_the_users_own_is_solved_once_and_kept(own_cache):
    said: list[str] = []
    scene = make_scene("mine", pendulum={"length": "5"}, run=RUN)
    first = golden_of(scene, progress=Progress(said.append))
    again = golden_of(scene, progress=Progress(said.append))
    assert first.path == again.path
    assert first.path.is_relative_to(own_cache)
    assert len(said) == 1
    assert "mine" in said[0]
    renamed = golden_of(
        make_scene("mine", title="other words", pendulum={"length": "5"}, run=RUN),
        progress=Progress(said.append),
    )
    assert renamed.path == first.path


@pytest.mark.usefixtures("kept")
def test_a_damaged_entry_is_solved_again():
    scene = make_scene("mine", pendulum={"length": "5"}, run=RUN)
    path = golden_of(scene).path
    grid = path / "grid.csv"
    grid.write_text(grid.read_text().replace("1", "2", 1))
    said: list[str] = []
    golden_of(scene, progress=Progress(said.append))
    assert len(said) == 1
    load(path)


@pytest.mark.usefixtures("kept")
def test_a_dataset_is_read_once_in_a_process_and_again_when_it_was_touched():
    scene = make_scene("mine", pendulum={"length": "5"}, run=RUN)
    golden = golden_of(scene)
    assert golden_of(scene) is golden
    transits = golden.path / "transits.csv"
    transits.write_bytes(transits.read_bytes())
    again = golden_of(scene)
    assert again is not golden
    assert again.manifest == golden.manifest
    (golden.path / "stranger").touch()
    said: list[str] = []
    assert golden_of(scene, progress=Progress(said.append)).manifest == golden.manifest
    assert said == []
    transits.write_bytes(transits.read_bytes()[:-1])
    assert golden_of(scene, progress=Progress(said.append)).manifest == golden.manifest
    assert len(said) == 1  # damaged, so it was solved again


@pytest.mark.usefixtures("kept")
@pytest.mark.parametrize(
    "kind",
    [
        "full folder",
        "link to nothing",
        pytest.param("file", marks=pytest.mark.long),
        pytest.param("folder", marks=pytest.mark.long),
    ],
)
def test_whatever_is_in_the_way_of_an_entry_is_removed(kind, own_cache):
    scene, times = make_scene("mine", pendulum={"length": "5"}, run=RUN), np.array([0.0, 1.5])
    first, said = truth_at(golden_of(scene), times), list[str]()
    for path in [*(own_cache / "golden").iterdir(), *(own_cache / "dense").iterdir()]:
        cache.discard(path)
        if kind == "file":
            path.write_text("in the way")
        elif kind == "link to nothing":
            path.symlink_to("nothing")
        else:
            path.mkdir()
            if kind == "full folder":
                (path / "thesis.txt").write_text("in the way")
    again = truth_at(golden_of(scene, progress=Progress(said.append)), times)
    assert np.array_equal(again.states, first.states)
    assert len(said) == 1
    assert (
        truth_at(golden_of(scene, progress=Progress(said.append)), times).t.tolist()
        == times.tolist()
    )
    assert len(said) == 1
    for name in ("golden", "dense"):
        assert len(list((own_cache / name).iterdir())) == 1


@pytest.mark.parametrize("place", ["file", "proc"])
def test_a_cache_that_cannot_be_written_costs_time_only(place, tmp_path, monkeypatch, capfd):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    monkeypatch.setenv("FOUCAULT_CACHE", str(blocked) if place == "file" else "/proc/nothing")
    scene = make_scene(f"mine_{place}", pendulum={"length": "5"}, run=RUN)
    golden = golden_of(scene)
    truth = truth_at(golden, np.array([0.0, 1.5]))
    assert truth.states[0, 0] == 0.3
    assert golden_of(scene) is golden
    assert blocked.read_text() == "in the way"
    assert capfd.readouterr().err.count("cannot be written") == 1


def test_the_truth_is_evaluated_once_for_the_same_times(own_cache):
    golden = load("paris")
    times = np.linspace(0, 90, 7)
    first = truth_at(golden, times)
    (entry,) = (own_cache / "dense").iterdir()
    before = entry.stat().st_ino
    again = truth_at(golden, times)
    assert entry.stat().st_ino == before
    for name in ("t", "states", "low"):
        assert np.array_equal(getattr(first, name), getattr(again, name))
    assert (first.bound_m, first.bound_m_s) == (again.bound_m, again.bound_m_s)


def test_the_truth_of_a_scene_that_ships_comes_from_its_function_and_nothing_is_solved(own_cache):
    said: list[str] = []
    for name in ("pole", "over_top", "paris"):
        golden = load(f"{name}.binary64")
        end = golden.function.times[-1]
        t = np.append(np.sort(np.random.default_rng(5).uniform(0, end, 300)), end + 1e-9)
        at = golden.function.at(np.minimum(t, end))
        columns = {"t": t, "x": at.x, "y": at.y, "z": at.z}
        score = judge(columns, name, transits=golden.transits["t"], announce=said.append)
        assert score.agrees
        assert score.transits.matched == golden.manifest.counts.transits
        assert score.errors.max_m <= 1e-9 * score.errors.speed_m_s * 1.01
        assert score.golden.path.name == f"{name}.binary64"
        assert "times the input floor" in str(score) or score.at_bound
    assert said == []
    assert not own_cache.exists()  # what is solved, evaluated or integrated is kept there


def test_where_the_bound_of_the_function_could_change_the_verdict_more_digits_decide():
    golden, t = load("pole.binary64"), np.array([1.5, 30.25, 61.125])
    fine, own = (
        truth_at(golden_of(golden.scene.with_values(["run.t_end=72"])), t),
        by_function(golden, t),
    )
    states, apart = (
        fine.states,
        np.abs((own.states - fine.states) + (own.low - fine.low)).max(axis=0),
    )
    # z is 67 m, and a double of it is off by 7e-15
    assert 0 < apart[:3].max() <= own.bound_m < 2e-15
    assert apart[3:].max() <= own.bound_m_s
    for error, tolerance, alone in (
        (3e-13, 2e-13, True),
        (1e-15, 2e-15, False),
        (2e-15, 1e-15, False),
    ):
        columns = {"t": t, "x": states[:, 0] + error, "y": states[:, 1]}
        score = judge(columns, "pole", tolerance=tolerance, explain=False)
        assert score.golden.manifest.alone is alone
        assert score.agrees is (error < tolerance)
        assert alone or score.errors.bound_m < 1e-19


def test_a_new_scene_is_solved_no_further_than_the_verdict_needs(own_cache):
    scene = make_scene("mine", pendulum={"length": "5"}, run=RUN)
    t = np.array([0.5, 7.25, 19.0])
    states, said = (
        truth_at(golden_of(scene.with_values(["inputs=binary64"])), t).states,
        list[str](),
    )
    shutil.rmtree(own_cache)
    columns = {"t": t, "x": states[:, 0] + 1e-9, "y": states[:, 1]}
    score = judge(columns, scene, announce=said.append)
    assert score.agrees and score.errors.max_m == pytest.approx(1e-9, rel=1e-3)
    assert said == [] and not own_cache.exists()
    assert "input floor" not in str(score)
    for error, tolerance in ((1e-15, 1e-14), (2e-14, 1e-14)):
        columns["x"] = states[:, 0] + error
        score = judge(columns, scene, tolerance=tolerance, explain=False, announce=said.append)
        assert score.agrees is (error < tolerance)
        assert score.errors.bound_m < 1e-19
    assert said == ["no golden dataset has the problem of mine: solving it to 22 digits"]


@pytest.mark.parametrize(
    ("name", "change", "why"),
    [
        ("creeping", "inputs=binary64", "takes 27 MB"),
        ("pole", "inputs=binary64", "does not decide"),
        ("creeping", "site.latitude=1", "no golden dataset"),
    ],
)
def test_of_a_scene_that_ships_it_is_said_why_it_is_solved(name, change, why):
    class Enough(Exception):
        pass

    def stop(message):
        assert why in message
        raise Enough

    with pytest.raises(Enough):
        golden_of(load_scene(name, [change]), progress=Progress(stop))


@pytest.mark.parametrize(
    "name", ["pole", "near_inverted", "conical", "stability_below", "ten_kilometres", "museum"]
)
def test_the_input_floor_of_what_ships_is_that_of_first_order(name):
    scene = load_scene(name)
    end = float(scene.exact.t_end)
    moved = Sensitivity(scene, np.linspace(0, end, 577)).rounding()[:, :3]
    expected = np.sqrt((moved**2).sum(axis=1)).max()
    assert floor_of_what_ships(scene, end) == pytest.approx(expected, rel=0.1)
    assert floor_of_what_ships(scene, 0.0) < 0.5 * expected
    assert floor_of_what_ships(scene.with_values(["site.latitude=12"]), end) is None


def test_an_interrupted_solve_leaves_nothing_half(tmp_path, own_cache):
    own = tmp_path / "long.toml"
    own.write_text('id = "long"\n[release]\nx = "0.3"\ny = "0.4"\n[run]\nt_end = "86400"\n')
    rows = tmp_path / "rows.csv"
    rows.write_text("t,x,y\n0,0.3,0.4\n86400,0.3,0.4\n")
    status, err, group = interrupted(
        ["score", str(own), str(rows), "--tolerance", "1e-20"], lambda _, err: b"solving it" in err
    )
    assert status == 130
    assert b"Traceback" not in err
    assert list(own_cache.glob("golden/*")) == []
    assert gone_within(group, 10)
