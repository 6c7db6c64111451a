"""`manifest.json` of a golden dataset: its fields and their types, as pydantic models that refuse extra keys."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from ..scene import Level, Reading

Decimal = Annotated[str, Field(pattern=r"^-?[0-9]+(\.[0-9]+)?(e[+-][0-9]+)?$")]
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Bounds(_Part):
    """How far any printed number of a kind may be from the truth: m, m/s, s; s only where there are transits."""

    position_m: Decimal
    velocity_m_s: Decimal
    transit_s: Decimal | None


class Counts(_Part):
    """Rows of the tables; `possible` are transits that could not be decided."""

    grid: int
    transits: int
    possible: int


class Invariant(_Part):
    """h = v²/2 + g z - Ω²/2 (x² + q²) at t = 0 in m²/s², and its largest change over the printed rows."""

    h_m2_s2: Decimal
    drift_m2_s2: Decimal


class Equations(_Part):
    """The formulation that the numbers come from, its compiled lines, and what the scene left out."""

    formulation: str
    lines: list[str]
    left_out: list[str]


class RunRecord(_Part):
    """A run: formulation, number type, order and steps of the Taylor method."""

    formulation: str
    number: str
    order: int
    steps: int


class CrossCheckRecord(RunRecord):
    """A second run, and its largest disagreement with the published numbers."""

    position_m: Decimal
    velocity_m_s: Decimal
    transit_s: Decimal | None


class Possible(_Part):
    """An interval in s that may hold transits which no enclosure can decide (a grazing zero)."""

    from_s: Decimal
    to_s: Decimal
    parity: Literal["odd", "even", "unknown"]


class EnclosureRecord(_Part):
    """The proof: its method, size and largest radii, and the bits to which heyoka's run agrees with it."""

    method: str
    prec: int
    order: int
    steps: int
    position_radius_m: Decimal
    velocity_radius_m_s: Decimal
    transit_radius_s: Decimal | None
    agreement_bits: int


class FileRecord(_Part):
    """Size and hash of a file of the dataset."""

    bytes: int
    sha256: Sha256


class Manifest(_Part):
    """`manifest.json`; numbers that matter are strings."""

    schema_version: Literal[1]
    id: str
    title: str
    source: str
    flags: list[str]
    scene: dict[str, dict[str, str]]
    inputs: Reading
    frame: str
    units: dict[str, str]
    level: Level
    digits: int
    decimals: dict[str, dict[str, int]]
    bounds: Bounds
    counts: Counts
    transits: Literal["complete", "undecided intervals", "not asked for", "xdot is identically zero"]
    possible: list[Possible]
    invariant: Invariant
    equations: Equations
    run: RunRecord
    cross_checks: list[CrossCheckRecord]
    enclosure: EnclosureRecord | None
    generator: dict[str, str]
    command: str
    files: dict[str, FileRecord]

    def text(self) -> str:
        """Return the text of `manifest.json`."""
        return json.dumps(self.model_dump(), indent=1, ensure_ascii=False) + "\n"


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a manifest, as published in `schema/manifest.schema.json`."""
    schema = Manifest.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
