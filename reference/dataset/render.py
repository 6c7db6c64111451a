"""Every file of a dataset: manifest, CSV tables, vectors, page, function; the same solution gives the same bytes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from ..errors import DatasetError
from ..numbers.columns import KINDS, UNITS
from ..scenes.fields import Confirmation, Level
from ..solver.solution import SAMPLED, Solution
from ..system.documents import texts_of
from .function import FunctionRecord
from .making import CONFIRM, Making
from .manifest import (
    ALWAYS,
    FORMAT,
    FUNCTION,
    MANIFEST,
    Content,
    Decimal,
    FileRecord,
    Manifest,
    ManifestPart,
    Name,
    Text,
)
from .record import manifest_of
from .sheets import (
    GRID_HEADER,
    NUMBERS,
    Sheet,
    binary64_sheet,
    by_field,
    grid_sheet,
    nearest_doubles,
    sections_sheet,
    transits_sheet,
)

MOST_DOUBLES = 1000  # transits; more are written as decimals alone, which read as the same doubles
TEXTS = texts_of(__file__)
MEANING: dict[Level, str] = TEXTS["levels"]
CONFIRMED: dict[Confirmation, str] = TEXTS["confirmations"]
NOTES: dict[str, str] = TEXTS["notes"]  # on the vectors
MOST = 16  # states, and as many transits


def render(
    solution: Solution, name: str | None = None, *, tables: bool = True
) -> dict[str, Content]:
    """Return the content of every file of a dataset, by file name; `name` is its id, by default the scene's own.

    Without `tables` they are manifest and golden function alone.
    """
    grid = grid_sheet(solution)
    of_grid = {"t": [float(t) for t in solution.times], **nearest_doubles(solution.grid, grid)}
    sheets = {"grid.csv": grid, "grid.binary64.csv": binary64_sheet(grid, of_grid)}
    if solution.scene.run.transits:
        sheets["transits.csv"] = transits = transits_sheet(solution)
        if len(transits.rows) <= MOST_DOUBLES:
            of_transits = nearest_doubles(solution.transits, transits)
            sheets["transits.binary64.csv"] = binary64_sheet(transits, of_transits)
    if solution.scene.run.sections:
        sheets["sections.csv"] = sections_sheet(solution)
    record = manifest_of(solution, sheets, name, tables)
    contents: dict[str, Content] = {}
    if tables:
        contents |= {name: sheet.csv() for name, sheet in sheets.items()} | derived_texts(
            record, sheets
        )
    if solution.proof and (function := solution.proof.enclosure.function):
        contents |= zip(
            FUNCTION, (FunctionRecord.of(function, record).text(), function.data), strict=True
        )
    manifest = record.model_copy(
        update={"files": {file: FileRecord.of(text) for file, text in contents.items()}}
    )
    return {MANIFEST: manifest.sealed().text(), **contents}


def check_proved(contents: Mapping[str, Content], solution: Solution) -> None:
    """Have trusted code hold the files of a dataset that is proved, or that says so, against what was proved.

    Of tables that are left out its manifest is held against those that it belongs to.

    Raises:
        DatasetError: they state something else.
    """
    manifest = json.loads(contents[MANIFEST])
    if manifest["level"] != "enclosed" and solution.proof is None:
        return
    if ALWAYS[0] not in contents:
        contents = {**render(solution, manifest["id"]), **contents}
    from ..enclosure.trusted.printed import check_dataset

    enclosure, files = solution.proof and solution.proof.enclosure, dict[str, Any](contents)
    try:
        check_dataset(files, enclosure and enclosure.proved)
        if enclosure and FUNCTION[1] in files:
            from ..enclosure.trusted.function import check_function

            check_function(
                files[FUNCTION[0]], files[FUNCTION[1]], enclosure.function, enclosure.proved
            )
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise DatasetError(solution.scene.id, [f"this is not what was proved; {error}"]) from error


def derived_texts(manifest: Manifest, tables: dict[str, Sheet]) -> dict[str, str]:
    """Return the files that follow from the manifest and the tables: the page for people, and the vectors."""
    page = {
        "certified.txt": certified_page(manifest, tables["grid.csv"], tables.get("transits.csv"))
    }
    return page | (
        {"vectors.json": vectors(manifest, tables).text()} if "grid.binary64.csv" in tables else {}
    )


def certified_page(manifest: Manifest, grid: Sheet, transits: Sheet | None) -> str:
    """Return the page that belongs to a manifest and its tables; values are called certified if they are proven."""
    return "\n".join(
        [
            *_inputs(manifest),
            *_states(manifest, grid),
            *_accuracy(manifest, transits),
            *_how_to(manifest),
        ]
    )


def _inputs(manifest: Manifest) -> list[str]:
    return [
        f"Foucault pendulum reference: {manifest.id}",
        manifest.title,
        *([f"Source: {manifest.source}"] if manifest.source else []),
        "",
        f"Level: {manifest.level}. {MEANING[manifest.level]}",
        *_confirmation(manifest),
        f"Inputs are read as: {manifest.inputs}",
        *(["Why it is hard:"] if manifest.flags else []),
        *(f"  {flag}: {manifest.notes[flag]}" for flag in manifest.flags),
        "",
        "Inputs (SI units, angles in degrees)",
        *(f"  {field:26} {value}" for field, value in by_field(manifest.scene).items()),
        "",
        "Model: full Lagrangian of the Foucault pendulum (Mathar), axes x east, y north, z up, origin at the",
        f"suspension; {TEXTS['gravity'][manifest.scene['site']['gravity_is']]}",
        "",
    ]


def _confirmation(manifest: Manifest) -> list[str]:
    """Return the line on a proof's audit and confirmation, where the command names one."""
    if CONFIRM not in manifest.command.split():
        return []
    making, rows = Making.of(manifest.command), manifest.counts.grid - 1
    audit = "FLINT alone proves the same digits." if making.audit else "It is not audited."
    return [f"{audit} {CONFIRMED[making.confirm].format(-(-rows // SAMPLED), rows)}"]


