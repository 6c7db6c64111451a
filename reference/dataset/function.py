"""The golden function of a dataset: its two files, and tables in doubles evaluated from it."""

from __future__ import annotations

import decimal
import json
from collections.abc import Iterable
from dataclasses import dataclass
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
from .manifest import Decimal, Manifest, ManifestPart, Name, Possible, Text
from .sheets import GRID_HEADER, TRANSITS_HEADER, Sheet

# times in a piece at which the sign of xdot is evaluated, for the transits between them; close
# pairs need more
_SIGNS_IN_A_PIECE = (32, 256, 2048)
_HALVINGS = 64  # of the time between two signs

_Hexfloat = Annotated[str, Field(pattern=r"^0x[01]\.[0-9a-f]{1,13}p[+-][0-9]{1,4}$")]


class FunctionRecord(ManifestPart):
    """`function.json`: the meaning of the doubles in `function.f64`, and bounds on the function's errors."""

    schema_version: Literal[3]  # manifest.FORMAT
    id: Name
    inputs: Reading
    frame: Text
    units: dict[Name, Name]
    bounds: dict[Name, Decimal]
    degree: Annotated[int, Field(ge=0, le=63)]
    components: list[Literal["x", "y", "z"]]
    length_squared: _Hexfloat | None
    times: list[_Hexfloat]

    @staticmethod
    def following(manifest: Manifest) -> dict[str, Any]:
        """Return the fields that follow from the manifest of the dataset."""
        columns = {"t", *STATE}
        return {
            "schema_version": manifest.schema_version,
            "id": manifest.id,
            "inputs": manifest.inputs,
            "frame": manifest.frame,
            "units": {", ".join(kind): unit for kind, unit in UNITS.items() if columns >= {*kind}},
        }

    @classmethod
    def of(cls, proved: Any, manifest: Manifest) -> FunctionRecord:
        """Return the description of a proved function for the dataset of a manifest."""
        bounds = {name: proved.bounds[name] for name in STATE}
        return cls.model_validate({**cls.following(manifest), "bounds": bounds, **proved.facts})


def read_function(text: str, data: bytes) -> tuple[FunctionRecord, GoldenFunction]:
    """Return the description of a golden function, and the function itself.

    Args:
        text: of `function.json`.
        data: of `function.f64`.

    Raises:
        ValueError: the two files have a wrong form; it says which.
    """
    try:
        record = FunctionRecord.model_validate(json.loads(text))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise ValueError(f"breaks the schema at {place}: {first['msg']}") from None
    _check_form(record, text, data)
    function = GoldenFunction.of(record.model_dump(), record.bounds, data)
    times_increase = all(before < after for before, after in pairwise(function.times))
    if not times_increase or not np.isfinite(function.coefficients).all():
        raise ValueError("times must increase, and coefficients must be finite")
    return record, function


def _check_form(record: FunctionRecord, text: str, data: bytes) -> None:
    """Check what the schema cannot: names, the first time and the size of `function.f64`.

    Raises:
        ValueError: the first rule that is broken.
    """
    if record.text() != text:
        raise ValueError("is not in the format that this project writes")
    if tuple(record.bounds) != STATE:
        raise ValueError(f"bounds: must name {', '.join(STATE)}")
    components = POSITION[:2] if record.length_squared else POSITION
    if tuple(record.components) != components:
        raise ValueError("components: must be x, y and, without length_squared, z")
    pieces = len(record.times) - 1
    if pieces < 1 or float.fromhex(record.times[0]) != 0:
        raise ValueError("times: must increase from 0")
    if len(data) != 8 * pieces * len(components) * (record.degree + 1):
        raise ValueError("function.f64 has the wrong size")


@dataclass(frozen=True)
class _EvaluatedTable:
    """A table in doubles, and the bounds of its columns, rounding to its decimals included."""

    sheet: Sheet
    bounds: dict[str, str]


def evaluated_grid(function: GoldenFunction, scene: Scene) -> _EvaluatedTable:
    """Return the grid of a dataset without tables, in doubles.

    Its times are the doubles nearest to the scene's, in all their digits: the states are those at
    just these.
    """
    times = np.minimum([float(t) for t in scene.exact.grid], function.times[-1])
    states = _states(function, times)
    exact_times = [f"{decimal.Decimal(t):f}" for t in times.tolist()]
    rows = _rows([exact_times, *map(_texts, states)])
    return _EvaluatedTable(Sheet(GRID_HEADER, rows, {}), _bounds(function, states))


