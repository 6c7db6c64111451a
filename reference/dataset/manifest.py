"""`manifest.json` of a golden dataset: its fields and their types, which refuse extra keys, its text and its seal."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from ..numbers.columns import GRID, TRANSITS
from ..numbers.precision import rounded_up
from ..scenes.fields import Level
from ..scenes.scene import Reading

MANIFEST = "manifest.json"
FORMAT = 3
# bounded: an exponent of nine digits fills the memory
NUMBER = r"^-?[0-9]{1,1100}(\.[0-9]{1,1100})?(e[+-][0-9]{1,4})?$"


def _bound_as_text(value: object) -> object:
    return rounded_up(value) if isinstance(value, Fraction) else value


Decimal = Annotated[str, Field(pattern=NUMBER), BeforeValidator(_bound_as_text)]
Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Name = Annotated[str, Field(max_length=400)]
Text = Annotated[str, Field(max_length=20_000)]
Kind = Literal["grid", "transits", "sections"]  # of a table
Count = Annotated[int, Field(ge=0, le=10**10)]
Decimals = Annotated[int, Field(ge=0, le=2000)]  # digits after the point
FileName = Literal[
    "grid.csv",
    "certified.txt",
    "transits.csv",
    "grid.binary64.csv",
    "transits.binary64.csv",
    "vectors.json",
    "function.json",
    "function.f64",
    "sections.csv",
]
ALWAYS, OPTIONAL = get_args(FileName)[:2], get_args(FileName)[2:]
FUNCTION: tuple[FileName, FileName] = ("function.json", "function.f64")
Content = str | bytes  # of a file


def text_of(document: dict[str, Any]) -> str:
    """Return the text of a file that holds a document, in the one form that is accepted."""
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


class ManifestPart(BaseModel):
    """A document or a part of one: frozen, without extra keys; read from a dictionary or from what has its names."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, from_attributes=True)

    def text(self) -> str:
        """Return the text of the file that holds the document."""
        return text_of(self.model_dump())


class Bounds(ManifestPart):
    """How far any printed number may be from the truth, rounding to its digits included: m, m/s, s, m/s².

    The first three are the largest of their kind, `transit_s` only where there are transits; `grid` and `transits` are
    by column, the largest of all rows.
    """

    position_m: Decimal
    velocity_m_s: Decimal
    transit_s: Decimal | None
    grid: dict[Name, Decimal]
    transits: dict[Name, Decimal]


class Counts(ManifestPart):
    """Rows of the tables; `possible` are transits that could not be decided."""

    grid: Count
    transits: Count
    possible: Count


class Invariant(ManifestPart):
    """h = v²/2 + g z - Ω²/2 (x² + q²) at t = 0 in m²/s², and its largest change over the printed rows."""

    h_m2_s2: Decimal
    drift_m2_s2: Decimal


class Equations(ManifestPart):
    """The formulation that the numbers come from, its compiled lines, and what the scene left out."""

    formulation: Name
    lines: list[Text]
    left_out: list[Text]


class RunRecord(ManifestPart):
    """A run: formulation, number type, order and steps of the Taylor method."""

    formulation: Name
    number: Name
    order: Count
    steps: Count


class CrossCheckRecord(RunRecord):
    """A second run, and its largest disagreement with the published numbers."""

    position_m: Decimal
    velocity_m_s: Decimal
    transit_s: Decimal | None


class Possible(ManifestPart):
    """An interval in s that may hold transits which no enclosure can decide (a grazing zero)."""

    from_s: Decimal
    to_s: Decimal
    parity: Literal["odd", "even", "unknown"]


class SectionsRecord(ManifestPart):
    """What `sections.csv` holds: digits and largest bound of each column; of each section its passages.

    `counts` are its rows, and `possible` intervals in which the proof could not decide.
    """

    decimals: dict[Name, Decimals]
    bounds: dict[Name, Decimal]
    counts: dict[Name, Count]
    possible: dict[Name, list[Possible]]


class EnclosureRecord(ManifestPart):
    """The proof: its method, size and largest radii, and the bits to which the run that was proved agrees with it."""

    method: Name
    prec: Count
    order: Count
    steps: Count
    position_radius_m: Decimal
    velocity_radius_m_s: Decimal
    transit_radius_s: Decimal | None
    agreement_bits: int


class FileRecord(ManifestPart):
    """Size and hash of a file of the dataset."""

    bytes: Count
    sha256: Sha256

    @classmethod
    def of(cls, content: Content) -> FileRecord:
        """Return the record of a file with this content."""
        data = content if isinstance(content, bytes) else content.encode()
        return cls(bytes=len(data), sha256=hashlib.sha256(data).hexdigest())


