"""Read vectors and page back, and compare what they say with tables and manifest.

Nothing here is used to write a dataset: a mistake of what writes these files does not hide in what checks them.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any

from ...errors import LONGEST_VALUE
from ...numbers.columns import GRID, TRANSITS
from ...plain_text import shortened
from ..files import Files
from ..manifest import differences
from ..render import CONFIRMED, MEANING
from ..sheets import Sheet

VECTORS, PAGE = "vectors.json", "certified.txt"
MOST = 16  # states, and as many transits
SAMPLE = 10  # of as many rows of a grid a sampled confirmation has one
INPUTS = "Inputs (SI units, angles in degrees)"
UNITS = {
    "t": "s",
    "x": "m",
    "y": "m",
    "z": "m",
    "vx": "m/s",
    "vy": "m/s",
    "vz": "m/s",
    "ax": "m/s^2",
}
SAME = ("schema_version", "id", "level", "digits", "inputs", "frame", "scene")  # as in the manifest


def problems(files: Files) -> Iterator[str]:
    """Yield what vectors and page say that tables and manifest do not."""
    if VECTORS in files.texts:
        try:
            yield from _vectors(files, json.loads(files.texts[VECTORS]))
        except (AttributeError, LookupError, TypeError, ValueError) as error:
            yield f"{VECTORS}: cannot be read: {type(error).__name__} {error}"
    if PAGE in files.texts:
        yield from _page(files, files.texts[PAGE].split("\n"))


def _vectors(files: Files, said: dict[str, Any]) -> Iterator[str]:
    """Compare every field of vectors.json with what it should be."""
    manifest = files.manifest.model_dump()
    notes = said["notes"]
    vectors = [*said["states"], *said["transits"]]
    flags = {flag for vector in vectors for flag in vector["flags"]}
    expected = {
        **{name: manifest[name] for name in SAME},
        "columns": UNITS,
        "notes": {**notes, **manifest["notes"]},
        "states": list(_states(files)),
        "transits": list(_transits(files)),
    }
    for place, *values in differences(said, expected):
        old, new = (shortened(str(value), LONGEST_VALUE) for value in values)
        yield f"{VECTORS}: {place} = {old}, manifest and tables give {new}"
    if notes.keys() != {*manifest["notes"], *flags}:
        yield f"{VECTORS}: its notes are not those of the flags that it uses"


def _states(files: Files) -> Iterator[dict[str, Any]]:
    """Yield the state of each row that the vectors should have."""
    grid, bounds = files.tables["grid.csv"], {"t": "0", **files.manifest.bounds.grid}
    last = len(grid.rows)
    for row in _evenly(last, MOST):
        flags = ["release"] * (row == 1) + ["end"] * (row == last)
        yield {
            "row": row,
            "flags": flags,
            "values": _values(files, "grid", row, ("t", *GRID), bounds),
        }


def _transits(files: Files) -> Iterator[dict[str, Any]]:
    """Yield each transit that the vectors should have; the bound on its time is its own."""
    table = files.tables.get("transits.csv", Sheet((), [], {}))
    last = len(table.rows)
    pair: list[int] = []
    if last > 2:
        times = [Fraction(row[1]) for row in table.rows]
        gaps = [after - before for before, after in pairwise(times)]
        first = 1 + gaps.index(min(gaps))
        pair = [first, first + 1]
    for k in sorted({*_evenly(last, MOST - len(pair)), *pair}):
        row = dict(zip(table.header, table.rows[k - 1], strict=True))
        flags = ["end"] * (k == last) + ["closest_pair"] * (k in pair)
        bounds = {**files.manifest.bounds.transits, "t": row["bound"]}
        values = _values(files, "transits", k, TRANSITS, bounds)
        yield {"k": k, "direction": int(row["direction"]), "flags": flags, "values": values}


def _evenly(count: int, most: int) -> list[int]:
    """Return the numbers of rows, from 1: all, or `most` with the first and the last and even steps between."""
    if count <= most:
        return list(range(1, count + 1))
    return [1 + k * (count - 1) // (most - 1) for k in range(most)]


def _values(
    files: Files, kind: str, row: int, names: tuple[str, ...], bounds: Mapping[str, str]
) -> dict[str, dict[str, str]]:
    """Return the numbers of a row of a table, their doubles and their bounds."""
    table, doubles = files.tables[f"{kind}.csv"], files.tables.get(f"{kind}.binary64.csv")
    decimals = dict(zip(table.header, table.rows[row - 1], strict=True))
    hexfloats = {name: float(decimals[name]).hex() for name in names}
    if doubles is not None:
        cells = dict(zip(doubles.header, doubles.rows[row - 1], strict=True))
        hexfloats = {name: cells[f"{name}_hex"] for name in names}
    return {
        name: {"decimal": decimals[name], "hexfloat": hexfloats[name], "bound": bounds[name]}
        for name in names
    }


def _page(files: Files, lines: list[str]) -> Iterator[str]:
    """Check the page's sentences on level, reading, confirmation and passages; its numbers are compared elsewhere."""
    manifest = files.manifest
    if INPUTS not in lines:
        yield f"{PAGE}: it has no inputs"
        return
    # a title may be the same words
    place = max(k for k, line in enumerate(lines) if line == INPUTS)
    head, end = lines[:place], lines[place:]
    expected = [f"Level: {manifest.level}. {MEANING[manifest.level]}"]
    words = manifest.command.split()
    if "--confirm" in words:
        proof = (
            "FLINT alone proves the same digits." if "--audit" in words else "It is not audited."
        )
        confirmation = CONFIRMED[words[words.index("--confirm") + 1]]  # type: ignore[index]
        rows = manifest.counts.grid - 1
        expected.append(f"{proof} {confirmation.format(-(-rows // SAMPLE), rows)}")
    expected.append(f"Inputs are read as: {manifest.inputs}")
    for line in expected:
        if line not in head:
            yield f"{PAGE}: its head does not say {line!r}"
    counts = manifest.sections.counts if manifest.sections else {}
    passages = [f"Passages in sections.csv: {count} of {word}" for word, count in counts.items()]
    if passages != [line for line in end if line.startswith("Passages")]:
        yield f"{PAGE}: the passages that it counts are not those of sections.csv"
