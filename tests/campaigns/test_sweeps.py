"""Campaigns of sweeps: random rows in both engines against limbs at 110 bits; the memory of a sweep into a folder."""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import replace

import pytest
from against_limbs import compare
from places import ROOT
from random_rows import KINDS, random_kinds

from reference.engines.registry import batches
from reference.scenes.scene import load_scene
from reference.sweeps.request import Settings
from reference.sweeps.store import Store
from reference.sweeps.sweep import checked_request


# shorter runs of every kind in every run: tests/reference/sweeps/test_estimate.py
@pytest.mark.long
@pytest.mark.parametrize("engine", ["heyoka", "octet"])
def test_no_transit_is_lost_and_no_error_is_larger_than_estimated(tally, engine):
    *common, over = KINDS
    many = [
        *random_kinds(20261122, 3000, kinds=tuple(common)),
        *random_kinds(20261123, 500, kinds=(over,)),
    ]
    found = compare(batches()[engine], many)
    tally(f"sweeps, {engine}: {found}")
    assert not found.miscounted
    assert not found.underestimated


# of the memory of a sweep into a folder: the noise of two runs, and not a byte for each row
GROWTH_MIB = 16
ROWS_PER_PART = 2048
PEAK = """import atexit, resource, sys
from foucault import main
atexit.register(lambda: print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024, file=sys.stderr))
main()
"""


def begun(folder, values, engine, want):
    """Begin a sweep of many parts, whose fields have few values; the command goes on with it."""
    over = ["site.latitude=1:80:1", f"release.x=0.1:{0.1 + 0.0001 * (values - 1):.4f}:0.0001"]
    scene = load_scene("paris", ["run.t_end=2"])
    asked = checked_request(scene, over, None, folder, Settings(audit=0, engine=engine, want=want))
    Store.begun(folder, replace(asked, rows_per_part=ROWS_PER_PART))
    return folder


@pytest.mark.long
@pytest.mark.parametrize("want", [("all",), ("all", "transit-times")], ids=",".join)
@pytest.mark.parametrize("engine", ["heyoka", "octet"])
def test_the_memory_of_a_sweep_into_a_folder_does_not_grow_with_its_rows(
    engine, want, tally, tmp_path
):
    pytest.importorskip("resource")
    peaks = {}
    for values in (125, 125, {"heyoka": 1250, "octet": 5000}[engine]):  # the first compiles
        out = begun(tmp_path / "out", values, engine, want)
        command = [sys.executable, "-c", PEAK, "sweep", "--workers", "1", "--out", out]
        ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        peaks[80 * values] = int(ended.stderr.splitlines()[-1])
        shutil.rmtree(out)
    few, many = peaks.values()
    tally(f"memory of a sweep into a folder, {engine}, {want}: {peaks} (MiB by rows)")
    assert many - few < GROWTH_MIB
