"""A disk without room: a message and exit status 2 where a result was to be written, time alone where it is a cache."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from disks import fill, small_disk
from here import measured_here
from places import ROOT

import reference

SMALL = ["paris", "--t-end", "60", "--digits", "10", "--level", "computed"]
STUDY = ["study", "paris", "--t-end", "60", "--methods", "rk4", "--no-formulations"]
STABILITY = ["stability", "--scenes", "hard", "--methods", "heyoka_double"]


@pytest.fixture
def disk(tmp_path):
    with small_disk(tmp_path / "disk", 1 << 19) as folder:
        yield folder


@pytest.fixture
def here(monkeypatch):
    pytest.importorskip("numba")
    measured_here(monkeypatch)


@pytest.fixture
def candidate(tmp_path):
    path = tmp_path / "mine.csv"
    path.write_text("t,x,y\n0,0.3,0.4\n60,0.1,0.1\n")
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def refused(outcome: tuple[int, str, str], field: str) -> bool:
    status, _, err = outcome
    assert "No space left on device" in err
    *notices, message = err.splitlines()
    assert message.startswith(f"foucault: {field}: ")
    return status == 2 and all(": about " in line for line in notices)  # how long it will take, on a slow machine


def test_generate_keeps_the_old_dataset(disk, foucault):
    out = disk / "p"
    assert foucault("generate", *SMALL, "--out", out)[0] == 0
    before = contents(out)
    fill(disk)
    assert refused(foucault("generate", *SMALL, "--out", out), "--out")
    assert contents(out) == before
    assert sorted(os.listdir(disk)) == ["filler", "p"]
    reference.load(out)


def test_generate_finds_out_at_any_file(disk, foucault):
    """Room for nothing, for a part of the dataset, for more of it: nothing of it is left."""
    assert foucault("generate", *SMALL, "--out", disk / "p")[0] == 0
    shutil.rmtree(disk / "p")
    fill(disk)
    for room in range(0, 5 * 4096, 4096):
        os.truncate(disk / "filler", (disk / "filler").stat().st_size - (room and 4096))
        assert refused(foucault("generate", *SMALL, "--out", disk / "p"), "--out")
        assert os.listdir(disk) == ["filler"]


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("words", [STUDY, pytest.param(STABILITY, marks=pytest.mark.long)], ids=["study", "stability"])
def test_a_campaign_ends_with_a_message(words, disk, foucault):
    fill(disk)
    assert refused(foucault(*words, "--out", disk / "report"), "--out")


@pytest.mark.usefixtures("here")
def test_a_report_stays_as_it_was(disk, foucault):
    assert foucault(*STUDY, "--out", disk / "report")[0] == 0
    before = contents(disk / "report")
    fill(disk)
    assert refused(foucault(*STUDY, "--out", disk / "report"), "--out")
    assert contents(disk / "report") == before


def test_the_papers_page_is_written_whole_or_not_at_all(disk, foucault, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("compare.papers.rows", lambda report: [])
    monkeypatch.setattr("compare.papers.figures.FIGURES", {})
    monkeypatch.setattr("compare.papers.papers_page.FIGURES", {})
    fill(disk)
    assert refused(foucault("paper", "--out", disk / "page"), "--out")
    assert os.listdir(disk) in (["filler"], ["filler", "page"], ["page", "filler"])
    assert not (disk / "page").exists() or os.listdir(disk / "page") == []


def test_a_picture_stays_as_it_was(disk, foucault, candidate):
    pytest.importorskip("matplotlib")
    (disk / "picture.svg").write_text("years of work")
    fill(disk)
    assert refused(foucault("score", "paris", candidate, "--no-diagnosis", "--plot", disk / "picture.svg"), "--plot")
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
    environment = {**os.environ, "FOUCAULT_CACHE": str(disk), "TMPDIR": str(tmp_path), "FOUCAULT_CACHE_SAID": ""}
    words = [*STUDY[:4], "--methods", "rk4,rkng56", "--no-formulations", "--json"]
    command = [sys.executable, "-m", "foucault", *words]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert {row["status"] for row in json.loads(done.stdout)["rows"]} <= {"ok", "missed_transits", "extrapolated"}
    warnings = [line for line in done.stderr.splitlines() if line.startswith("foucault: ")]
    assert len(warnings) == 1  # beside it the line of a long run, if this one is long
    assert f"{disk / 'generated'} cannot be written (No space left on device)" in warnings[0]
    assert [path.name for path in tmp_path.iterdir()] == ["disk"]


@pytest.mark.parametrize("words", ["scenes", pytest.param("pend -T 10", marks=pytest.mark.long)])
def test_stdout_on_a_full_disk_is_a_message(words):
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-m", "foucault", *words.split()]
        done = subprocess.run(command, cwd=ROOT, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, "foucault: output: No space left on device\n")


def test_output_that_nobody_reads_ends_with_a_status_of_its_own():
    """1 would say that a check failed."""
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "foucault", "scenes"]
    done = subprocess.run(command, cwd=ROOT, stdout=writing, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, "")


def test_an_error_that_nobody_expects_names_its_file(foucault, monkeypatch, tmp_path):
    def fail(*_: object) -> None:
        raise PermissionError(13, "Permission denied", str(tmp_path / "scenes.toml"))

    monkeypatch.setattr("reference.commands.show.load_scene", fail)
    assert foucault("show", "paris") == (2, "", f"foucault: {tmp_path / 'scenes.toml'}: Permission denied\n")
