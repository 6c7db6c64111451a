"""Damaged results of studies, which pages are made from: each is read or refused."""

from __future__ import annotations

import json
from collections import Counter

from places import ROOT
from strange_inputs import Chance, a_document

from compare.report.atlas.entry import kept_studies
from reference import InputError

STUDIES = sorted((ROOT / "docs/studies").glob("*.json"))


def test_results_of_studies(size, tally, tmp_path):
    documents = [json.loads(path.read_text()) for path in STUDIES]
    short = [document | {"rows": document["rows"][:5]} for document in documents]
    counts = Counter()
    for i in range(size(60, 2000)):
        chance = Chance(f"2 {i}")
        made = a_document(chance, chance.choice(short))
        (tmp_path / "a.json").write_bytes(made)
        try:
            for results in kept_studies(tmp_path).values():
                repr((results, results.sentence()))
            counts["read"] += 1
        except InputError:
            counts["refused"] += 1
        except Exception as error:
            raise AssertionError(f"{i}: {ascii(made)[:2000]}") from error
    assert counts["read"] and counts["refused"]
    tally(f"damaged results of studies: {dict(counts)}")