class Manifest(ManifestPart):
    """`manifest.json`; numbers that matter are strings.

    `seal` is the sha256 of the same text with an empty seal. It finds accidents; a forger can make it again.
    """

    schema_version: Literal[3]  # FORMAT
    seal: Sha256 | Literal[""]
    id: Name
    title: Text
    source: Text
    flags: list[Name]
    notes: dict[Name, Text]
    scene: dict[Name, dict[Name, Text]]
    inputs: Reading
    frame: Text
    units: dict[Name, Name]
    level: Level
    digits: Count
    decimals: dict[Kind, dict[Name, Decimals]]
    bounds: Bounds
    counts: Counts
    transits: Literal[
        "complete", "undecided intervals", "not asked for", "xdot is identically zero"
    ]
    possible: list[Possible]
    invariant: Invariant
    equations: Equations
    run: RunRecord
    cross_checks: list[CrossCheckRecord]
    enclosure: EnclosureRecord | None
    generator: dict[Name, Name]
    command: Text
    files: dict[FileName, FileRecord]
    # where the scene asks for some; else it does not stand there
    sections: SectionsRecord | None = None

    def text(self) -> str:
        """Return the text of the file, without sections where there are none."""
        return text_of(self.model_dump(exclude=None if self.sections else {"sections"}))

    @model_validator(mode="after")
    def _agrees_with_itself(self) -> Self:
        bounds, transits = self.bounds, TRANSITS if self.counts.transits else ()
        needed = [
            *ALWAYS,
            *["transits.csv"] * bool(transits),
            *["sections.csv"] * bool(self.sections),
        ]
        lacking = [] if self.alone else [name for name in needed if name not in self.files]
        sections, function = bool(self.sections), [name in self.files for name in FUNCTION]
        numbers = map(float, (*bounds.grid.values(), *bounds.transits.values()))
        of_grid, of_transits = ({*self.decimals.get(kind, ())} for kind in ("grid", "transits"))
        rules = {
            "level: a proof and the level enclosed belong together": (self.level == "enclosed")
            == bool(self.enclosure),
            "level: no run agrees with the published one": bool(self.cross_checks)
            or self.level == "computed",
            "level: a single run has no cross-checks": not (
                self.cross_checks and self.level == "computed"
            ),
            "notes: one for each flag": {*self.notes} == {*self.flags},
            "counts: a grid has two times at least": self.counts.grid >= 2,
            f"bounds.grid: must name the columns {', '.join(GRID)}": tuple(bounds.grid) == GRID,
            f"bounds.transits: must name the columns {', '.join(TRANSITS)}": tuple(bounds.transits)
            == transits,
            "bounds: a number beyond the range of binary64": all(map(math.isfinite, numbers)),
            f"decimals.grid: must name the columns {', '.join(('t', *GRID))}": of_grid
            == {"t", *GRID},
            f"decimals.transits: must name the columns {', '.join(TRANSITS)}": of_transits
            in ({*TRANSITS}, {*transits}),
            f"files: {' and '.join(lacking)} must be there, but for a golden function alone": not lacking,
            "sections: they belong to a scene that asks for some": sections
            == ("sections" in self.scene.get("run", ())),
            "files: sections.csv belongs to a dataset with sections": sections
            or "sections.csv" not in self.files,
            "files: a golden function has two files, and a proof": function[0]
            == function[1]
            <= bool(self.enclosure),
        }
        if broken := [rule for rule, holds in rules.items() if not holds]:
            raise ValueError(broken[0])
        return self

    @property
    def alone(self) -> bool:
        """Whether the dataset is a golden function alone, without tables."""
        return tuple(self.files) == FUNCTION

    def expected_seal(self) -> str:
        """Return the seal that belongs to everything else in the manifest."""
        return hashlib.sha256(self.model_copy(update={"seal": ""}).text().encode()).hexdigest()

    def sealed(self) -> Manifest:
        """Return the manifest with its seal."""
        return self.model_copy(update={"seal": self.expected_seal()})

    def bound(self, table: Kind, column: str) -> Fraction:
        """Return the bound on a column's printed numbers, the largest of all rows."""
        bounds = (
            self.sections.bounds
            if table == "sections" and self.sections
            else getattr(self.bounds, table)
        )
        return Fraction(bounds[column])


def differences(old: Any, new: Any, place: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Yield each field in which two documents differ: where it stands, and both values."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in {**old, **new}:
            yield from differences(old.get(key), new.get(key), f"{place}.{key}" if place else key)
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for i, (old_item, new_item) in enumerate(zip(old, new, strict=True)):
            yield from differences(old_item, new_item, f"{place}[{i}]")
    elif old != new:
        yield place, old, new
