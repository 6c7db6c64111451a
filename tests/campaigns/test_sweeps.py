"""Campaigns of sweeps: random rows in both engines against limbs at 110 bits; kills and Ctrl-C in the middle."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from against_limbs import compare
from interruption import gone_within
from places import ROOT
from random_rows import KINDS, random_kinds

from reference.engines.registry import batches

WORDS = ["sweep", "paris", "--t-end", "60", "--audit", "0", "--workers", "1"]
SMALL_PARTS = "import reference.sweeps.request as request; request.PART_S = 0.0; from foucault import main; main()"


@pytest.mark.parametrize("engine", ["heyoka", "octet"])
def test_no_transit_is_lost_and_no_error_is_larger_than_estimated(size, tally, engine):
    *common, over = KINDS
    many = [
        *random_kinds(20261122, size(16, 3000), kinds=tuple(common)),
        *random_kinds(20261123, size(4, 500), kinds=(over,)),
    ]
    found = compare(batches()[engine], many)
    tally(f"sweeps, {engine}: {found}")
    assert not found.miscounted
    assert not found.underestimated


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "rows").glob("part-*.parquet")}


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kills processes")
def test_kills_leave_parts_that_the_same_command_completes(tmp_path, size, tally):
    long, kills, longest = size(0, 1), size(2, 20), size(4, 7)
    grid = ("-90:90:0.18", "0.1:0.5995:0.0005") if long else ("-90:90:10", "0.1:0.58:0.02")
    over = ["--over", f"site.latitude={grid[0]}", "--over", f"release.x={grid[1]}"]
    program = ["foucault.py"] if long else ["-c", SMALL_PARTS]
    command = [sys.executable, *program, *WORDS, *over, "--engine", "octet" if long else "heyoka"]
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    subprocess.run([*command, "--out", whole], check=True, cwd=ROOT, capture_output=True)
    generator, done = random.Random(5), 0
    while True:
        process = subprocess.Popen(
            [*command, "--out", killed], cwd=ROOT, stdout=subprocess.DEVNULL, start_new_session=True
        )
        try:
            process.wait(generator.uniform(1.0, longest) if done < kills else None)
            break
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            done += 1
    tally(f"sweeps: {done} kills, {len(contents(whole))} parts")
    assert len(contents(whole)) > 9
    assert process.returncode == 0
    assert contents(killed) == contents(whole)


# rows side by side, in threads; rows that the solver solves, in processes
WAYS = {
    "threads": ["--over", "site.latitude=-90:90:1", "--engine", "heyoka"],
    "processes": ["--over", "site.latitude=-80:80:4", "--digits", "16", "--want", "transits", "--workers", "2"],
}


@pytest.fixture(scope="module", params=WAYS)
def way(request, tmp_path_factory):
    """A sweep of many parts: its command, and the folder that it fills when nothing stops it."""
    whole = tmp_path_factory.mktemp(request.param) / "whole"
    command = [sys.executable, "-c", SMALL_PARTS, *WORDS, *WAYS[request.param]]
    subprocess.run([*command, "--out", whole], check=True, cwd=ROOT, capture_output=True)
    return command, whole


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="counts processes in /proc")
@pytest.mark.parametrize(
    "number", ["SIGKILL", "SIGINT", *(pytest.param(name, marks=pytest.mark.long) for name in ("SIGTERM", "SIGHUP"))]
)
def test_what_a_sweep_started_ends_with_it_and_the_same_command_goes_on(way, number, tmp_path):
    """The signal reaches the sweep alone, and its processes notice; to the whole group it goes in another test."""
    command, whole = way
    folder = tmp_path / "stopped"
    process = subprocess.Popen(
        [*command, "--out", folder], cwd=ROOT, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    while process.poll() is None and not (contents(folder) if folder.exists() else {}):
        time.sleep(0.01)
    process.send_signal(getattr(signal, number))
    _, err = process.communicate()
    assert gone_within(process.pid, 10.0), "processes run on"
    stopped = getattr(signal, number)
    assert process.returncode == (-stopped if stopped == signal.SIGKILL else 128 + stopped), err
    told = f"foucault: stopped; what is done is in {folder}: `foucault sweep --out {folder}` goes on"
    said = [line for line in err.splitlines() if " rows after " not in line]  # which tells of a busy machine
    assert said == ([told] if stopped == signal.SIGINT else [])
    done = contents(folder)
    assert done and done.items() <= contents(whole).items()
    assert not (folder / "summary.json").exists()
    subprocess.run([*command[:4], "--out", folder], check=True, cwd=ROOT, capture_output=True)
    assert contents(folder) == contents(whole)
    assert (folder / "summary.json").read_bytes() == (whole / "summary.json").read_bytes()
