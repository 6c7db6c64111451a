"""Forge a dataset as carefully as possible: doubles, vectors, page, counts, hashes and the seal are made to fit."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from reference.dataset.files import DatasetFiles, read_files
from reference.dataset.manifest import MANIFEST, Manifest
from reference.dataset.record import invariant_drift
from reference.dataset.render import derived_texts
from reference.dataset.sheets import NUMBERS, Sheet, binary64_sheet
from reference.numbers.precision import fixed_decimal

Rows = list[list[str]]
Change = Callable[[Rows, list[str]], object]  # of a table's rows of text, given the header


def forge(
    folder: Path,
    grid: Change | None = None,
    transits: Change | None = None,
    sections: Change | None = None,
    manifest: Callable[[dict[str, Any]], object] | None = None,
    without: Sequence[str] = (),
) -> None:
    """Change a dataset in place: its tables' rows, its manifest, and all that depends on them; leave files out."""
    files = read_files(folder)
    document = json.loads((folder / MANIFEST).read_text())
    texts, tables = dict(files.texts), dict(files.tables)
    for kind, change in (("grid", grid), ("transits", transits)):
        if change is not None:
            _change_table(tables, kind, change)
            document["counts"][kind] = len(tables[f"{kind}.csv"].rows)
            if kind == "transits":
                _change_bounds(document, tables["transits.csv"])
    if sections is not None:
        _change_table(tables, "sections", sections)
        rows, said = tables["sections.csv"].rows, document["sections"]
        said["counts"] = {word: sum(row[0] == word for row in rows) for word in said["counts"]}
        said["bounds"]["t"] = max((row[-1] for row in rows), key=Fraction)
    for name in without:
        document["files"].pop(name, None)
        texts.pop(name, None)
        tables.pop(name, None)
        (folder / name).unlink(missing_ok=True)
    if manifest is not None:
        manifest(document)
    if grid is not None:
        document["invariant"] = invariant_drift(files.scene, tables["grid.csv"]).model_dump()
    texts |= {name: sheet.csv() for name, sheet in tables.items()}
    # a manifest that contradicts itself has no page
    with contextlib.suppress(ValueError, KeyError):
        texts |= derived_texts(Manifest.model_validate(document), tables)
    seal(folder, document, texts)


def seal(folder: Path, document: dict[str, Any], texts: Mapping[str, str | bytes]) -> None:
    """Write files and manifest with hashes and a seal that fit."""
    for name, text in texts.items():
        data = text if isinstance(text, bytes) else text.encode()
        (folder / name).write_bytes(data)
        document["files"][name] = {"bytes": len(data), "sha256": hashlib.sha256(data).hexdigest()}
    document["seal"] = ""
    document["seal"] = hashlib.sha256(_text(document).encode()).hexdigest()
    (folder / MANIFEST).write_text(_text(document))


def _text(document: dict[str, Any]) -> str:
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def _change_table(tables: dict[str, Sheet], kind: str, change: Change) -> None:
    """Change the rows of a table, and write their doubles anew."""
    sheet = tables[f"{kind}.csv"]
    rows = [list(row) for row in sheet.rows]
    change(rows, list(sheet.header))
    forged = Sheet(sheet.header, [tuple(row) for row in rows], sheet.decimals)
    tables[f"{kind}.csv"] = forged
    if f"{kind}.binary64.csv" in tables:
        places = {name: sheet.header.index(name) for name in NUMBERS[kind]}
        doubles = {
            name: [float(Fraction(row[place])) for row in forged.rows]
            for name, place in places.items()
        }
        tables[f"{kind}.binary64.csv"] = binary64_sheet(forged, doubles)


def _change_bounds(document: dict[str, Any], transits: Sheet) -> None:
    """Have the bounds on all times say what the rows do."""
    bounds, largest = (
        document["bounds"],
        max((row[-1] for row in transits.rows), key=Fraction, default=None),
    )
    bounds["transit_s"] = largest
    bounds["transits"] = {**bounds["transits"], "t": largest} if largest else {}


def moved(text: str, by: Fraction) -> str:
    """Return a decimal changed by an amount, with as many digits; by one unit of the last at least."""
    places = len(text.partition(".")[2])
    unit = Fraction(1 if by > 0 else -1, 10**places)
    return fixed_decimal(Fraction(text) + (by if abs(by) > abs(unit) else unit), places)


def bound_of(files: DatasetFiles, kind: str, column: str, row: int) -> Fraction:
    """Return the bound on a printed number."""
    if column == "t":
        return (
            Fraction(files.tables[f"{kind}.csv"].rows[row][-1])
            if kind == "transits"
            else Fraction(0)
        )
    return files.manifest.bound(kind, column)  # type: ignore[arg-type]
