"""Datasets made to do harm: `verify` and `load` end with a sentence, in little time and memory."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter

from hostile_datasets import CASES
from hostile_verifications import LIMIT_S
from places import ROOT

import reference
from reference.dataset.write import write

NOTHING_TO_FIND = {
    "gap of the runs of exponent -9999": "a claim about runs that nobody can see; every number is held against others",
    "2000 foreign files with escapes in their names": "files that are ignored, which is said",
    "rows outside the sphere within large bounds": "bounds that allow any number",
    "no forces": "the bob does stay where it is",
    "escapes in the generator": "words that nothing follows from; they are not printed",
    "a number type of many digits": "words that nothing follows from",
    "steps of 10**10": "a claim about a run that nobody can see",
}
NOT_DECIDED = "motion not decided"  # a note of `verify`: too long, or too many bits


def test_no_dataset_ends_in_a_traceback_a_hang_or_full_memory(size, tally, tmp_path):
    pairs = size(0, 200)
    changes = ["run.t_end=180", "run.digits=15", "run.level=confirmed"]
    scene = reference.load_scene("paris", changes).model_copy(update={"id": "small"})
    source = write(reference.solve(scene, engine="limbs"), tmp_path / "good" / "small")
    work = tmp_path / "work"
    work.mkdir()
    program = ROOT / "tests/helpers/hostile_verifications.py"
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests/helpers'}", "OMP_NUM_THREADS": "1"}
    words = [sys.executable, str(program), str(source), str(pairs)]
    done = subprocess.run(words, capture_output=True, text=True, env=environment, cwd=work, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    results = json.loads(done.stdout)
    for word, those in (("cases", results[: len(CASES)]), ("pairs", results[len(CASES) :])):
        outcomes = Counter(result["outcome"] for result in those)
        tally(f"hostile datasets, {word}: {len(those)} tried, {dict(sorted(outcomes.items()))}")
    slowest = max(results, key=lambda result: result["seconds"])
    largest = max(results, key=lambda result: result["mb"])
    total = sum(result["seconds"] for result in results)
    tally(
        f"hostile datasets: {total:.0f} CPU s, the slowest {slowest['seconds']:.1f} s ({' + '.join(slowest['names'])}),"
        f" the largest {largest['mb']} MB ({' + '.join(largest['names'])})"
    )
    assert len(results) == len(CASES) + pairs
    assert [result for result in results if result["outcome"] == "wrong"] == []
    assert slowest["seconds"] < LIMIT_S
    passed = {
        result["names"][0]
        for result in results[: len(CASES)]
        if result["outcome"] == "passed" and NOT_DECIDED not in result["said"]
    }
    assert passed == set(NOTHING_TO_FIND)
