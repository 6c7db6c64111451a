"""`function.json` and `function.f64`, the golden function of a dataset: written, read, and as tables in doubles."""

from __future__ import annotations

import decimal
import json
from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from ..model.constants import constants_in_double
from ..model.force import rates
from ..numbers.columns import POSITION, STATE, UNITS
from ..numbers.function import GoldenFunction
from ..numbers.precision import Array, rounded_up
from ..scenes.scene import Reading, Scene
from .manifest import Decimal, Manifest, ManifestPart, Name, Text
from .sheets import GRID_HEADER, TRANSITS_HEADER, Sheet

# times in a piece at which the sign of xdot is looked at, for the transits between them
INSIDE = (32, 256, 2048)
HALVINGS = 64  # of the time between two signs

Hexfloat = Annotated[str, Field(pattern=r"^0x[01]\.[0-9a-f]{1,13}p[+-][0-9]{1,4}$")]


class FunctionRecord(ManifestPart):
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
        same = {
            name: getattr(manifest, name) for name in ("schema_version", "id", "inputs", "frame")
        }
        units = {", ".join(kind): unit for kind, unit in UNITS.items() if {*kind} <= {"t", *STATE}}
        return {**same, "units": units}

    @classmethod
    def of(cls, proved: Any, manifest: Manifest) -> FunctionRecord:
        """Describe a function as it was proved, in the dataset of a manifest."""
        bounds = {name: proved.bounds[name] for name in STATE}
        return cls.model_validate({**cls.following(manifest), "bounds": bounds, **proved.facts})


def read_function(text: str, data: bytes) -> tuple[FunctionRecord, GoldenFunction]:
    """Return the description and what evaluates it; ValueError says what is wrong with the form of the two files."""
    try:
        record = FunctionRecord.model_validate(json.loads(text))
    except ValidationError as error:
        first = error.errors()[0]
        raise ValueError(
            f"breaks the schema at {'.'.join(map(str, first['loc']))}: {first['msg']}"
        ) from None
    count = len(record.times) - 1
    rules = {
        "is not in the form in which it is written": record.text() == text,
        f"bounds: must name {', '.join(STATE)}": tuple(record.bounds) == STATE,
        "components: must be x, y, and z if there is no length_squared": tuple(record.components)
        == POSITION[: 2 if record.length_squared else 3],
        "times: must increase from 0": count > 0 and float.fromhex(record.times[0]) == 0,
        "function.f64 has another size": len(data)
        == 8 * count * len(record.components) * (record.degree + 1),
    }
    if broken := [rule for rule, holds in rules.items() if not holds]:
        raise ValueError(broken[0])
    function = GoldenFunction.of(record.model_dump(), record.bounds, data)
    if (
        any(b <= a for a, b in pairwise(function.times))
        or not np.isfinite(function.coefficients).all()
    ):
        raise ValueError("times must increase, and coefficients must be finite")
    return record, function


Bounded = tuple[Sheet, dict[str, str]]  # a table, and the bounds of its columns


def evaluated(
    function: GoldenFunction, scene: Scene, manifest: Manifest
) -> tuple[Bounded, Bounded]:
    """Return the grid and the transits of a dataset without tables, in doubles, each with the bounds of its columns.

    The grid's times are the doubles nearest to the scene's, in all their digits: the states are those at just these.
    The manifest says how many transits the proof found: as many changes of sign of xdot, beyond its bound, are all.

    Raises:
        ValueError: the function has others.
    """
    times = np.minimum([float(t) for t in scene.exact.grid], function.times[-1])
    grid, exactly = _states(function, times), [f"{decimal.Decimal(t):f}" for t in times.tolist()]
    count = manifest.counts.transits
    for inside in INSIDE:  # close pairs need more
        zeros, signs = _turns(function, inside)
        for part in manifest.possible:
            outside = (zeros < float(part.from_s)) | (zeros > float(part.to_s))
            zeros, signs = zeros[outside], signs[outside]
        if len(zeros) >= count:
            break
    if scene.run.transits and count != len(zeros):
        raise ValueError(f"xdot has {len(zeros)} zeros, the manifest counts {count}")
    zeros, signs = zeros[:count], signs[:count]
    state = _states(function, zeros)
    of_zeros = rates(state, constants_in_double(scene.exact))
    x, y, z, _, vy, _ = state
    # to first order; a time is one of the two doubles about the zero, and its decimals are half an ulp from it
    late = function.bound["vx"] / np.abs(of_zeros[3]) + 2 * np.spacing(zeros)
    numbers = map(str, range(1, len(zeros) + 1)), zeros, [f"{sign:+d}" for sign in signs.tolist()]
    rows = _rows([*numbers, x, y, z, vy, of_zeros[3], late])
    wrong = [np.max(np.abs(rate) * late, initial=0.0) for rate in of_zeros]
    return (
        (Sheet(GRID_HEADER, _rows([exactly, *grid]), {}), _bounds(function, grid)),
        (Sheet(TRANSITS_HEADER, rows, {}), _bounds(function, state, wrong)),
    )


def _bounds(
    function: GoldenFunction, columns: Iterable[Array], more: Iterable[float] = (0.0,) * 6
) -> dict[str, str]:
    """Return the function's bounds with the rounding of decimals, and with something added to each."""
    rounding = [np.spacing(np.abs(column).max(initial=0.0)) for column in columns]
    sums = [
        function.bound[name] + ulp + extra
        for name, ulp, extra in zip(STATE, rounding, more, strict=True)
    ]
    return {
        name: rounded_up(Fraction(float(bound))) for name, bound in zip(STATE, sums, strict=True)
    }


def _states(function: GoldenFunction, times: Array) -> list[Array]:
    at = function.at(times)
    return [np.asarray(getattr(at, name)) for name in STATE]


def _rows(columns: Iterable[Any]) -> list[tuple[str, ...]]:
    texts = [
        map(repr, column.tolist()) if isinstance(column, np.ndarray) else column
        for column in columns
    ]
    return list(zip(*texts, strict=True))


def _turns(function: GoldenFunction, inside: int) -> tuple[Array, Array]:
    """Return the times in s at which xdot changes its sign, and the sign after each."""
    begins, widths = function.times[:-1, None], np.diff(function.times)[:, None]
    t = np.append((begins + widths * (np.arange(inside) / inside)).ravel(), function.times[-1])
    vx = np.asarray(function.at(t).vx)
    certain = np.abs(vx) > function.bound["vx"]
    t, sign = t[certain], np.sign(vx[certain]).astype(int)
    turn = np.flatnonzero(np.diff(sign))
    low, high, after = t[turn], t[turn + 1], sign[turn + 1]
    for _ in range(HALVINGS):
        middle = low + (high - low) / 2
        passed = np.sign(function.at(middle).vx) == after
        low, high = np.where(passed, low, middle), np.where(passed, middle, high)
    return high, after
