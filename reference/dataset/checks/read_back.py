"""Read vectors and page back, and compare them with tables and manifest.

Nothing here is used to write a dataset: a mistake of what writes these files does not hide in what
checks them.
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
from ..files import DatasetFiles
from ..manifest import Manifest, differences
from ..render import CONFIRMED, MEANING
from ..sheets import Sheet

_VECTORS = "vectors.json"
_PAGE = "certified.txt"
_MOST = 16  # states, and as many transits
_SAMPLE = 10  # of as many rows of a grid a sampled confirmation has one
_INPUTS = "Inputs (SI units, angles in degrees)"
_UNITS = {
    "t": "s",
    "x": "m",
    "y": "m",
    "z": "m",
    "vx": "m/s",
    "vy": "m/s",
    "vz": "m/s",
    "ax": "m/s^2",
}
# as in the manifest
_SAME = ("schema_version", "id", "level", "digits", "inputs", "frame", "scene")


def problems(files: DatasetFiles) -> Iterator[str]:
    """Yield a sentence for every difference between vectors or page and tables or manifest."""
    if _VECTORS in files.texts:
        try:
            yield from _vectors(files, json.loads(files.texts[_VECTORS]))
        except (AttributeError, LookupError, TypeError, ValueError) as error:
            yield f"{_VECTORS}: cannot be read: {type(error).__name__} {error}"
    if _PAGE in files.texts:
        yield from _page(files, files.texts[_PAGE].split("\n"))


def _vectors(files: DatasetFiles, document: dict[str, Any]) -> Iterator[str]:
    """Compare every field of vectors.json with what it should be."""
    manifest = files.manifest.model_dump()
    notes = document["notes"]
    expected = {name: manifest[name] for name in _SAME}
    expected["columns"] = _UNITS
    expected["notes"] = {**notes, **manifest["notes"]}
    expected["states"] = list(_states(files))
    expected["transits"] = list(_transits(files))
    for place, *values in differences(document, expected):
        old, new = (shortened(str(value), LONGEST_VALUE) for value in values)
        yield f"{_VECTORS}: {place} = {old}, manifest and tables give {new}"

    used = set()
    for vector in (*document["states"], *document["transits"]):
        used.update(vector["flags"])
    if notes.keys() != {*manifest["notes"], *used}:
        yield f"{_VECTORS}: its notes are not those of the flags that it uses"


def _states(files: DatasetFiles) -> Iterator[dict[str, Any]]:
    """Yield the state of each row that the vectors should have."""
    columns = ("t", *GRID)
    bounds = {"t": "0", **files.manifest.bounds.grid}
    last = len(files.tables["grid.csv"].rows)
    for row in _evenly(last, _MOST):
        flags = []
        if row == 1:
            flags.append("release")
        if row == last:
            flags.append("end")
        values = _values(files, "grid", row, columns, bounds)
        yield {"row": row, "flags": flags, "values": values}


def _transits(files: DatasetFiles) -> Iterator[dict[str, Any]]:
    """Yield each transit that the vectors should have; the bound on its time is its own."""
    table = files.tables.get("transits.csv", Sheet((), [], {}))
    last = len(table.rows)
    pair = _closest_pair([Fraction(row[1]) for row in table.rows])
    for k in sorted({*_evenly(last, _MOST - len(pair)), *pair}):
        row = dict(zip(table.header, table.rows[k - 1], strict=True))
        flags = []
        if k == last:
            flags.append("end")
        if k in pair:
            flags.append("closest_pair")
        bounds = {**files.manifest.bounds.transits, "t": row["bound"]}
        values = _values(files, "transits", k, TRANSITS, bounds)
        yield {"k": k, "direction": int(row["direction"]), "flags": flags, "values": values}


def _closest_pair(times: list[Fraction]) -> list[int]:
    """Return the numbers, from 1, of the two closest neighbours; none of fewer than three times."""
    if len(times) < 3:
        return []
    gaps = [after - before for before, after in pairwise(times)]
    first = 1 + gaps.index(min(gaps))
    return [first, first + 1]


def _evenly(count: int, most: int) -> list[int]:
    """Return row numbers from 1: all, or `most` in even steps from the first to the last."""
    if count <= most:
        return list(range(1, count + 1))
    return [1 + k * (count - 1) // (most - 1) for k in range(most)]


def _values(
    files: DatasetFiles, kind: str, row: int, names: tuple[str, ...], bounds: Mapping[str, str]
) -> dict[str, dict[str, str]]:
    """Return the numbers of a row of a table, their doubles and their bounds."""
    table = files.tables[f"{kind}.csv"]
    decimals = dict(zip(table.header, table.rows[row - 1], strict=True))
    doubles = files.tables.get(f"{kind}.binary64.csv")
    if doubles is None:
        hexfloats = {name: float(decimals[name]).hex() for name in names}
    else:
        cells = dict(zip(doubles.header, doubles.rows[row - 1], strict=True))
        hexfloats = {name: cells[f"{name}_hex"] for name in names}
    return {
        name: {"decimal": decimals[name], "hexfloat": hexfloats[name], "bound": bounds[name]}
        for name in names
    }


def _page(files: DatasetFiles, lines: list[str]) -> Iterator[str]:
    """Check the page's sentences on level, reading, confirmation and passages.

    Its numbers are compared elsewhere.
    """
    manifest = files.manifest
    if _INPUTS not in lines:
        yield f"{_PAGE}: it has no inputs"
        return
    # a title may be the same words
    place = max(k for k, line in enumerate(lines) if line == _INPUTS)
    head = lines[:place]
    end = lines[place:]
    for line in _head(manifest):
        if line not in head:
            yield f"{_PAGE}: its head does not say {line!r}"

    counts = manifest.sections.counts if manifest.sections else {}
    expected = [f"Passages in sections.csv: {count} of {word}" for word, count in counts.items()]
    passages = [line for line in end if line.startswith("Passages")]
    if passages != expected:
        yield f"{_PAGE}: the passages that it counts are not those of sections.csv"


def _head(manifest: Manifest) -> Iterator[str]:
    """Yield the sentences on level, audit, confirmation and reading for the head of the page."""
    yield f"Level: {manifest.level}. {MEANING[manifest.level]}"
    words = manifest.command.split()
    if "--confirm" in words:
        audit = "It is not audited."
        if "--audit" in words:
            audit = "FLINT alone proves the same digits."
        confirmation = CONFIRMED[words[words.index("--confirm") + 1]]  # type: ignore[index]
        intervals = manifest.counts.grid - 1
        sampled = -(-intervals // _SAMPLE)  # rounded up
        yield f"{audit} {confirmation.format(sampled, intervals)}"
    yield f"Inputs are read as: {manifest.inputs}"
