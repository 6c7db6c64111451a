"""Files as people write them: each is read as it was meant, or refused with the reason; the pages read them alike."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from random import Random

import pytest
from spellings import Spelling, drawn, of_my_own, of_the_field

from compare.candidates.read import read, read_transits
from compare.report.atlas.parts import plain, vocabulary
from compare.report.atlas.scripts import source
from reference import InputError

FIELD, OWN = of_the_field(), of_my_own()
SPELLINGS = FIELD | OWN


def columns_of(spelling, path):
    """The columns that Python reads, or the error."""
    path.write_bytes(spelling.data)
    try:
        if spelling.alone:
            return {"t": read_transits(path).tolist()}
        candidate = read(path)
        return {"t": candidate.t.tolist()} | {
            name: column.tolist() for name, column in candidate.columns.items()
        }
    except InputError as error:
        return error


@pytest.mark.parametrize("name", SPELLINGS)
def test_a_spelling_is_read_as_meant_or_refused_with_the_reason(name, tmp_path):
    spelling = SPELLINGS[name]
    found = columns_of(spelling, tmp_path / "run.csv")
    if spelling.columns is None:
        assert isinstance(found, InputError), found
        assert spelling.reason in str(found), found
    else:
        assert not isinstance(found, InputError), found
        assert found == spelling.columns


def test_enough_spellings_are_tried():
    refused = [name for name, spelling in SPELLINGS.items() if spelling.columns is None]
    assert len(FIELD) >= 101 and len(OWN) >= 60
    assert not {*FIELD} & {*OWN} and not {*FIELD} & {*refused}


RUN = """
const { words, texts } = JSON.parse(require("fs").readFileSync(0, "utf8"));
const told = texts.map(({ text, alone }) => {
  try {
    const { columns, transits, notes } = (alone ? readTransits : readTrajectory)(text, words);
    return { columns: alone ? { t: transits } : columns, notes };
  } catch (error) {
    if (!(error instanceof Unreadable)) throw error;
    return { refused: error.message };
  }
});
console.log(JSON.stringify(told));
"""


def read_by_the_page(spellings: list[Spelling]) -> list[dict]:
    asked = [{"text": spelling.text, "alone": spelling.alone} for spelling in spellings]
    document = json.dumps({"words": vocabulary(), "texts": asked}, default=plain)
    script = source("reading.js") + RUN
    done = subprocess.run(
        ["node", "-e", script], input=document, capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout)


@pytest.mark.skipif(shutil.which("node") is None, reason="Node.js is not installed")
def test_the_page_reads_every_spelling_as_the_command_does(tmp_path):
    path = tmp_path / "run.csv"
    for (name, spelling), mine in zip(
        SPELLINGS.items(), read_by_the_page([*SPELLINGS.values()]), strict=True
    ):
        found = columns_of(spelling, path)
        if spelling.columns is None:
            assert mine.get("refused"), (name, mine)
            continue
        assert mine.get("columns") == found, (name, mine)
        if not spelling.alone:
            wanted = [
                f"Reading: {one.text.partition(' (--columns')[0]}."
                for one in read(path).conventions
            ]
            assert [note for note in mine["notes"] if note.startswith("Reading")] == wanted, name
            notes = [note.removesuffix(".") for note in mine["notes"] if "left out" in note]
            assert notes == [note for note in read(path).notes if "left out" in note], name


def is_what_was_written(found, spelling):
    """Whether columns are those of a spelling, t perhaps since its first row, to two roundings."""
    written = spelling.columns
    times = [[t - start for t in written["t"]] for start in (0, written["t"][0])]
    near = [found["t"] == pytest.approx(of, rel=1e-15, abs=1e-12) for of in times]
    return (
        found.keys() == written.keys()
        and any(near)
        and all(found[name] == pytest.approx(written[name], rel=4e-16, abs=0) for name in "xy")
    )


def test_what_is_drawn_is_read_as_written_or_refused_and_by_the_page_alike(size, tally, tmp_path):
    random = Random(62)
    spellings = [drawn(random) for _ in range(size(2000, 100_000))]
    found = [columns_of(spelling, tmp_path / "run.csv") for spelling in spellings]
    right = [columns for columns in found if not isinstance(columns, InputError)]
    for spelling, columns in zip(spellings, found, strict=True):
        assert isinstance(columns, InputError) or is_what_was_written(columns, spelling), (
            spelling.text
        )
    tally(
        f"spellings: {len(right)} of {len(spellings)} read as written, {len(spellings) - len(right)} refused"
    )
    assert len(right) > len(spellings) / 2
    if shutil.which("node") is None:
        return
    for spelling, columns, mine in zip(spellings, found, read_by_the_page(spellings), strict=True):
        assert mine.get("columns") == (None if isinstance(columns, InputError) else columns), (
            spelling.text,
            mine,
            columns,
        )


def test_what_the_scripts_take_from_the_vocabulary_is_in_it():
    """A name that is missing would be `undefined` there, which compares as false with any number."""
    scripts = "".join(map(source, ("reading.js", "judging.js", "dropping.js", "answering.js")))
    taken = re.findall(r"\b(?:vocabulary|words)\.([A-Z_]+)\b", scripts)
    assert set(taken) - vocabulary().keys() == set()