def _states(manifest: Manifest, grid: Sheet) -> list[str]:
    first, last = grid.rows[0], grid.rows[-1]
    width = max(len(text) for row in (first, last) for text in row[1:])
    word = "Certified state" if manifest.level == "enclosed" else "State"
    lines = []
    for title, row in ((f"State at t = {first[0]} s", first), (f"{word} at t = {last[0]} s", last)):
        numbers = zip(GRID_HEADER[1:], row[1:], strict=True)
        lines += [title, *(f"  {name:3} {value:>{width}}" for name, value in numbers), ""]
    return lines


def _accuracy(manifest: Manifest, transits: Sheet | None) -> list[str]:
    bounds, count = manifest.bounds, manifest.counts.transits
    lines = [
        f"Bound on every position {bounds.position_m} m, on every velocity {bounds.velocity_m_s} m/s",
        "  by column: " + ", ".join(f"{name} {bound}" for name, bound in bounds.grid.items()),
        "",
        f"Transits (xdot = 0, t > 0): {count} ({manifest.transits})",
    ]
    if transits is not None and transits.rows:
        ends = (("first", transits.rows[0]), ("last", transits.rows[-1]))
        lines += [
            f"  {word:5} t = {row[1]} s, direction {row[2]}, bound {row[-1]} s"
            for word, row in ends
        ]
    if count:
        lines += [f"  largest bound on a time {bounds.transit_s} s"]
    if count and all(check.transit_s is None for check in manifest.cross_checks):
        lines += ["  the proof alone confirms them"]
    return lines + [
        f"  possible transit in [{interval.from_s}, {interval.to_s}] s ({interval.parity} number of zeros): not decided"
        for interval in manifest.possible
    ]


def _how_to(manifest: Manifest) -> list[str]:
    counts = manifest.sections.counts if manifest.sections else {}
    return [
        "",
        "How to score: compare your t, x, y, z with grid.csv; grid.binary64.csv holds the nearest doubles,",
        "also as hexfloats. A program that reads its inputs as doubles solves the problem whose inputs are",
        f"read as binary64; this dataset reads them as {manifest.inputs}.",
        *(f"Passages in sections.csv: {count} of {word}" for word, count in counts.items()),
        "",
    ]


