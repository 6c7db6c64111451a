"""Sweeps in a folder: resumed, the same bytes whoever computed them, readable by others, nothing half written."""

from __future__ import annotations

import json
import os
import shutil
import tracemalloc
from dataclasses import replace

import numpy as np
import poisoned_sweep
import pytest

from reference import InputError, load_scene, load_sweep, sweep
from reference.status import Status
from reference.sweeps import driver
from reference.sweeps.part import Part
from reference.sweeps.request import Settings
from reference.sweeps.store import Store
from reference.sweeps.sweep import checked_request, run

pytest.importorskip("pyarrow")
OVER = ["site.latitude=-90:90:2"]
ROWS = 91


def asked(out, **options):
    scene = load_scene("paris", ["run.t_end=30"])
    whole = checked_request(
        scene, OVER, None, out, Settings(audit=0, **{"engine": "heyoka", **options})
    )
    return replace(whole, rows_per_part=16)


def contents(folder):
    return {
        path.relative_to(folder): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweeps") / "whole"
    run(asked(folder), folder, workers=1)
    return folder


def test_the_folder_holds_what_memory_would(whole):
    there, here = (
        load_sweep(whole),
        sweep(load_scene("paris", ["run.t_end=30"]), OVER, engine="heyoka"),
    )
    for name, values in here.columns().items():
        assert np.array_equal(values, there[name], equal_nan=values.dtype.kind == "f"), name
    assert json.loads((whole / "summary.json").read_text()) == {
        "rows": ROWS,
        "counts": {"ok": ROWS},
        "audit": None,
    }


def test_any_number_of_workers_and_any_interruption_give_the_same_bytes(whole, tmp_path):
    folder = tmp_path / "resumed"
    # of a command that was killed as it began
    (folder / ".plan.json.partial-abc").mkdir(parents=True)
    run(asked(folder), folder)
    shutil.copytree(whole, folder, dirs_exist_ok=True)
    (folder / "summary.json").unlink()
    (folder / "rows/part-00000001.parquet").unlink()
    cut = folder / "rows/part-00000003.parquet"
    cut.write_bytes(cut.read_bytes()[:-20])
    foreign = folder / "rows/part-00000004.parquet"
    shutil.copy(folder / "rows/part-00000005.parquet", foreign)
    (folder / "rows/.part-00000002.parquet.partial-abc").mkdir()
    (folder / "rows/part-00000005.parquet").unlink()
    os.mkfifo(folder / "rows/part-00000005.parquet")
    with pytest.raises(InputError, match="4 of 6 parts are missing or damaged"):
        load_sweep(folder)
    done = []
    run(asked(folder), folder, workers=2, report=done.append)
    assert sum(done) == ROWS
    assert list(folder.rglob(".*")) == []
    assert contents(folder) == contents(whole)


def test_others_read_it_as_it_is(whole):
    frequency = load_sweep(whole)["frequency_hz"]
    pandas = pytest.importorskip("pandas")
    table = pandas.read_parquet(whole / "rows")
    assert table["frequency_hz"].tolist() == frequency.tolist()
    assert set(table["status"]) == {"ok"}
    polars = pytest.importorskip("polars")
    assert (
        polars.scan_parquet(whole / "rows/*.parquet").collect()["frequency_hz"].to_list()
        == frequency.tolist()
    )
    duckdb = pytest.importorskip("duckdb")
    query = f"select frequency_hz from '{whole}/rows/*.parquet' order by row"
    assert [row[0] for row in duckdb.sql(query).fetchall()] == frequency.tolist()


def test_each_column_says_what_it_means(whole):
    import pyarrow.parquet as pq

    schema = pq.read_schema(whole / "rows/part-00000000.parquet")
    assert all(field.metadata[b"meaning"] for field in schema)


def test_another_sweep_or_other_files_are_left_alone(whole, tmp_path):
    before = contents(whole)
    with pytest.raises(InputError, match=r"differs in scene\b"):
        run(
            replace(asked(whole), scene=load_scene("paris", ["run.t_end=31", "run.grid_step=31"])),
            whole,
        )
    assert contents(whole) == before
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match="a new or empty folder"):
        run(asked(tmp_path), tmp_path)
    with pytest.raises(InputError, match=r"with plan\.json"):
        load_sweep(tmp_path)


