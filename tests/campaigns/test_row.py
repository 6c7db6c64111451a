"""A row removed, doubled or moved, a number changed or written anew: every table of every format, its journal too."""

from __future__ import annotations

import random
import re
from collections import Counter
from pathlib import Path

import pytest
from formats import FORMATS, files_of, restored

TABLES = {".csv", ".jsonl", ".parquet"}
SEED = 7


def a_digit(line: str, chance: random.Random) -> str:
    at = chance.choice([match.start() for match in re.finditer(r"\d", line)])
    return f"{line[:at]}{(int(line[at]) + chance.randint(1, 9)) % 10}{line[at + 1 :]}"


def two_cells_exchanged(line: str, chance: random.Random) -> str:
    cells = line.split(",")
    at = chance.randrange(len(cells) - 1)
    cells[at : at + 2] = reversed(cells[at : at + 2])
    return ",".join(cells)


def a_sign(line: str, chance: random.Random) -> str:
    return line.replace("-", "", 1) if "-" in line else line.replace(",", ",-", 1)


# what becomes of the lines of a text, after its first one, and of a place among them
LINES = {
    "a row removed": lambda lines, at, _: lines[:at] + lines[at + 1 :],
    "the last row removed": lambda lines, at, _: lines[:-1],
    "a row twice": lambda lines, at, _: lines[: at + 1] + lines[at:],
    "two rows exchanged": lambda lines, at, _: [*lines[:at], *reversed(lines[at : at + 2]), *lines[at + 2 :]],
    "rows in the other order": lambda lines, at, _: lines[::-1],
    "another digit": lambda lines, at, chance: [*lines[:at], a_digit(lines[at], chance), *lines[at + 1 :]],
    "another sign": lambda lines, at, chance: [*lines[:at], a_sign(lines[at], chance), *lines[at + 1 :]],
    "two cells exchanged": lambda lines, at, chance: [
        *lines[:at], two_cells_exchanged(lines[at], chance), *lines[at + 1 :]
    ],
}  # fmt: skip


def another_value(table, chance):
    import pyarrow as pa

    at = chance.choice([i for i, column in enumerate(table.schema) if column.type == pa.float64()])
    values = table.column(at).to_numpy().copy()
    values[chance.randrange(len(values))] += chance.choice((1.0, 1e-9))
    return table.set_column(at, table.schema.field(at), pa.array(values))


def a_narrower_type(table, chance):
    import pyarrow as pa

    at = chance.choice([i for i, column in enumerate(table.schema) if column.type == pa.float64()])
    return table.set_column(at, table.column_names[at], table.column(at).cast(pa.float32()))


# what becomes of a table that a program reads from Parquet and writes again
REWRITES = {
    "a row removed": lambda table, chance: table.take(
        [k for k in range(len(table)) if k != len(table) // 2]
    ),
    "rows dropped": lambda table, chance: table.slice(0, chance.randrange(len(table))),
    "a row twice": lambda table, chance: table.take([0, *range(len(table))]),
    "rows in the other order": lambda table, chance: table.take([*range(len(table))][::-1]),
    "a column dropped": lambda table, chance: table.drop_columns(
        [chance.choice(table.column_names)]
    ),
    "another value": another_value,
    "a narrower type": a_narrower_type,
    "as it was": lambda table, chance: table,
}


def rewritten(path: Path, kind: str, chance: random.Random) -> None:
    """Read a part and write it with its metadata, its seal among them, as other programs would."""
    pq = pytest.importorskip("pyarrow.parquet")
    file = pq.ParquetFile(path)
    kept = {key: value for key, value in file.metadata.metadata.items() if key != b"ARROW:schema"}
    table = REWRITES[kind](file.read(), chance)
    with pq.ParquetWriter(
        path, table.schema, compression="zstd", write_page_checksum=True
    ) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata(kept)


def edited(path: Path, kind: str, chance: random.Random) -> None:
    """Change the lines of a text, but for the header of a table."""
    head = 1 if path.suffix == ".csv" else 0
    lines = path.read_text().splitlines()
    rows = lines[head:]
    changed = LINES[kind](rows, chance.randrange(len(rows)), chance)
    path.write_text("".join(f"{line}\n" for line in [*lines[:head], *changed]))


def changed(path: Path, kind: str, chance: random.Random) -> bool:
    """Change a table; return False if it is as before, by chance."""
    data = path.read_bytes()
    if path.suffix == ".parquet":
        rewritten(path, kind, chance)
    else:
        edited(path, kind, chance)
    return path.read_bytes() != data


def cases_of(folder: Path) -> list[tuple[str, str]]:
    """Return each table of a folder with each change that can be made to it."""
    tables = [name for name in files_of(folder) if Path(name).suffix in TABLES]
    return [
        (name, kind)
        for name in tables
        for kind in (REWRITES if name.endswith(".parquet") else LINES)
    ]


@pytest.mark.parametrize("made", [name for name in FORMATS if name != "function"], indirect=True)
def test_a_changed_row_is_told_or_changes_no_number(made, tmp_path, size, tally):
    chance, folder, counts = random.Random(SEED), tmp_path / "changed", Counter()
    for name, kind in cases_of(made.whole) * size(1, 5):
        restored(folder, made.whole)
        if changed(folder / name, kind, chance):
            counts["refused" if made.is_told(folder) else "the same numbers"] += 1
    tally(f"rows of a {made.format.name}: {dict(counts)}")


@pytest.mark.parametrize("made", [name for name in FORMATS if name != "function"], indirect=True)
def test_the_same_command_makes_the_rows_again(made, tmp_path, size, tally):
    chance, folder, counts = random.Random(SEED), tmp_path / "changed", Counter()
    cases = cases_of(made.whole)
    for name, kind in chance.sample(cases, min(size(1, 20), len(cases))):
        restored(folder, made.whole)
        if changed(folder / name, kind, chance):
            assert made.goes_on(folder), (name, kind)
            counts["whole again"] += 1
    tally(f"rows of a {made.format.name}, and the same command: {dict(counts)}")
