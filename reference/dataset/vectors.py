"""`vectors.json`: some states and transits with bounds, for tests in other languages, in the manner of wycheproof."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..numbers.columns import KINDS, UNITS
from .manifest import FORMAT, Decimal, Manifest, Name, Part, Text
from .sheets import NUMBERS, Sheet

MOST = 16  # states, and as many transits
NOTES = {
    "release": "The exact release: an error here is one of reading the inputs.",
    "end": "The last of the run, where the error of an integrator is usually largest.",
    "closest_pair": "One of the two transits nearest to each other: an event search with long steps loses both.",
}


class Value(Part):
    """A number: as a decimal, as the nearest double, and how far the decimal may be from the truth, in its unit."""

    decimal: Decimal
    hexfloat: Name
    bound: Decimal


class StateVector(Part):
    """The state at a grid time; `row` counts the rows of `grid.csv` from 1."""

    row: int
    flags: list[Name]
    values: dict[Name, Value]


class TransitVector(Part):
    """A zero of xdot; `k` is its number in `transits.csv`, and the direction is +1 where xdot goes from - to +."""

    k: int
    direction: int
    flags: list[Name]
    values: dict[Name, Value]


class Vectors(Part):
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
    """Return the vectors of a dataset from its manifest and its tables, evenly spread over their rows."""
    grid, transits = tables["grid.csv"], tables.get("transits.csv", Sheet((), [], {}))
    pair = _closest_pair(transits)
    of_grid = {"release": [0], "end": [len(grid.rows) - 1]}
    of_transits = {"end": [len(transits.rows) - 1], "closest_pair": pair}
    states = [
        StateVector(row=i + 1, flags=_flags(of_grid, i), values=_values(manifest, tables, "grid", i))
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
    used = {flag for state in states for flag in state.flags} | {flag for zero in zeros for flag in zero.flags}
    return Vectors(
        schema_version=FORMAT,
        **manifest.model_dump(include={"id", "level", "digits", "inputs", "frame", "scene"}),
        columns={name: UNITS[KINDS[name]] for name in dict.fromkeys((*NUMBERS["grid"], *NUMBERS["transits"]))},
        notes={**manifest.notes, **{flag: note for flag, note in NOTES.items() if flag in used}},
        states=states,
        transits=zeros,
    )


def _spread(count: int, most: int) -> list[int]:
    """Return the numbers of at most `most` rows out of `count`, evenly spread, with the first and the last."""
    return list(range(count)) if count <= most else [i * (count - 1) // (most - 1) for i in range(most)]


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
    bounds = {"t": row.get("bound", "0"), **{k: b for k, b in getattr(manifest.bounds, kind).items() if k != "t"}}
    return {
        name: Value(decimal=row[name], hexfloat=hexfloats[f"{name}_hex"], bound=bounds[name]) for name in NUMBERS[kind]
    }
