"""Damaged parts of a sweep, by a flipped bit or rewritten: each is found on load, and computed again on resume."""

from __future__ import annotations

import shutil
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from strange_inputs import Chance

from reference import InputError, load_scene, load_sweep
from reference.sweeps.sweep import asked_for, run

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")
KINDS = ("rows", "transits")
PARTS = 3


def swept_into(folder, latitudes="0:44:2"):
    """Sweep 23 rows in three parts, with the times of transits; return what was asked for."""
    scene, want = load_scene("paris", ["run.t_end=30"]), ("all", "transit-times")
    whole = asked_for(scene, [f"site.latitude={latitudes}"], None, folder, audit=0, want=want, engine="heyoka")
    asked = replace(whole, rows_per_part=8)
    run(asked, folder, workers=1)
    return asked


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*.parquet"))}


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """A sweep, a copy of it to be damaged, another sweep, and what was asked for."""
    whole, copy, other = (tmp_path_factory.mktemp("parts") / name for name in ("whole", "copy", "other"))
    asked = swept_into(whole)
    shutil.copytree(whole, copy)
    swept_into(other, "1:45:2")
    return whole, copy, other, asked


def rewritten(path, change):
    """Write a part again with its metadata, plan and seal among them, as pyarrow would."""
    file = pq.ParquetFile(path)
    table, kept = change(file.read()), file.metadata.metadata
    with pq.ParquetWriter(path, table.schema, compression="zstd", write_page_checksum=True) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata({key: value for key, value in kept.items() if key != b"ARROW:schema"})


def another_value(chance, table):
    at = chance.choice([i for i, field in enumerate(table.schema) if field.type == pa.float64()])
    values = table.column(at).to_numpy().copy()
    values[chance.randrange(len(values))] += chance.choice((1.0, 1e-9))
    return table.set_column(at, table.schema.field(at), pa.array(values))


def narrower(chance, table):
    at = chance.choice([i for i, field in enumerate(table.schema) if field.type == pa.float64()])
    return table.set_column(at, table.column_names[at], table.column(at).cast(pa.float32()))


REWRITES = {
    "another value": another_value,
    "a column dropped": lambda chance, table: table.drop_columns([chance.choice(table.column_names)]),
    "a narrower type": narrower,
    "rows in another order": lambda chance, table: table.take(chance.sample(range(len(table)), len(table))),
    "rows dropped": lambda chance, table: table.slice(0, chance.randrange(len(table))),
    "written again": lambda chance, table: table,
}  # fmt: skip


KINDS_OF_REWRITE = (*REWRITES, "cut short", "of another plan", "another part", "of another kind", "empty")


def rewrite(chance, path, whole, other, turn):
    """Put another file in the place of a part, each kind in its turn; return what was done."""
    kind = KINDS_OF_REWRITE[turn % len(KINDS_OF_REWRITE)]
    data = path.read_bytes()
    number = int(path.stem.removeprefix("part-"))
    if kind in REWRITES:
        rewritten(path, lambda table: REWRITES[kind](chance, table))
    elif kind == "cut short":
        path.write_bytes(data[: chance.randrange(len(data))])
    elif kind == "of another plan":
        shutil.copy(other / path.parent.name / path.name, path)
    elif kind == "another part":
        shutil.copy(path.with_name(f"part-{(number + 1) % PARTS:08d}.parquet"), path)
    elif kind == "of another kind":
        shutil.copy(whole / KINDS[path.parent.name == "rows"] / path.name, path)
    else:
        path.write_bytes(b"")
    return kind if path.read_bytes() != data else None  # None: rows in the same order, by chance


def flip(chance, path, *_):
    data = bytearray(path.read_bytes())
    data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    path.write_bytes(data)
    return "a flipped bit"


@pytest.mark.parametrize("damage", [flip, rewrite])
def test_every_damaged_part_is_found_and_computed_again(damage, folders, size, tally):
    whole, copy, other, asked = folders
    true, done = contents(whole), Counter()
    for i in range(size(10, 1000) if damage is flip else size(len(KINDS_OF_REWRITE), 300)):
        chance = Chance(f"3 {i}")
        part = chance.randrange(PARTS)
        what = damage(chance, copy / chance.choice(KINDS) / f"part-{part:08d}.parquet", whole, other, i)
        if what is None:
            continue
        with pytest.raises(InputError, match=f"1 of {PARTS} are missing or damaged"):
            load_sweep(copy)
        reported = []
        run(asked, copy, workers=1, report=reported.append)
        assert reported[1:] == [len(asked.rows_of(part))], what
        assert contents(copy) == true, what
        done[what] += 1
    tally(f"damaged parts: {dict(done)}, all found on load and on resume")


def test_what_is_damaged_after_the_load_is_not_taken_for_numbers(folders, size, tally):
    whole, copy, _, _ = folders
    true, found = load_sweep(whole), Counter()
    for i in range(size(30, 1000)):
        chance = Chance(f"4 {i}")
        swept, kind, part = load_sweep(copy), chance.choice(KINDS), chance.randrange(PARTS)
        path = copy / kind / f"part-{part:08d}.parquet"
        flip(chance, path)
        try:
            read = swept.columns() if kind == "rows" else swept.transits()
            for name, values in (true.columns() if kind == "rows" else true.transits()).items():
                assert np.array_equal(values, read[name], equal_nan=values.dtype.kind == "f"), (i, name)
            found["the same values"] += 1
        except InputError:
            found["refused"] += 1
        shutil.copy(whole / kind / path.name, path)
    tally(f"parts damaged after the load: {dict(found)}")
