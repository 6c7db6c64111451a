"""A byte changed, a piece lost or doubled, a file cut short, other line ends: every file of every format.

What `verify` says and what Python reads are refused with the name of the file, or are as before; the same command
writes the folder anew, or says why not.
"""

from __future__ import annotations

import random
from collections import Counter
from pathlib import Path

import pytest
from formats import files_of, restored, values_of

import reference


def another_byte(data: bytes, at: int, chance: random.Random) -> bytes:
    other = chance.choice([byte for byte in range(256) if byte != data[at]])
    return data[:at] + bytes([other]) + data[at + 1 :]


def a_bit(data: bytes, at: int, chance: random.Random) -> bytes:
    return data[:at] + bytes([data[at] ^ 1 << chance.randrange(8)]) + data[at + 1 :]


def utf_16(data: bytes) -> bytes:
    try:
        return data.decode().encode("utf-16")
    except UnicodeDecodeError:
        return data


DAMAGE = {
    "another byte": another_byte,
    "a bit": a_bit,
    "cut short": lambda data, at, _: data[:at],
    "empty": lambda data, at, _: b"",
    "a piece lost": lambda data, at, _: data[:at] + data[at + 40 :],
    "a piece twice": lambda data, at, _: data[: at + 40] + data[at:],
    "two bytes exchanged": lambda data, at, _: data[:at] + data[at : at + 2][::-1] + data[at + 2 :],
    "CR LF": lambda data, at, _: data.replace(b"\n", b"\r\n"),
    "a byte order mark": lambda data, at, _: b"\xef\xbb\xbf" + data,
    "a blank line more": lambda data, at, _: data + b"\n",
    "UTF-16": lambda data, at, _: utf_16(data),
}
SEED = 2026


def damaged(path: Path, kind: str, chance: random.Random) -> bool:
    """Damage a file; return False if it is as before, by chance."""
    data = path.read_bytes()
    path.write_bytes(DAMAGE[kind](data, chance.randrange(len(data)), chance))
    return path.read_bytes() != data


def test_damage_of_every_kind_to_every_file_is_told_or_changes_no_number(
    made, tmp_path, size, tally
):
    chance, folder, counts = random.Random(SEED), tmp_path / "damaged", Counter()
    for _ in range(size(1, 5)):
        for kind in DAMAGE:
            for name in files_of(made.whole):
                restored(folder, made.whole)
                if damaged(folder / name, kind, chance):
                    counts["refused" if made.is_told(folder) else "the same numbers"] += 1
    tally(f"bytes of a {made.format.name}: {dict(counts)}")


def test_the_same_command_makes_it_whole_or_says_why_not(made, tmp_path, size, tally):
    chance, folder, counts = random.Random(SEED), tmp_path / "damaged", Counter()
    cases = [(kind, name) for name in files_of(made.whole) for kind in DAMAGE]
    for kind, name in chance.sample(cases, min(size(1, 20), len(cases))):
        restored(folder, made.whole)
        if damaged(folder / name, kind, chance):
            counts["whole again" if made.goes_on(folder) else "refused"] += 1
    tally(f"bytes of a {made.format.name}, and the same command: {dict(counts)}")


@pytest.mark.parametrize("made", ["sweep"], indirect=True)
def test_a_part_that_is_damaged_after_its_seal_was_checked_is_refused_or_the_same(
    made, tmp_path, size, tally
):
    """Columns are read when they are asked for; the pages of Parquet have checksums of their own."""
    chance, right, counts = random.Random(SEED), made.format.read(made.whole), Counter()
    for _ in range(size(30, 300)):
        folder = restored(tmp_path / "damaged", made.whole)
        swept = reference.load_sweep(folder)
        name = chance.choice([name for name in files_of(folder) if name.endswith(".parquet")])
        damaged(folder / name, "a bit", chance)
        try:
            assert values_of(swept) == right, name
            counts["the same numbers"] += 1
        except reference.InputError:
            counts["refused"] += 1
    tally(f"parts damaged after they were loaded: {dict(counts)}")
