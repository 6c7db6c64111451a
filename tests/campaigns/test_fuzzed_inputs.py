"""Thousands of hostile scenes, assignments, candidates, lists of transits and commands: each is read or refused."""

from __future__ import annotations

import json
import os
import subprocess
import sys

from hostile_runs import LIMIT_BYTES, LIMIT_S
from places import ROOT

SEED = 1
# kind: how many in a short run, in a long one
COUNTS = {
    "scene": (120, 3000),
    "--set": (100, 2000),
    "candidate": (150, 3000),
    "transits": (50, 1000),
    "--run": (50, 1000),
    "command line": (40, 1000),
}


def test_no_input_ends_in_a_traceback_a_hang_or_full_memory(size, tally, tmp_path):
    counts = {kind: size(*numbers) for kind, numbers in COUNTS.items()}
    program = ROOT / "tests/helpers/hostile_runs.py"
    words = [sys.executable, str(program), str(SEED), json.dumps(counts), str(tmp_path)]
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests/helpers'}", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(words, capture_output=True, text=True, env=environment, cwd=tmp_path, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    found = json.loads(done.stdout)
    for kind, outcomes in found["tried"].items():
        tally(f"fuzzed inputs, {kind}: {sum(outcomes.values())} tried, {outcomes}")
    seconds, kind, _ = found["slowest"]
    tally(f"fuzzed inputs: the slowest took {seconds:.1f} CPU s ({kind}), peak memory {found['peak_mb']} MB")
    assert {kind: sum(outcomes.values()) for kind, outcomes in found["tried"].items()} == counts
    assert all(outcomes["read"] for kind, outcomes in found["tried"].items() if kind != "--run"), "all were refused"
    assert found["wrong"] == []
    assert seconds < LIMIT_S
    assert found["peak_mb"] << 20 < LIMIT_BYTES
