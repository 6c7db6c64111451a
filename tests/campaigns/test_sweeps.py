"""Campaigns of sweeps: random rows in both engines against limbs at 110 bits; kills and Ctrl-C in the middle."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest
from against_limbs import compare
from interruption import gone_within, stderr_of
from places import ROOT
from random_rows import KINDS, random_kinds

from reference.engines.registry import batches
from reference.scenes.scene import load_scene
from reference.sweeps.store import Store
from reference.sweeps.sweep import asked_for, run

GO_ON = [sys.executable, "foucault.py", "sweep", "--workers", "1", "--out"]
WORDS = ["sweep", "paris", "--t-end", "60", "--audit", "0", "--workers", "1"]
SMALL_PARTS = """import reference.sweeps.request as request
from foucault import main
request.PART_S, request.LEAST_PART = 0.0, 2
main()"""


@pytest.mark.long  # shorter runs of every kind in every run: tests/reference/sweeps/test_estimate.py
@pytest.mark.parametrize("engine", ["heyoka", "octet"])
def test_no_transit_is_lost_and_no_error_is_larger_than_estimated(tally, engine):
    *common, over = KINDS
    many = [*random_kinds(20261122, 3000, kinds=tuple(common)), *random_kinds(20261123, 500, kinds=(over,))]
    found = compare(batches()[engine], many)
    tally(f"sweeps, {engine}: {found}")
    assert not found.miscounted
    assert not found.underestimated


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in (folder / "rows").glob("part-*.parquet")}


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="kills processes")
@pytest.mark.long  # the next test kills one after its first part in every run
def test_kills_leave_parts_that_the_same_command_completes(tmp_path, tally):
    over = ["--over", "site.latitude=-90:90:0.18", "--over", "release.x=0.1:0.5995:0.0005"]
    command = [sys.executable, "foucault.py", *WORDS, *over, "--engine", "octet"]
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    subprocess.run([*command, "--out", whole], check=True, cwd=ROOT, capture_output=True)
    generator, done = random.Random(5), 0
    while True:
        process = subprocess.Popen(
            [*command, "--out", killed], cwd=ROOT, stdout=subprocess.DEVNULL, start_new_session=True
        )
        try:
            process.wait(generator.uniform(1.0, 7.0) if done < 20 else None)
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
    "threads": ("-45:45:1", {"engine": "heyoka"}),
    "processes": ("-52:52:26", {"digits": 16, "want": ("transits",)}),
}
MANY_DIGITS = {"many digits": ("-80:80:4", {"digits": 32})}


@pytest.fixture(scope="module")
def way(request, tmp_path_factory):
    """A sweep of many parts: what begins it in a folder, and the folder that it fills when nothing stops it."""
    latitudes, options = (WAYS | MANY_DIGITS)[request.param]
    whole, scene = tmp_path_factory.mktemp(request.param) / "whole", load_scene("paris", ["run.t_end=60"])

    def begun(folder):
        asked = asked_for(scene, [f"site.latitude={latitudes}"], None, folder, audit=0, **options)
        small = replace(asked, rows_per_part=2)
        Store.begun(folder, small)
        return small

    run(begun(whole), whole, workers=1)
    return begun, whole


# each way and each kind of end in every run
ENDS = [
    *(("threads", "SIGINT"), ("processes", "SIGKILL")),
    *(
        pytest.param(*case, marks=pytest.mark.long)
        for case in (("threads", "SIGKILL"), ("processes", "SIGINT"), *product(WAYS, ("SIGTERM", "SIGHUP")))
    ),
]


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="counts processes in /proc")
@pytest.mark.parametrize(("way", "number"), ENDS, indirect=["way"])
def test_what_a_sweep_started_ends_with_it_and_the_same_command_goes_on(way, number, foucault, tmp_path):
    """The signal reaches the sweep alone, and its processes notice; to the whole group it goes in another test."""
    begun, whole = way
    folder = tmp_path / "stopped"
    begun(folder)
    process = subprocess.Popen(
        [*GO_ON, folder], cwd=ROOT, stderr=subprocess.PIPE, text=True, start_new_session=True,
        env=os.environ | {"PYTHONFAULTHANDLER": "1"},
    )  # fmt: skip
    while process.poll() is None and not contents(folder):
        time.sleep(0.01)
    process.send_signal(getattr(signal, number))
    err = stderr_of(process)
    assert gone_within(process.pid, 10.0), "processes run on"
    stopped = getattr(signal, number)
    assert process.returncode == (-stopped if stopped == signal.SIGKILL else 128 + stopped), err
    told = f"foucault: stopped; what is done is in {folder}: `foucault sweep --out {folder}` goes on"
    said = [line for line in err.splitlines() if " rows after " not in line]  # which tells of a busy machine
    assert said == ([told] if stopped == signal.SIGINT else [])
    done = contents(folder)
    assert done and done.items() <= contents(whole).items()
    assert not (folder / "summary.json").exists()
    assert foucault("sweep", "--workers", 1, "--out", folder)[0] == 0
    assert contents(folder) == contents(whole)
    assert (folder / "summary.json").read_bytes() == (whole / "summary.json").read_bytes()


def children(parent: int) -> list[int]:
    """Return the processes that a process has started."""
    return [int(word) for path in Path(f"/proc/{parent}/task").glob("*/children") for word in path.read_text().split()]


@pytest.mark.skipif(not Path(f"/proc/self/task/{os.getpid()}/children").exists(), reason="lists processes in /proc")
@pytest.mark.long
@pytest.mark.parametrize("way", MANY_DIGITS, indirect=True)
def test_a_worker_that_is_killed_at_work_costs_no_row_and_no_byte(way, tally, tmp_path):
    begun, whole = way
    source, count, killed = random.Random(8), 5, []
    for number in range(count):
        folder, at = tmp_path / str(number), source.randrange(4)
        begun(folder)
        command = [*GO_ON[:3], "--workers", "2", "--out", folder]
        with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL) as process:
            while process.poll() is None and len(killed) == number:
                if len(contents(folder)) >= at and (workers := children(process.pid)):
                    time.sleep(source.uniform(0.0, 0.3))
                    os.kill(source.choice(workers), signal.SIGKILL)  # its parent still waits for it
                    killed.append(len(contents(folder)))
                time.sleep(0.01)
        assert process.returncode == 0
        assert contents(folder) == contents(whole)
        assert (folder / "summary.json").read_bytes() == (whole / "summary.json").read_bytes()
    assert len(killed) == count
    tally(f"sweeps in processes: {count} workers killed when {killed} parts were done, the same bytes")


GROWTH_MIB = 16  # of the memory of a sweep into a folder: the noise of two runs, and not a byte for each row
PEAK = """import atexit, resource, sys
atexit.register(lambda: print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024, file=sys.stderr))
"""


@pytest.mark.long
@pytest.mark.parametrize("want", ["all", "all,transit-times"])
@pytest.mark.parametrize("engine", ["heyoka", "octet"])
def test_the_memory_of_a_sweep_into_a_folder_does_not_grow_with_its_rows(engine, want, tally, tmp_path):
    """Of rows of many parts, each of a tenth of a second, whose fields have few values."""
    pytest.importorskip("resource")
    program, peaks = PEAK + SMALL_PARTS.replace("0.0", "0.1"), {}
    for values in (125, 125, {"heyoka": 1250, "octet": 5000}[engine]):  # the first compiles
        over = ["--over", "site.latitude=1:80:1", "--over", f"release.x=0.1:{0.1 + 0.0001 * (values - 1):.4f}:0.0001"]
        words = ["sweep", "paris", "--t-end", "2", "--audit", "0", "--workers", "1", "--engine", engine, *over]
        out = tmp_path / "out"
        ended = subprocess.run(
            [sys.executable, "-c", program, *words, "--want", want, "--out", out],
            cwd=ROOT, capture_output=True, text=True, check=True,
        )  # fmt: skip
        peaks[80 * values] = int(ended.stderr.splitlines()[-1])
        shutil.rmtree(out)
    few, many = peaks.values()
    tally(f"memory of a sweep into a folder, {engine}, {want}: {peaks} (MiB by rows)")
    assert many - few < GROWTH_MIB
