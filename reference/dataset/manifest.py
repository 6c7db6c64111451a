"""`manifest.json` of a golden dataset: its fields, their types and rules, its text and its seal."""

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
_NUMBER = r"^-?[0-9]{1,1100}(\.[0-9]{1,1100})?(e[+-][0-9]{1,4})?$"


def _bound_as_text(value: object) -> object:
    """Return a bound as text, rounded up; anything else as it is."""
    return rounded_up(value) if isinstance(value, Fraction) else value


Decimal = Annotated[str, Field(pattern=_NUMBER), BeforeValidator(_bound_as_text)]
_Sha256 = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
Name = Annotated[str, Field(max_length=400)]
Text = Annotated[str, Field(max_length=20_000)]
Kind = Literal["grid", "transits", "sections"]  # of a table
Count = Annotated[int, Field(ge=0, le=10**10)]
Decimals = Annotated[int, Field(ge=0, le=2000)]  # digits after the point
_FileName = Literal[
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
ALWAYS = get_args(_FileName)[:2]
OPTIONAL = get_args(_FileName)[2:]
FUNCTION: tuple[_FileName, _FileName] = ("function.json", "function.f64")
Content = str | bytes  # of a file


def text_of(document: dict[str, Any]) -> str:
    """Return the text of a file that holds a document, in the one form that is accepted."""
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


class ManifestPart(BaseModel):
    """A document or a part of one, frozen and without extra keys; read from a dictionary or an object."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, from_attributes=True)

    def text(self) -> str:
        """Return the text of the file that holds the document."""
        return text_of(self.model_dump())


class Bounds(ManifestPart):
    """Bounds on the errors of all printed numbers, rounding included, in m, m/s, s and m/s².

    The first three are the largest of their kind, `transit_s` only where there are transits; `grid`
    and `transits` are by column, the largest of all rows.
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
    """`sections.csv`: decimals and largest bound of each column, and the number of passages of each section.

    `counts` are its rows, and `possible` intervals in which the proof could not decide.
    """

    decimals: dict[Name, Decimals]
    bounds: dict[Name, Decimal]
    counts: dict[Name, Count]
    possible: dict[Name, list[Possible]]


class EnclosureRecord(ManifestPart):
    """The proof: its method, size and largest radii, and the bits to which the proved run agrees with it."""

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
    sha256: _Sha256

    @classmethod
    def of(cls, content: Content) -> FileRecord:
        """Return the record of a file with this content."""
        data = content if isinstance(content, bytes) else content.encode()
        return cls(bytes=len(data), sha256=hashlib.sha256(data).hexdigest())


class Manifest(ManifestPart):
    """`manifest.json`; numbers that matter are strings.

    `seal` is the sha256 of the same text with an empty seal. It finds accidents; a forger can make
    it again.
    """

    schema_version: Literal[3]  # FORMAT
    seal: _Sha256 | Literal[""]
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
    files: dict[_FileName, FileRecord]
    # left out of the file if the scene asks for none
    sections: SectionsRecord | None = None

    def text(self) -> str:
        """Return the text of the file, without sections where there are none."""
        return text_of(self.model_dump(exclude=None if self.sections else {"sections"}))

    @model_validator(mode="after")
    def _agrees_with_itself(self) -> Self:
        """Refuse a manifest whose fields contradict each other, with the first contradiction."""
        for contradictions in (self._in_level(), self._in_columns(), self._in_files()):
            for contradiction in contradictions:
                raise ValueError(contradiction)
        return self

    def _in_level(self) -> Iterator[str]:
        """Yield where level, evidence, flags and counts contradict each other."""
        is_proved = self.enclosure is not None
        if is_proved != (self.level == "enclosed"):
            yield "level: a proof and the level enclosed belong together"
        if self.level != "computed" and not self.cross_checks:
            yield "level: no run agrees with the published one"
        if self.level == "computed" and self.cross_checks:
            yield "level: a single run has no cross-checks"
        if set(self.notes) != set(self.flags):
            yield "notes: one for each flag"
        if self.counts.grid < 2:
            yield "counts: a grid has two times at least"

    def _in_columns(self) -> Iterator[str]:
        """Yield where bounds and decimals are not those of the tables' columns."""
        bounds = self.bounds
        transits = TRANSITS if self.counts.transits else ()
        if tuple(bounds.grid) != GRID:
            yield f"bounds.grid: must name the columns {', '.join(GRID)}"
        if tuple(bounds.transits) != transits:
            yield f"bounds.transits: must name the columns {', '.join(TRANSITS)}"
        numbers = [float(bound) for bound in (*bounds.grid.values(), *bounds.transits.values())]
        if not all(map(math.isfinite, numbers)):
            yield "bounds: a number beyond the range of binary64"
        if set(self.decimals.get("grid", ())) != {"t", *GRID}:
            yield f"decimals.grid: must name the columns {', '.join(('t', *GRID))}"
        # a dataset without transits may have their decimals
        if set(self.decimals.get("transits", ())) not in ({*TRANSITS}, {*transits}):
            yield f"decimals.transits: must name the columns {', '.join(TRANSITS)}"

    def _in_files(self) -> Iterator[str]:
        """Yield where the files are not those of the tables, the sections and the function."""
        needed = [*ALWAYS]
        if self.counts.transits:
            needed.append("transits.csv")
        if self.sections:
            needed.append("sections.csv")
        lacking = [name for name in needed if name not in self.files]
        if lacking and not self.alone:
            yield f"files: {' and '.join(lacking)} must be there, unless the dataset is a golden function alone"

        asks_for_sections = "sections" in self.scene.get("run", ())
        if asks_for_sections != (self.sections is not None):
            yield "sections: they belong to a scene that asks for some"
        if "sections.csv" in self.files and self.sections is None:
            yield "files: sections.csv belongs to a dataset with sections"
        has_description, has_coefficients = (name in self.files for name in FUNCTION)
        is_unproved = has_coefficients and self.enclosure is None
        if has_description != has_coefficients or is_unproved:
            yield "files: a golden function has two files, and a proof"

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
        """Return the largest error bound of a column's printed numbers."""
        if table == "sections" and self.sections:
            return Fraction(self.sections.bounds[column])
        return Fraction(getattr(self.bounds, table)[column])


def differences(old: Any, new: Any, place: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Yield each field in which two documents differ, as its path and both values."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in {**old, **new}:
            inner = f"{place}.{key}" if place else key
            yield from differences(old.get(key), new.get(key), inner)
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for i, (old_item, new_item) in enumerate(zip(old, new, strict=True)):
            yield from differences(old_item, new_item, f"{place}[{i}]")
    elif old != new:
        yield place, old, new
