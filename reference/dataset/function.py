"""`function.json` and `function.f64`, the golden function of a dataset: written, and read as what evaluates it."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from ..numbers.columns import POSITION, STATE, UNITS
from ..numbers.function import GoldenFunction
from ..scenes.scene import Reading
from .manifest import Decimal, Manifest, Name, Part, Text

Hexfloat = Annotated[str, Field(pattern=r"^0x[01]\.[0-9a-f]{1,13}p[+-][0-9]{1,4}$")]


class FunctionRecord(Part):
    """`function.json`: what the doubles of `function.f64` are, and how far their values may be from the truth."""

    schema_version: Literal[3]  # manifest.FORMAT
    id: Name
    inputs: Reading
    frame: Text
    units: dict[Name, Name]
    bounds: dict[Name, Decimal]
    degree: Annotated[int, Field(ge=0, le=63)]
    components: list[Literal["x", "y", "z"]]
    length_squared: Hexfloat | None
    times: list[Hexfloat]

    @staticmethod
    def following(manifest: Manifest) -> dict[str, Any]:
        """Return what follows from the manifest of the dataset."""
        same = {name: getattr(manifest, name) for name in ("schema_version", "id", "inputs", "frame")}
        units = {", ".join(kind): unit for kind, unit in UNITS.items() if {*kind} <= {"t", *STATE}}
        return {**same, "units": units}

    @classmethod
    def of(cls, made: Any, manifest: Manifest) -> FunctionRecord:
        """Describe a function as it was proved, in the dataset of a manifest."""
        bounds = {name: made.bounds[name] for name in STATE}
        return cls.model_validate({**cls.following(manifest), "bounds": bounds, **made.facts})


def read_function(text: str, data: bytes) -> tuple[FunctionRecord, GoldenFunction]:
    """Return the description and what evaluates it; ValueError says what is wrong with the form of the two files."""
    try:
        record = FunctionRecord.model_validate(json.loads(text))
    except ValidationError as error:
        first = error.errors()[0]
        raise ValueError(f"breaks the schema at {'.'.join(map(str, first['loc']))}: {first['msg']}") from None
    count = len(record.times) - 1
    rules = {
        "is not in the form in which it is written": record.text() == text,
        f"bounds: must name {', '.join(STATE)}": tuple(record.bounds) == STATE,
        "components: must be x, y, and z if there is no length_squared": tuple(record.components)
        == POSITION[: 2 if record.length_squared else 3],
        "times: must increase from 0": count > 0 and float.fromhex(record.times[0]) == 0,
        "function.f64 has another size": len(data) == 8 * count * len(record.components) * (record.degree + 1),
    }
    broken = [rule for rule, holds in rules.items() if not holds]
    if broken:
        raise ValueError(broken[0])
    function = GoldenFunction.of(record.model_dump(), record.bounds, data)
    if any(b <= a for a, b in pairwise(function.times)) or not np.isfinite(function.coefficients).all():
        raise ValueError("times must increase, and coefficients must be finite")
    return record, function
