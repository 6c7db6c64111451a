"""Hostile files that a run reads back, plans of sweeps, journals and results of studies: each is read or refused."""

from __future__ import annotations

import contextlib
import json
from collections import Counter
from dataclasses import asdict
from hashlib import sha256

import pytest
from places import ROOT
from strange_inputs import STRANGE, Chance, a_document, with_strange_value

from compare.report.atlas.entry import kept_studies
from compare.studies import campaign
from compare.studies.row import Row
from reference import InputError, load_scene, load_sweep
from reference.status import Status
from reference.sweeps.parquet import TRANSIT_COLUMNS
from reference.sweeps.store import Store
from reference.sweeps.sweep import asked_for, run

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


def test_plans_of_sweeps(size, tally, tmp_path):
    pytest.importorskip("pyarrow")
    asked = asked_for(
        load_scene("paris", ["run.t_end=20"]), ["site.latitude=0:9:1"], None, tmp_path, audit=2, engine="heyoka"
    )
    run(asked, tmp_path, workers=1)
    path = tmp_path / "plan.json"
    plan = json.loads(path.read_text())
    columns = [(column.name, column.kind) for column in (*asked.columns, *TRANSIT_COLUMNS)]

    def rehashed(changed):
        """A plan by somebody who makes the hash anew."""
        document = {key: value for key, value in changed.items() if key not in ("hash", "pyarrow")}
        text = json.dumps([document, columns], sort_keys=True)
        return json.dumps(changed | {"hash": sha256(text.encode()).hexdigest()}).encode()

    assert json.loads(rehashed(plan)) == plan

    def make(chance):
        return a_document(chance, plan) if chance.random() < 0.5 else rehashed(with_strange_value(chance, plan))

    def use(made):
        path.write_bytes(made)
        store = Store.opened(tmp_path)
        if store.request.parts < 1000:
            with contextlib.suppress(InputError):
                load_sweep(tmp_path)
        with contextlib.suppress(InputError):
            Store.begun(tmp_path, asked)

    for made in (rehashed(plan | {key: value}) for key in plan for value in STRANGE):
        with contextlib.suppress(InputError):
            use(made)
    tally(f"hostile plans of sweeps: {outcomes(size(60, 2000), make, use)}")


def test_journals_of_studies(size, tally, tmp_path):
    path = tmp_path / "rows.jsonl"
    good = json.dumps(ROW).encode()

    def use(made):
        path.write_bytes(b"\n".join([good, made, good.replace(b"rk4", b"rk5")]))
        kept = [item for (_, item), row in campaign._stored(path, Row) if repr(row)]
        assert ("rk5", "momentum", 0.5) in kept

    tally(f"hostile journals: {outcomes(size(60, 2000), lambda chance: a_document(chance, ROW), use)}")


def test_results_of_studies(size, tally, tmp_path):
    documents = [json.loads(path.read_text()) for path in STUDIES]
    short = [document | {"rows": document["rows"][:5]} for document in documents]

    def use(made):
        (tmp_path / "a.json").write_bytes(made)
        for results in kept_studies(tmp_path).values():
            repr((results, results.sentence()))

    found = outcomes(size(60, 2000), lambda chance: a_document(chance, chance.choice(short)), use)
    tally(f"hostile results of studies: {found}")
