"""The workflow that others copy: it is YAML, and the command in it is one that this version takes."""

from __future__ import annotations

import re
import shlex
import tomllib

import numpy as np
import pytest
from places import ROOT

from reference import load, scene_ids

PAGE = (ROOT / "docs/github-workflow.yml").read_text(encoding="utf-8")


def test_it_is_a_workflow():
    yaml = pytest.importorskip("yaml")
    steps = yaml.safe_load(PAGE)["jobs"]["score"]["steps"]
    assert any("foucault score --suite" in step.get("run", "") for step in steps)


def test_it_installs_the_tag_of_this_version_and_nothing_that_has_the_name_elsewhere():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    values = dict(re.findall(r"^  (REFERENCE|VERSION): \"?([^\"\n]+)", PAGE, re.M))
    assert values == {
        "REFERENCE": project["urls"].get("Repository", "https://…"),
        "VERSION": f"v{project['version']}",
    }
    (install,) = re.findall(r"run: pip install (.+)", PAGE)
    requirement = (
        install.strip('"')
        .replace("$REFERENCE", values["REFERENCE"])
        .replace("$VERSION", values["VERSION"])
    )
    extras, address = re.fullmatch(r"foucault-reference\[(.+)\] @ git\+(.+)", requirement).groups()
    assert set(extras.split(",")) <= project["optional-dependencies"].keys()
    assert address == f"{values['REFERENCE']}@{values['VERSION']}"


def test_its_command_runs_and_its_scenes_are_there(foucault, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (scenes,) = re.findall(r"for scene in (.+); do", PAGE)
    assert set(scenes.split()) <= set(scene_ids())
    (command,) = re.findall(r"run: foucault (score .+)", PAGE)
    golden = load("paris.binary64")
    (tmp_path / "suite").mkdir()
    np.savez(tmp_path / "suite/paris.npz", t=golden.t, x=golden.x, y=golden.y)
    status, out, _ = foucault(*shlex.split(command))
    assert status == 0
    assert "paris.npz agrees with paris (1441 rows, t = 0 to 86400 of 86400 s: 100 %)" in out
    assert (tmp_path / "foucault.xml").is_file() and (tmp_path / "page/badge.svg").is_file()


def test_every_night_all_commands_run_in_a_base_install():
    yaml = pytest.importorskip("yaml")
    jobs = yaml.safe_load((ROOT / ".github/workflows/nightly.yml").read_text(encoding="utf-8"))[
        "jobs"
    ]
    *_, install, run, run_without_heyoka = jobs["base"]["steps"]
    assert install["run"].endswith("pip install .")  # no extra
    assert (ROOT / run["run"].split()[-1]).is_file()
    assert run_without_heyoka["run"].endswith(f"uninstall -y heyoka && {run['run']}")


def test_the_workflow_of_the_project_itself_calls_what_there_is():
    yaml = pytest.importorskip("yaml")
    jobs = yaml.safe_load((ROOT / ".github/workflows/checks.yml").read_text(encoding="utf-8"))[
        "jobs"
    ]
    assert set(jobs) == {"lint", "tests", "bytes"}
    assert jobs["bytes"]["strategy"]["matrix"]["machine"] == ["ubuntu-24.04", "ubuntu-24.04-arm"]
    commands = [step["run"] for job in jobs.values() for step in job["steps"] if "run" in step]
    targets = re.findall(r"^([\w./-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M)
    nightly = yaml.safe_load((ROOT / ".github/workflows/nightly.yml").read_text(encoding="utf-8"))[
        "jobs"
    ]
    by_night = [step["run"] for job in nightly.values() for step in job["steps"] if "run" in step]
    assert {"make test", "make campaign", "make peers"} <= {*commands, *by_night}
    assert {
        command.split()[1] for command in commands + by_night if command.startswith("make ")
    } <= set(targets)
    (verify,) = (command.split() for command in commands if "verify" in command)
    assert verify[:3] == [".venv/bin/foucault", "verify", "--recompute"] and set(verify[3:]) <= set(
        scene_ids()
    )
