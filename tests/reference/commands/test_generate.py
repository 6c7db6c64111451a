"""`generate --all`: the same bytes as one by one, gone on with, and a scene that fails costs only itself."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from own_project import environment_of, foucault_of, own_project

from reference.commands.generate_all import is_done, jobs
from reference.scenes.shipped import scene_ids, seals

SHORT = ("--t-end", "60", "--digits", "10", "--level", "computed")
FEW = ["conical", "pantheon", "paris"]


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A project with which three scenes come, and no datasets."""
    return own_project(tmp_path_factory.mktemp("project") / "own", FEW)


@pytest.fixture(scope="module")
def made(project, tmp_path_factory):
    """The datasets of three scenes, made by two workers, and what was said of them."""
    out = tmp_path_factory.mktemp("everything") / "all"
    said = foucault_of(
        project, "generate", "--all", *SHORT, "--workers", "2", "--out", out, "--json"
    )
    assert said.returncode == 0, said.stderr
    return out, json.loads(said.stdout)


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


def test_it_goes_on_with_what_is_missing_or_damaged(project, made, tmp_path):
    out = Path(shutil.copytree(made[0], tmp_path / "all"))
    before = contents(out / "paris"), contents(out / "conical")
    (out / "paris" / "grid.csv").write_text("t,x\n")
    # of a command that was killed once it had put the dataset in place
    (out / ".conical.partial-abc").mkdir()
    kept = (out / "conical" / "manifest.json").stat()
    done = foucault_of(project, "generate", "--all", *SHORT, "--out", out)
    assert (done.returncode, done.stderr) == (0, "")
    assert "3 datasets: 2 were there, 1 made, 0 failed" in done.stdout
    assert (contents(out / "paris"), contents(out / "conical")) == before
    assert sorted(path.name for path in out.iterdir()) == FEW
    assert (out / "conical" / "manifest.json").stat().st_mtime_ns == kept.st_mtime_ns
    # other inputs are another dataset
    done = foucault_of(project, "generate", "--all", "--t-end", "120", *SHORT[2:], "--out", out)
    assert (done.returncode, "0 were there, 3 made" in done.stdout) == (0, True)


def replace_in(path, *pairs):
    text = path.read_text()
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)


def children(command):
    lists = Path(f"/proc/{command.pid}/task").glob("*/children")
    return [int(child) for path in lists for child in path.read_text().split()]


def kill_the_solving_worker(command, but=0):
    """Kill the process that solves, once it has loaded heyoka; return its id."""
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        for child in children(command):
            if child != but and "heyoka" in Path(f"/proc/{child}/maps").read_text():
                os.kill(child, signal.SIGKILL)
                return child
        time.sleep(0.02)
    raise AssertionError("no worker began")


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="looks for the worker in /proc")
def test_a_scene_that_fails_costs_only_itself(tmp_path):
    """The first is killed at its millions of steps; the second needs too many to begin."""
    project, out = own_project(tmp_path / "own", FEW), tmp_path / "all"
    replace_in(
        project / "data/scenes/conical.toml", ("rotation_rate = ", 'rotation_rate = "20"  # ')
    )
    replace_in(project / "data/scenes/pantheon.toml", ("[pendulum]", '[pendulum]\ndrag = "1e9"'))
    words = ["generate", "--all", *SHORT, "--workers", "1", "--out", str(out), "--json"]
    command = [sys.executable, "-m", "foucault", *words]
    with subprocess.Popen(
        command,
        cwd=project,
        env=environment_of(project),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        first = kill_the_solving_worker(process)
        kill_the_solving_worker(process, but=first)  # what dies is tried once more
        said, err = process.communicate()
    assert process.returncode == 1
    found = {
        row["dataset"]: (row["status"], bool(row["reason"])) for row in json.loads(said)["rows"]
    }
    assert found == {
        "conical": ("crashed", True),
        "pantheon": ("unreachable", True),
        "paris": ("ok", False),
    }
    assert "2 of 3 datasets failed" in err
    assert [path.name for path in out.iterdir()] == ["paris"]
    # what is left is out of reach alone
    (project / "data/scenes/conical.toml").unlink()
    assert foucault_of(project, *words).returncode == 3


@pytest.mark.long
def test_a_cluster_makes_the_same_bytes(foucault, tmp_path):
    pytest.importorskip("distributed")
    project = own_project(tmp_path / "own", ["paris"])
    done = foucault_of(
        project, "generate", "--all", *SHORT, "--cluster", "local:1", "--out", tmp_path / "there"
    )
    assert done.returncode == 0, done.stderr
    assert foucault("generate", "paris", *SHORT, "--out", tmp_path / "here")[0] == 0
    assert contents(tmp_path / "there" / "paris") == contents(tmp_path / "here")


@pytest.mark.usefixtures("made")
def test_the_seal_of_a_dataset_that_ships_is_kept_and_of_no_other(project):
    golden = project / "data/golden"
    assert [*golden.iterdir()] == []  # what was made elsewhere has none
    words = ("generate", "--all", *SHORT, "--out", golden)
    assert "0 were there, 3 made" in foucault_of(project, *words).stdout
    index = json.loads((golden / "index.json").read_text())
    manifests = {name: json.loads((golden / name / "manifest.json").read_text()) for name in FEW}
    assert index == {
        name: {"seal": manifests[name]["seal"], "options": "--engine heyoka"} for name in FEW
    }
    (golden / "index.json").write_text(
        json.dumps(index | {"paris": {**index["paris"], "seal": "0" * 64}})
    )
    assert "2 were there, 1 made" in foucault_of(project, *words).stdout


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
