"""Damaged results of studies, which pages are made from: each is read or refused."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict

from places import ROOT
from strange_inputs import Chance, a_document

from compare.report.atlas.entry import kept_studies
from compare.studies.row import Row
from reference import InputError
from reference.status import Status

STUDIES = sorted((ROOT / "docs/studies").glob("*.json"))
RESULT = Row("rk4", "momentum", 0.5, "step", "binary64", Status.OK, error_m=1e-9, cpu_s=1.0, steps=9)
ROW = {"recipe": "0123456789abcdef", "item": ["rk4", "momentum", 0.5], "result": asdict(RESULT)}


def outcomes(count, make, use):
    """Write strange files one after the other and read each; return how many were read, and how many refused."""
    counts = Counter()
    for i in range(count):
        made = make(Chance(f"2 {i}"))
        try:
            use(made)
            counts["read"] += 1
        except InputError:
            counts["refused"] += 1
        except Exception as error:
            raise AssertionError(f"{i}: {ascii(made)[:2000]}") from error
    assert counts["refused"] < count
    return dict(counts)


def test_results_of_studies(size, tally, tmp_path):
    documents = [json.loads(path.read_text()) for path in STUDIES]
    short = [document | {"rows": document["rows"][:5]} for document in documents]

    def use(made):
        (tmp_path / "a.json").write_bytes(made)
        for results in kept_studies(tmp_path).values():
            repr((results, results.sentence()))

    found = outcomes(size(60, 2000), lambda chance: a_document(chance, chance.choice(short)), use)
    tally(f"hostile results of studies: {found}")
