"""`generate --all`: the same bytes as one by one, gone on with, and a scene that fails costs only itself."""

from __future__ import annotations

import json
import shutil
import signal
from concurrent.futures import Future
from pathlib import Path

import failing_datasets
import pytest
from typer.testing import CliRunner

from foucault import commands
from reference.commands.generate_all import is_done, jobs
from reference.scenes.shipped import data_root, index, scene_ids, seals

SHORT = ("--t-end", "60", "--digits", "10", "--level", "computed")
FEW = ["conical", "pantheon", "paris"]


def ship_few(monkeypatch):
    monkeypatch.setattr("reference.commands.generate_all.scene_ids", lambda: FEW)
    monkeypatch.setattr("reference.commands.generate_all.seals", dict)


@pytest.fixture
def few(monkeypatch):
    """Have three scenes ship, and no seals."""
    ship_few(monkeypatch)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The datasets of three scenes, made by two workers, and what was said of them."""
    out = tmp_path_factory.mktemp("everything") / "all"
    with pytest.MonkeyPatch.context() as patch:
        ship_few(patch)
        words = ["generate", "--all", *SHORT, "--workers", "2", "--out", str(out), "--json"]
        said = CliRunner().invoke(commands(), words)
    assert said.exit_code == 0, said.output
    return out, json.loads(said.stdout)


class Here:
    """A pool that works in this process, for tests of what is made and not of how."""

    def __init__(self, workers):
        assert workers == 1

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def submit(self, work, *arguments):
        done = Future()
        done.set_result(work(*arguments))
        return done


@pytest.fixture
def here(monkeypatch):
    monkeypatch.setattr("reference.commands.generate_all.Pool", Here)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_all_that_ships_is_asked_for(tmp_path):
    names = {job.name for job in jobs((), tmp_path)}
    assert names == {*scene_ids(), *seals()}
    spans = [job.scene.exact.t_end for job in jobs((), None)]
    assert spans == sorted(spans, reverse=True)


def test_what_ships_is_done_and_what_was_changed_is_not(size):
    shipped, every = {job.name: job for job in jobs((), None)}, size(4, 1)
    assert all(is_done(shipped[name]) for name in [*seals()][::every])
    assert not any(is_done(job) for job in jobs(("run.t_end=7",), None)[::every])
    missing = [job for name, job in shipped.items() if name not in seals()]
    assert not any(is_done(job) for job in missing)


def test_each_dataset_has_the_bytes_that_generate_gives_it_alone(foucault, made, tmp_path):
    out, document = made
    assert [row["dataset"] for row in document["rows"]] == FEW
    assert {row["status"] for row in document["rows"]} == {"ok"}
    assert (document["datasets"], document["sealed_before"], document["failed"]) == (3, 0, 0)
    for name in FEW:
        assert foucault("generate", name, *SHORT, "--out", tmp_path / name)[0] == 0
        assert contents(out / name) == contents(tmp_path / name)


@pytest.mark.usefixtures("few", "here")
def test_it_goes_on_with_what_is_missing_or_damaged(foucault, made, tmp_path, monkeypatch):
    out = Path(shutil.copytree(made[0], tmp_path / "all"))
    before = contents(out / "paris"), contents(out / "conical")
    (out / "paris" / "grid.csv").write_text("t,x\n")
    (out / ".conical.partial-abc").mkdir()  # of a command that was killed once it had put the dataset in place
    kept = (out / "conical" / "manifest.json").stat()
    status, text, _ = foucault("generate", "--all", *SHORT, "--out", out)
    assert status == 0
    assert "3 datasets: 2 were there, 1 made, 0 failed" in text
    assert (contents(out / "paris"), contents(out / "conical")) == before
    assert sorted(path.name for path in out.iterdir()) == FEW
    assert (out / "conical" / "manifest.json").stat().st_mtime_ns == kept.st_mtime_ns
    # other inputs are another dataset
    monkeypatch.setattr("reference.commands.generate_all.scene_ids", lambda: FEW[2:])
    status, text, _ = foucault("generate", "--all", "--t-end", "120", *SHORT[2:], "--out", out)
    assert (status, "1 made" in text) == (0, True)


@pytest.mark.usefixtures("few")
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kills processes")
def test_a_scene_that_fails_costs_only_itself(foucault, tmp_path, monkeypatch):
    monkeypatch.setattr("reference.commands.generate_all.made", failing_datasets.made)
    words = ("generate", "--all", *SHORT, "--workers", 1, "--out", tmp_path / "all", "--json")
    status, out, err = foucault(*words)
    assert status == 1
    found = {row["dataset"]: (row["status"], bool(row["reason"])) for row in json.loads(out)["rows"]}
    assert found == {"conical": ("crashed", True), "pantheon": ("unreachable", True), "paris": ("ok", False)}
    assert "2 of 3 datasets failed" in err
    assert [path.name for path in (tmp_path / "all").iterdir()] == ["paris"]
    # what is left is out of reach alone
    monkeypatch.setattr("reference.commands.generate_all.scene_ids", lambda: FEW[1:])
    monkeypatch.setattr("reference.commands.generate_all.Pool", Here)
    assert foucault(*words)[0] == 3


@pytest.mark.usefixtures("few")
def test_a_cluster_makes_the_same_bytes(foucault, tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("reference.commands.generate_all.scene_ids", lambda: ["paris"])
    status, _, err = foucault("generate", "--all", *SHORT, "--cluster", "local:1", "--out", tmp_path / "there")
    assert status == 0, err
    assert foucault("generate", "paris", *SHORT, "--out", tmp_path / "here")[0] == 0
    assert contents(tmp_path / "there" / "paris") == contents(tmp_path / "here")


@pytest.mark.usefixtures("here")
def test_a_seal_of_a_dataset_that_ships_is_kept(foucault, tmp_path, monkeypatch):
    data = tmp_path / "data"
    shutil.copytree(data_root() / "scenes", data / "scenes")
    shutil.copy(data_root() / "flags.toml", data)
    (data / "golden").mkdir()
    monkeypatch.setattr("reference.scenes.shipped.data_root", lambda: data)
    monkeypatch.setattr("reference.commands.generate_all.scene_ids", lambda: FEW[1:])
    foucault("generate", "--all", *SHORT, "--out", data / "golden", "--workers", 1)
    assert sorted(seals()) == FEW[1:]
    assert "2 were there" in foucault("generate", "--all", *SHORT, "--out", data / "golden")[1]
    (data / "golden" / "index.json").write_text(json.dumps(index() | {"paris": {**index()["paris"], "seal": "0" * 64}}))
    assert "1 were there, 1 made" in foucault("generate", "--all", *SHORT, "--out", data / "golden")[1]


@pytest.mark.parametrize(
    ("words", "field"),
    [
        (("--all", "paris"), "SCENE"),
        (("--all", "--set", "site.latitude=0"), "--set"),
        (("--all", "--engine", "limbs"), "--engine"),
        (("--all", "--no-transits"), "--no-transits"),
        (("--all", "--workers", "0"), "--workers"),
        (("--all", "--workers", "1", "--cluster", "local:1"), "--workers"),
        (("--all", "--digits", "0"), "run.digits"),
        (("paris", "--workers", "1"), "--workers"),
        (("paris", "--cluster", "local:1"), "--cluster"),
        ((), "SCENE"),
    ],
)
def test_options_that_would_have_no_effect_are_refused(foucault, words, field):
    status, out, err = foucault("generate", *words)
    assert (status, out) == (2, "")
    assert field in err
