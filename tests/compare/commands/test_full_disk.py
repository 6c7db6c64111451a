"""A disk without room for a picture, stdout or the cache; the formats are in tests/campaigns/test_full_disk.py."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from disks import fill, small_disk
from places import ROOT

STUDY = ["study", "paris", "--t-end", "60", "--methods", "rk4", "--no-formulations"]


@pytest.fixture
def disk(tmp_path):
    with small_disk(tmp_path / "disk", 1 << 19) as folder:
        yield folder


@pytest.fixture
def candidate(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text("t,x,y\n0,0.3,0.4\n60,0.1,0.1\n")
    return path


def refused(outcome: tuple[int, str, str], field: str) -> bool:
    status, _, err = outcome
    assert "No space left on device" in err
    *notices, message = err.splitlines()
    assert message.startswith(f"foucault: {field}: ")
    # how long it will take, on a slow machine
    return status == 2 and all(": about " in line for line in notices)


def test_a_picture_stays_as_it_was(disk, foucault, candidate):
    pytest.importorskip("matplotlib")
    (disk / "picture.svg").write_text("years of work")
    fill(disk)
    assert refused(
        foucault("score", "paris", candidate, "--no-diagnosis", "--plot", disk / "picture.svg"),
        "--plot",
    )
    assert (disk / "picture.svg").read_text() == "years of work"
    assert sorted(os.listdir(disk)) == ["filler", "picture.svg"]


def test_a_score_stands_when_its_cache_is_full(disk, foucault, candidate, tmp_path, monkeypatch):
    disk.chmod(0o700)
    words = [
        "score",
        "paris",
        candidate,
        "--json",
        "--no-diagnosis",
        "--set",
        "site.latitude=40",
        "--set",
        "run.t_end=60",
    ]
    monkeypatch.setenv("FOUCAULT_CACHE_SAID", "")
    monkeypatch.setenv("FOUCAULT_CACHE", str(tmp_path / "cache"))
    good = foucault(*words)
    monkeypatch.setenv("FOUCAULT_CACHE", str(disk))
    fill(disk)
    status, out, err = foucault(*words)
    assert (status, json.loads(out)) == (good[0], json.loads(good[1]))
    (warned,) = err.splitlines()
    assert "No space left on device" in warned


@pytest.mark.long  # without a cache all is compiled again
def test_a_study_on_a_full_cache_says_so_once(disk, tmp_path):
    """Its children would each find out for themselves."""
    pytest.importorskip("numba")
    disk.chmod(0o700)
    fill(disk)
    environment = {
        **os.environ,
        "FOUCAULT_CACHE": str(disk),
        "TMPDIR": str(tmp_path),
        "FOUCAULT_CACHE_SAID": "",
    }
    words = [*STUDY[:4], "--methods", "rk4,rkng56", "--no-formulations", "--json"]
    command = [sys.executable, "-m", "foucault", *words]
    done = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert {row["status"] for row in json.loads(done.stdout)["rows"]} <= {
        "ok",
        "missed_transits",
        "extrapolated",
    }
    warnings = [line for line in done.stderr.splitlines() if line.startswith("foucault: ")]
    assert len(warnings) == 1  # beside it the line of a long run, if this one is long
    assert f"{disk / 'generated'} cannot be written (No space left on device)" in warnings[0]
    assert [path.name for path in tmp_path.iterdir()] == ["disk"]


@pytest.mark.parametrize("words", ["scenes", pytest.param("pend -T 10", marks=pytest.mark.long)])
def test_stdout_on_a_full_disk_is_a_message(words):
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-m", "foucault", *words.split()]
        done = subprocess.run(
            command, cwd=ROOT, stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert (done.returncode, done.stderr) == (2, "foucault: output: No space left on device\n")


def test_output_that_nobody_reads_ends_with_a_status_of_its_own():
    """1 would say that a check failed."""
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "foucault", "scenes"]
    done = subprocess.run(
        command, cwd=ROOT, stdout=writing, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, "")


def test_an_error_that_nobody_expects_names_its_file(foucault, tmp_path):
    journal = tmp_path / "rows.jsonl"
    journal.symlink_to("nowhere")
    assert foucault("verify", tmp_path) == (
        2,
        "",
        f"foucault: {journal}: No such file or directory\n",
    )
