"""Datasets made to do harm: `verify` and `load` end with a sentence, in little time."""

from __future__ import annotations

import contextlib
import time

import pytest
from draft import Draft
from hostile_datasets import CASES

import reference
from reference.dataset.write import write
from reference.errors import FoucaultError, is_plain

LIMIT_S = 10  # CPU seconds
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


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    changes = ["run.t_end=180", "run.digits=15", "run.level=confirmed"]
    scene = reference.load_scene("paris", changes).model_copy(update={"id": "small"})
    return write(reference.solve(scene, engine="limbs"), tmp_path_factory.mktemp("good") / "small")


@pytest.mark.parametrize("name", CASES)
def test_no_dataset_ends_in_a_traceback_or_a_hang(name, source, tmp_path, foucault):
    """One is found wrong by `verify`, refused as no dataset, or passes; `load` reads as many numbers as are counted."""
    draft, folder = Draft.of(source), tmp_path / "hostile"
    CASES[name](draft)
    draft.write(folder)
    before = time.process_time()
    status, out, err = foucault("verify", folder)
    assert time.process_time() - before < LIMIT_S
    assert status in (0, 1, 2)
    assert all(map(is_plain, (out + err).splitlines())), ascii(out + err)
    assert (status == 1) == out.startswith(f"{folder}: WRONG\n  ")
    assert (status == 0 and NOT_DECIDED not in out) == (name in NOTHING_TO_FIND)
    with contextlib.suppress(FoucaultError):
        golden = reference.load(folder)
        assert status < 2
        assert len(golden.x) == len(golden.exact("t")) == golden.manifest.counts.grid
        assert len(golden.transits) in (0, golden.manifest.counts.transits)