def evaluated_transits(
    function: GoldenFunction, scene: Scene, manifest: Manifest
) -> _EvaluatedTable:
    """Return the transits of a dataset without tables, in doubles.

    The manifest counts the transits that the proof found: as many changes of sign of xdot, beyond
    its bound, are all.

    Raises:
        ValueError: the function has others.
    """
    zeros = _transits(function, scene, manifest)
    times = zeros.times
    states = _states(function, times)
    derivatives = rates(states, constants_in_double(scene.exact))
    ax = derivatives[3]
    # to first order; a time is one of the two doubles about the zero, and its decimals are half an
    # ulp from it
    time_errors = function.bound["vx"] / np.abs(ax) + 2 * np.spacing(times)
    errors = [np.max(np.abs(rate) * time_errors, initial=0.0) for rate in derivatives]

    # x, y, z and vy
    columns = [_texts(column) for column in (*states[:3], states[4], ax, time_errors)]
    sheet = Sheet(TRANSITS_HEADER, _rows([*_numbers_times_directions(zeros), *columns]), {})
    return _EvaluatedTable(sheet, _bounds(function, states, errors))


def _numbers_times_directions(zeros: _SignChanges) -> list[list[str]]:
    """Return the first three columns of the transits as texts."""
    numbers = [str(k) for k in range(1, len(zeros.times) + 1)]
    directions = [f"{sign:+d}" for sign in zeros.signs.tolist()]
    return [numbers, _texts(zeros.times), directions]


def _bounds(
    function: GoldenFunction, columns: Iterable[Array], errors: Iterable[float] = (0.0,) * 6
) -> dict[str, str]:
    """Return the function's bounds, with the rounding to decimals and a further error of each."""
    bounds = {}
    for name, column, error in zip(STATE, columns, errors, strict=True):
        rounding = np.spacing(np.abs(column).max(initial=0.0))
        bound = function.bound[name] + rounding + error
        bounds[name] = rounded_up(Fraction(float(bound)))
    return bounds


def _states(function: GoldenFunction, times: Array) -> list[Array]:
    """Return the columns of the state at some times."""
    states = function.at(times)
    return [np.asarray(getattr(states, name)) for name in STATE]


def _texts(column: Array) -> list[str]:
    """Return doubles as the shortest decimals that read as the same."""
    return [repr(number) for number in column.tolist()]


def _rows(columns: Iterable[list[str]]) -> list[tuple[str, ...]]:
    """Return columns of text as rows."""
    return list(zip(*columns, strict=True))


@dataclass(frozen=True)
class _SignChanges:
    """Times in s at which xdot changes its sign, and the sign after each."""

    times: Array
    signs: Array

    def outside(self, intervals: Iterable[Possible]) -> _SignChanges:
        """Return those that lie in none of some intervals."""
        times = self.times
        signs = self.signs
        for interval in intervals:
            outside = (times < float(interval.from_s)) | (times > float(interval.to_s))
            times = times[outside]
            signs = signs[outside]
        return _SignChanges(times, signs)


def _transits(function: GoldenFunction, scene: Scene, manifest: Manifest) -> _SignChanges:
    """Return the zeros of xdot outside the intervals that may hold more.

    Raises:
        ValueError: there are not as many as the manifest counts.
    """
    count = manifest.counts.transits
    for signs_in_a_piece in _SIGNS_IN_A_PIECE:
        zeros = _zeros(function, signs_in_a_piece).outside(manifest.possible)
        if len(zeros.times) >= count:
            break
    if scene.run.transits and count != len(zeros.times):
        raise ValueError(f"xdot has {len(zeros.times)} zeros, but the manifest says {count}")
    return _SignChanges(zeros.times[:count], zeros.signs[:count])


def _zeros(function: GoldenFunction, signs_in_a_piece: int) -> _SignChanges:
    """Return the changes of sign of xdot that show at some times in each piece."""
    begins = function.times[:-1, None]
    widths = np.diff(function.times)[:, None]
    inside = begins + widths * (np.arange(signs_in_a_piece) / signs_in_a_piece)
    t = np.append(inside.ravel(), function.times[-1])
    vx = np.asarray(function.at(t).vx)
    certain = np.abs(vx) > function.bound["vx"]
    t = t[certain]
    sign = np.sign(vx[certain]).astype(int)

    change = np.flatnonzero(np.diff(sign))
    low = t[change]
    high = t[change + 1]
    after = sign[change + 1]
    for _ in range(_HALVINGS):
        middle = low + (high - low) / 2
        passed = np.sign(function.at(middle).vx) == after
        low = np.where(passed, low, middle)
        high = np.where(passed, middle, high)
    return _SignChanges(high, after)