def test_the_same_fields_in_another_order_are_another_sweep(tmp_path):
    scene, over = (
        load_scene("paris", ["run.t_end=30"]),
        ["site.latitude=0:20:10", "release.x=0.1,0.2"],
    )
    folder = tmp_path / "ordered"
    run(checked_request(scene, over, None, folder, Settings(audit=0, engine="heyoka")), folder)
    with pytest.raises(InputError, match=r"differs in over\b"):
        run(
            checked_request(scene, over[::-1], None, folder, Settings(audit=0, engine="heyoka")),
            folder,
        )


def test_a_changed_plan_and_other_versions_are_refused(whole, tmp_path):
    folder = tmp_path / "changed"
    shutil.copytree(whole, folder)
    plan = json.loads((folder / "plan.json").read_text())
    # the latter as of a version with other columns
    for other in ({"rows_per_part": 32}, {"hash": "0" * 64}):
        (folder / "plan.json").write_text(json.dumps(plan | other))
        with pytest.raises(InputError, match="written by this version"):
            load_sweep(folder)
    (folder / "plan.json").write_text(json.dumps(plan | {"pyarrow": "1.0"}))
    with pytest.raises(InputError, match=r"pyarrow 1\.0"):
        run(asked(folder), folder)
    older = replace(asked(folder), identity="heyoka 1.0")
    (folder / "plan.json").write_text(
        json.dumps({"hash": older.hash, "pyarrow": plan["pyarrow"], **older.document()})
    )
    with pytest.raises(InputError, match=r"expected heyoka 1\.0, as in .* Install the versions"):
        run(asked(folder), folder)


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"scene": []}'])
def test_a_plan_that_is_none_is_refused(text, tmp_path):
    (tmp_path / "plan.json").write_text(text)
    with pytest.raises(InputError, match="written by this version"):
        load_sweep(tmp_path)


def test_the_times_of_transits_are_a_dataset_of_their_own(tmp_path):
    folder = tmp_path / "times"
    run(asked(folder, want=("transits", "transit-times")), folder, workers=1)
    swept = load_sweep(folder)
    listed = swept.transits()
    assert np.bincount(listed["row"], minlength=ROWS).tolist() == swept["transits"].tolist()
    assert "precession_deg_per_h" not in swept.names


def test_a_process_that_dies_is_replaced_and_its_row_crashes_alone(tmp_path, monkeypatch):
    monkeypatch.setattr(driver, "compute", poisoned_sweep.compute_here)
    scene, folder, done = load_scene("paris", ["run.t_end=2"]), tmp_path / "poisoned", []
    request = checked_request(
        scene, ["site.latitude=0:38:1"], None, folder, Settings(audit=0, digits=16, want=("state",))
    )
    request = replace(request, rows_per_part=13)
    swept = run(request, folder, workers=1, report=done.append)
    assert swept.tally.counts == swept.counts == {"ok": 38, "crashed": 1}
    assert sum(done) == 39
    assert swept.first_bad == poisoned_sweep.POISON
    assert "alone as well: a child process" in swept["reason"][poisoned_sweep.POISON]
    assert swept["site.latitude"].tolist() == list(range(39))


def test_what_became_of_the_rows_is_counted_in_the_memory_of_one_part(tmp_path):
    whole = checked_request(
        load_scene("paris"),
        ["site.latitude=1:80:1", "release.x=0.1:0.6:0.001"],
        None,
        tmp_path,
        Settings(audit=0),
    )
    request = replace(whole, rows_per_part=1024)
    store = Store.begun(tmp_path, request)
    for number in range(request.parts):
        part = Part.unsolved(request, request.rows_of(number))
        part.fill(slice(None), {"status": "ok"})
        if number == request.parts - 1:
            part.fail(-1, Status.CRASHED, "told")
        store.save(number, part)
    store.read(parts=[0])  # imports what reads
    swept = load_sweep(tmp_path)
    tracemalloc.start()
    assert swept.counts == {"crashed": 1, "ok": len(swept) - 1}
    assert swept.first_bad == len(swept) - 1
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8 * len(swept)  # a pointer for each row is too much
