"""Every file of a dataset as text: manifest, CSV tables, vectors and page; the same solution gives the same bytes."""

from __future__ import annotations

import hashlib

from ..numbers.columns import TRANSITS
from ..solver.solution import Solution
from .certified import certified_page
from .manifest import MANIFEST, FileRecord, Manifest
from .record import manifest_of
from .sheets import Sheet, binary64_sheet, grid_sheet, nearest_doubles, transits_sheet
from .vectors import vectors

MOST_DOUBLES = 1000  # transits; more are written as decimals alone, which read as the same doubles


def render(solution: Solution, name: str | None = None) -> dict[str, str]:
    """Return the text of every file of a dataset, by file name; `name` is its id, by default the scene's own."""
    grid, transits = grid_sheet(solution), transits_sheet(solution)
    tables = {"grid.csv": grid, "grid.binary64.csv": binary64_sheet(grid, _grid_doubles(solution, grid))}
    if solution.scene.run.transits:
        tables["transits.csv"] = transits
        if len(transits.rows) <= MOST_DOUBLES:
            none: dict[str, list[float]] = {name: [] for name in TRANSITS}
            doubles = nearest_doubles(solution.transits, transits) if solution.transits is not None else none
            tables["transits.binary64.csv"] = binary64_sheet(transits, doubles)
    record = manifest_of(solution, grid, transits, name)
    texts = {name: sheet.csv() for name, sheet in tables.items()} | derived_texts(record, tables)
    _check_against_proof(solution, record, texts)
    manifest = Manifest.model_validate(
        {**dict(record), "files": {file: file_record(text) for file, text in texts.items()}}
    )
    return {MANIFEST: manifest.sealed().text(), **texts}


def _check_against_proof(solution: Solution, record: Manifest, texts: dict[str, str]) -> None:
    """Hold the tables, as they will be written, against the intervals that were proved."""
    if solution.proof is None:
        return
    from ..enclosure.printed import check_grid, check_transits

    proved = solution.proof.enclosed
    check_grid(texts["grid.csv"], proved.times, proved.states, record.bounds.grid)
    if "transits.csv" in texts:
        check_transits(texts["transits.csv"], proved.transits or (), record.bounds.transits)


def derived_texts(manifest: Manifest, tables: dict[str, Sheet]) -> dict[str, str]:
    """Return the files that follow from the manifest and the tables: the page for people, and the vectors."""
    page = {"certified.txt": certified_page(manifest, tables["grid.csv"], tables.get("transits.csv"))}
    return page | ({"vectors.json": vectors(manifest, tables).text()} if "grid.binary64.csv" in tables else {})


def file_record(text: str) -> FileRecord:
    """Return size and hash of a file."""
    data = text.encode()
    return FileRecord(bytes=len(data), sha256=hashlib.sha256(data).hexdigest())


def _grid_doubles(solution: Solution, grid: Sheet) -> dict[str, list[float]]:
    return {"t": [float(t) for t in solution.times], **nearest_doubles(solution.grid, grid)}
