"""Every file of a dataset; the same solution gives the same bytes."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
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

_MOST_DOUBLES = 1000  # transits; more are written as decimals alone, which read as the same doubles
_TEXTS = texts_of(__file__)
MEANING: dict[Level, str] = _TEXTS["levels"]
CONFIRMED: dict[Confirmation, str] = _TEXTS["confirmations"]
NOTES: dict[str, str] = _TEXTS["notes"]  # on the vectors
MOST = 16  # states, and as many transits


def render(
    solution: Solution, name: str | None = None, *, tables: bool = True
) -> dict[str, Content]:
    """Return the content of every file of a dataset, by file name.

    `name` is the id of the dataset, by default the scene's own.

    Without `tables` they are manifest and golden function alone.
    """
    sheets = _sheets(solution)
    record = manifest_of(solution, sheets, name, tables)
    contents: dict[str, Content] = {}
    if tables:
        contents |= {file: sheet.csv() for file, sheet in sheets.items()}
        contents |= derived_texts(record, sheets)
    if solution.proof and solution.proof.enclosure.function:
        function = solution.proof.enclosure.function
        description, data = FUNCTION
        contents[description] = FunctionRecord.of(function, record).text()
        contents[data] = function.data
    files = {file: FileRecord.of(content) for file, content in contents.items()}
    manifest = record.model_copy(update={"files": files}).sealed()
    return {MANIFEST: manifest.text(), **contents}


def _sheets(solution: Solution) -> dict[str, Sheet]:
    """Return the CSV tables of a solution, by file name."""
    grid = grid_sheet(solution)
    doubles = {"t": [float(t) for t in solution.times], **nearest_doubles(solution.grid, grid)}
    sheets = {"grid.csv": grid, "grid.binary64.csv": binary64_sheet(grid, doubles)}
    if solution.scene.run.transits:
        transits = transits_sheet(solution)
        sheets["transits.csv"] = transits
        if len(transits.rows) <= _MOST_DOUBLES:
            doubles = nearest_doubles(solution.transits, transits)
            sheets["transits.binary64.csv"] = binary64_sheet(transits, doubles)
    if solution.scene.run.sections:
        sheets["sections.csv"] = sections_sheet(solution)
    return sheets


def check_proved(contents: Mapping[str, Content], solution: Solution) -> None:
    """Let trusted code compare the files of a dataset with what was proved.

    Without a proof, or a manifest that claims one, nothing is compared.

    Where tables are left out, its manifest is compared with those that it describes.

    Raises:
        DatasetError: they state something else.
    """
    manifest = json.loads(contents[MANIFEST])
    if manifest["level"] != "enclosed" and solution.proof is None:
        return
    if ALWAYS[0] not in contents:
        contents = {**render(solution, manifest["id"]), **contents}
    from ..enclosure.trusted.printed import check_dataset

    enclosure = solution.proof and solution.proof.enclosure
    files: dict[str, Any] = dict(contents)
    description, data = FUNCTION
    try:
        check_dataset(files, enclosure and enclosure.proved)
        if enclosure and data in files:
            from ..enclosure.trusted.function import check_function

            check_function(files[description], files[data], enclosure.function, enclosure.proved)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise DatasetError(solution.scene.id, [f"this is not what was proved; {error}"]) from error


def derived_texts(manifest: Manifest, tables: dict[str, Sheet]) -> dict[str, str]:
    """Return the files that follow from manifest and tables: the page for people, and the vectors."""
    texts = {"certified.txt": _page(manifest, tables["grid.csv"], tables.get("transits.csv"))}
    if "grid.binary64.csv" in tables:
        texts["vectors.json"] = vectors(manifest, tables).text()
    return texts


def _page(manifest: Manifest, grid: Sheet, transits: Sheet | None) -> str:
    """Return the page for people; values are called certified if they are proven."""
    lines = [
        *_head(manifest),
        *_inputs(manifest),
        *_states(manifest, grid),
        *_accuracy(manifest),
        *_transits(manifest, transits),
        *_how_to(manifest),
    ]
    return "\n".join(lines)


def _head(manifest: Manifest) -> Iterator[str]:
    """Yield what was solved, its level, how its inputs are read, and why it is hard."""
    yield f"Foucault pendulum reference: {manifest.id}"
    yield manifest.title
    if manifest.source:
        yield f"Source: {manifest.source}"
    yield ""
    yield f"Level: {manifest.level}. {MEANING[manifest.level]}"
    yield from _confirmation(manifest)
    yield f"Inputs are read as: {manifest.inputs}"
    if manifest.flags:
        yield "Why it is hard:"
    for flag in manifest.flags:
        yield f"  {flag}: {manifest.notes[flag]}"
    yield ""


def _confirmation(manifest: Manifest) -> Iterator[str]:
    """Yield the line on a proof's audit and confirmation, where the command names one."""
    if CONFIRM not in manifest.command.split():
        return
    making = Making.of(manifest.command)
    audit = "FLINT alone proves the same digits." if making.audit else "It is not audited."
    intervals = manifest.counts.grid - 1
    sampled = -(-intervals // SAMPLED)  # rounded up
    yield f"{audit} {CONFIRMED[making.confirm].format(sampled, intervals)}"


def _inputs(manifest: Manifest) -> Iterator[str]:
    """Yield the inputs of the scene, and its model."""
    yield "Inputs (SI units, angles in degrees)"
    for field, value in by_field(manifest.scene).items():
        yield f"  {field:26} {value}"
    yield ""
    yield "Model: full Lagrangian of the Foucault pendulum (Mathar), axes x east, y north, z up, origin at the"
    yield f"suspension; {_TEXTS['gravity'][manifest.scene['site']['gravity_is']]}"
    yield ""


def _states(manifest: Manifest, grid: Sheet) -> Iterator[str]:
    """Yield the first and the last state."""
    first = grid.rows[0]
    last = grid.rows[-1]
    width = max(len(text) for text in (*first[1:], *last[1:]))
    word = "Certified state" if manifest.level == "enclosed" else "State"
    for title, row in (("State", first), (word, last)):
        yield f"{title} at t = {row[0]} s"
        for name, value in zip(GRID_HEADER[1:], row[1:], strict=True):
            yield f"  {name:3} {value:>{width}}"
        yield ""


def _accuracy(manifest: Manifest) -> Iterator[str]:
    """Yield the bounds on positions and velocities."""
    bounds = manifest.bounds
    yield f"Bound on every position {bounds.position_m} m, on every velocity {bounds.velocity_m_s} m/s"
    yield "  by column: " + ", ".join(f"{name} {bound}" for name, bound in bounds.grid.items())
    yield ""


def _transits(manifest: Manifest, transits: Sheet | None) -> Iterator[str]:
    """Yield the number of transits, the first, the last, and intervals that may hold more."""
    count = manifest.counts.transits
    yield f"Transits (xdot = 0, t > 0): {count} ({manifest.transits})"
    if transits is not None and transits.rows:
        for word, row in (("first", transits.rows[0]), ("last", transits.rows[-1])):
            yield f"  {word:5} t = {row[1]} s, direction {row[2]}, bound {row[-1]} s"
    if count:
        yield f"  largest bound on a time {manifest.bounds.transit_s} s"
    if count and all(check.transit_s is None for check in manifest.cross_checks):
        yield "  the proof alone confirms them"
    for interval in manifest.possible:
        place = f"[{interval.from_s}, {interval.to_s}] s"
        yield f"  possible transit in {place} ({interval.parity} number of zeros): not decided"


def _how_to(manifest: Manifest) -> Iterator[str]:
    """Yield how to score a program, and the passages of each section."""
    yield ""
    yield "How to score: compare your t, x, y, z with grid.csv; grid.binary64.csv holds the nearest doubles,"
    yield "also as hexfloats. A program that reads its inputs as doubles solves the problem whose inputs are"
    yield f"read as binary64; this dataset reads them as {manifest.inputs}."
    counts = manifest.sections.counts if manifest.sections else {}
    for word, count in counts.items():
        yield f"Passages in sections.csv: {count} of {word}"
    yield ""


class Value(ManifestPart):
    """A number as a decimal and as the nearest double, with a bound on the decimal's error, in the same unit."""

    decimal: Decimal
    hexfloat: Name
    bound: Decimal


class StateVector(ManifestPart):
    """The state at a grid time; `row` counts the rows of `grid.csv` from 1."""

    row: int
    flags: list[Name]
    values: dict[Name, Value]


class TransitVector(ManifestPart):
    """A zero of xdot.

    `k` is its number in `transits.csv`, and the direction is +1 where xdot goes from - to +.
    """

    k: int
    direction: int
    flags: list[Name]
    values: dict[Name, Value]


class Vectors(ManifestPart):
    """`vectors.json`: the inputs of a scene, and the results that a program must return for them."""

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
    """Return the vectors of a dataset, evenly spread over the rows of its tables."""
    states = _state_vectors(manifest, tables)
    transits = _transit_vectors(manifest, tables)
    columns = dict.fromkeys((*NUMBERS["grid"], *NUMBERS["transits"]))
    used = {flag for state in states for flag in state.flags}
    used |= {flag for transit in transits for flag in transit.flags}
    return Vectors(
        schema_version=FORMAT,
        **manifest.model_dump(include={"id", "level", "digits", "inputs", "frame", "scene"}),
        columns={name: UNITS[KINDS[name]] for name in columns},
        notes=manifest.notes | {flag: note for flag, note in NOTES.items() if flag in used},
        states=states,
        transits=transits,
    )


def _state_vectors(manifest: Manifest, tables: Mapping[str, Sheet]) -> list[StateVector]:
    """Return the states of some rows, with the first and the last."""
    count = len(tables["grid.csv"].rows)
    flagged = {"release": [0], "end": [count - 1]}
    return [
        StateVector(
            row=i + 1, flags=_flags(flagged, i), values=_values(manifest, tables, "grid", i)
        )
        for i in _spread(count, MOST)
    ]


def _transit_vectors(manifest: Manifest, tables: Mapping[str, Sheet]) -> list[TransitVector]:
    """Return some transits, with the first, the last, and the two that are closest."""
    transits = tables.get("transits.csv", Sheet((), [], {}))
    count = len(transits.rows)
    pair = _closest_pair(transits)
    flagged = {"end": [count - 1], "closest_pair": pair}
    vectors = []
    for i in sorted({*_spread(count, MOST - len(pair)), *pair}):
        direction = int(transits.rows[i][transits.header.index("direction")])
        values = _values(manifest, tables, "transits", i)
        flags = _flags(flagged, i)
        vectors.append(TransitVector(k=i + 1, direction=direction, flags=flags, values=values))
    return vectors


def _spread(count: int, most: int) -> list[int]:
    """Return at most `most` row numbers out of `count`, evenly spread, with first and last."""
    if count <= most:
        return list(range(count))
    return [i * (count - 1) // (most - 1) for i in range(most)]


def _flags(flagged: Mapping[str, list[int]], i: int) -> list[str]:
    """Return the flags of a row."""
    return [flag for flag, rows in flagged.items() if i in rows]


def _closest_pair(transits: Sheet) -> list[int]:
    """Return the row numbers of the two closest neighbours; none of fewer than three transits."""
    if len(transits.rows) < 3:
        return []
    times = [t for (t,) in transits.numbers(("t",))]
    first = min(range(len(times) - 1), key=lambda i: times[i + 1] - times[i])
    return [first, first + 1]


def _values(manifest: Manifest, tables: Mapping[str, Sheet], kind: Any, i: int) -> dict[str, Value]:
    """Return the numbers of a row, with their bounds.

    The bound on a transit's time is its own; the others are those of their columns.
    """
    plain = tables[f"{kind}.csv"]
    row = dict(zip(plain.header, plain.rows[i], strict=True))
    doubles = tables.get(f"{kind}.binary64.csv")
    if doubles is None:
        hexfloats = {f"{name}_hex": float(row[name]).hex() for name in NUMBERS[kind]}
    else:
        hexfloats = dict(zip(doubles.header, doubles.rows[i], strict=True))
    bounds = {**getattr(manifest.bounds, kind), "t": row.get("bound", "0")}
    return {
        name: Value(decimal=row[name], hexfloat=hexfloats[f"{name}_hex"], bound=bounds[name])
        for name in NUMBERS[kind]
    }