class Value(ManifestPart):
    """A number: as a decimal, as the nearest double, and how far the decimal may be from the truth, in its unit."""

    decimal: Decimal
    hexfloat: Name
    bound: Decimal


class StateVector(ManifestPart):
    """The state at a grid time; `row` counts the rows of `grid.csv` from 1."""

    row: int
    flags: list[Name]
    values: dict[Name, Value]


class TransitVector(ManifestPart):
    """A zero of xdot; `k` is its number in `transits.csv`, and the direction is +1 where xdot goes from - to +."""

    k: int
    direction: int
    flags: list[Name]
    values: dict[Name, Value]


class Vectors(ManifestPart):
    """`vectors.json`: the inputs of a scene, and what a program has to give for them."""

    schema_version: int
    id: Name
    level: Name
    digits: int
    inputs: Name
    frame: Text
    scene: dict[Name, dict[Name, Text]]
    columns: dict[Name, Name]
    notes: dict[Name, Text]
    states: list[StateVector]
    transits: list[TransitVector]


def vectors(manifest: Manifest, tables: Mapping[str, Sheet]) -> Vectors:
    """Return the vectors of a dataset, for tests in other languages, evenly spread over the rows of its tables."""
    grid, transits = tables["grid.csv"], tables.get("transits.csv", Sheet((), [], {}))
    pair = _closest_pair(transits)
    of_grid = {"release": [0], "end": [len(grid.rows) - 1]}
    of_transits = {"end": [len(transits.rows) - 1], "closest_pair": pair}
    states = [
        StateVector(
            row=i + 1, flags=_flags(of_grid, i), values=_values(manifest, tables, "grid", i)
        )
        for i in _spread(len(grid.rows), MOST)
    ]
    zeros = [
        TransitVector(
            k=i + 1,
            direction=int(transits.rows[i][transits.header.index("direction")]),
            flags=_flags(of_transits, i),
            values=_values(manifest, tables, "transits", i),
        )
        for i in sorted({*_spread(len(transits.rows), MOST - len(pair)), *pair})
    ]
    used = {flag for state in states for flag in state.flags} | {
        flag for zero in zeros for flag in zero.flags
    }
    return Vectors(
        schema_version=FORMAT,
        **manifest.model_dump(include={"id", "level", "digits", "inputs", "frame", "scene"}),
        columns={
            name: UNITS[KINDS[name]]
            for name in dict.fromkeys((*NUMBERS["grid"], *NUMBERS["transits"]))
        },
        notes={**manifest.notes, **{flag: note for flag, note in NOTES.items() if flag in used}},
        states=states,
        transits=zeros,
    )


def _spread(count: int, most: int) -> list[int]:
    """Return the numbers of at most `most` rows out of `count`, evenly spread, with the first and the last."""
    return (
        list(range(count))
        if count <= most
        else [i * (count - 1) // (most - 1) for i in range(most)]
    )


def _flags(places: Mapping[str, list[int]], i: int) -> list[str]:
    return [flag for flag, rows in places.items() if i in rows]


def _closest_pair(transits: Sheet) -> list[int]:
    if len(transits.rows) < 3:
        return []
    times = [row[0] for row in transits.numbers(("t",))]
    first = min(range(len(times) - 1), key=lambda i: times[i + 1] - times[i])
    return [first, first + 1]


def _values(manifest: Manifest, tables: Mapping[str, Sheet], kind: Any, i: int) -> dict[str, Value]:
    """Return the numbers of a row; the bound on a transit's time is its own, the others are those of their columns."""
    plain, doubles = tables[f"{kind}.csv"], tables.get(f"{kind}.binary64.csv")
    row = dict(zip(plain.header, plain.rows[i], strict=True))
    hexfloats = {f"{name}_hex": float(row[name]).hex() for name in NUMBERS[kind]}
    if doubles is not None:
        hexfloats = dict(zip(doubles.header, doubles.rows[i], strict=True))
    bounds = {
        "t": row.get("bound", "0"),
        **{k: b for k, b in getattr(manifest.bounds, kind).items() if k != "t"},
    }
    return {
        name: Value(decimal=row[name], hexfloat=hexfloats[f"{name}_hex"], bound=bounds[name])
        for name in NUMBERS[kind]
    }
