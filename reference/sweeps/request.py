"""A sweep as it was asked for: the scene, what varies, what is wanted, and how the rows are cut into parts."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..engines.batch_interface import Rows, Wanted
from ..numbers.double_double import DoubleDouble
from ..scenes.scene import Level, Scene, parse_scene
from .axes import Grid, axis
from .lists import Listed
from .row import AMPLITUDE, FREQUENCY, PRECESSION, TIMES, TRANSITS, Column, columns_for
from .row_constants import columns_of, row_constants

SCHEMA = 2
PART_S = 10.0  # CPU seconds of a part, by the cost model
LEAST_PART, MOST_PART = 8, 65_536  # rows
CARTESIAN, ANGULAR = ("x", "y", "vx", "vy"), ("angle", "azimuth", "angle_rate", "azimuth_rate")


@dataclass(frozen=True)
class Request:
    """A sweep.

    Attributes:
        scene: the scene that is varied; its grid is the end of the span alone.
        table: what varies, and how many rows there are.
        want: words of `row.WANTS`, and "transit-times".
        level: the level of trust asked for.
        digits: significant digits asked for, None for those of double.
        tolerance: largest error of a position in m with which a row stays as computed, None for any.
        engine: the engine that solves many rows at once.
        identity: what decides its digits.
        rows_per_part: rows of a part.
        audit: how many rows are solved again in many digits.
    """

    scene: Scene
    table: Grid | Listed
    want: tuple[str, ...]
    level: Level
    digits: int | None
    tolerance: float | None
    engine: str
    identity: str
    rows_per_part: int
    audit: int = 0

    @property
    def promotes(self) -> bool:
        """Whether every row goes through the solver, by its level or digits."""
        return self.level != "computed" or self.digits is not None

    @property
    def wanted(self) -> Wanted:
        """The results wanted of the engine."""
        want = set(self.want)
        return Wanted(
            transits=bool(want & {TRANSITS, FREQUENCY, TIMES}),
            apsides=bool(want & {PRECESSION, FREQUENCY, AMPLITUDE}),
            times=TIMES in want,
        )

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The columns of a row."""
        return columns_for(self.want, self.table.keys)

    @property
    def parts(self) -> int:
        """The number of parts."""
        return -(-self.table.count // self.rows_per_part)

    def rows_of(self, part: int) -> range:
        """Return the rows of a part."""
        first = part * self.rows_per_part
        return range(first, min(first + self.rows_per_part, self.table.count))

    def part_of(self, rows: range) -> int:
        """Return the part in which rows are."""
        return rows.start // self.rows_per_part

    def scene_of(self, row: int) -> Scene:
        """Return the scene of a row.

        Raises:
            InputError: the combination of its values is wrong.
        """
        texts = self.table.texts(row)
        end = texts.get("run.t_end")
        more = [f"run.grid_step={end}"] if end else []
        return self.scene.with_values([*(f"{key}={text}" for key, text in texts.items()), *more])

    def constants(self, rows: Any) -> Rows:
        """Return the constants and releases of rows; not finite where something is wrong with the scene."""
        rows = np.asarray(rows, np.int64)
        words = self.table.words(rows)
        if not words:
            return self._constants(rows, {})
        kinds = list(zip(*words.values(), strict=True))
        blocks = []
        for kind in sorted(set(kinds)):
            own = np.flatnonzero([one == kind for one in kinds])
            blocks.append((own, self._constants(rows[own], dict(zip(words, kind, strict=True)))))
        back = np.argsort(np.concatenate([own for own, _ in blocks]))
        return Rows.joined([block for _, block in blocks])[back]

    def _constants(self, rows: Any, words: dict[str, str]) -> Rows:
        scene = self.scene.with_values(f"{key}={word}" for key, word in words.items()) if words else self.scene
        columns = columns_of(scene.exact)
        for key, numbers in self.table.numbers(rows, scene.inputs).items():
            name = key.rpartition(".")[2]
            if name == "inverse_flattening":
                columns["flattening"] = _inverse(numbers)
            else:
                columns[name] = numbers
        with np.errstate(all="ignore"):
            return row_constants(columns, scene.site.gravity_is, len(rows))

    def document(self) -> dict[str, Any]:
        """Return the request as JSON, all that decides the digits; the rows of a list by their hash."""
        table = self.table
        return {
            "schema": SCHEMA,
            "scene": self.scene.model_dump(exclude_none=True),
            "over": table.typed if isinstance(table, Grid) else None,
            "values": table.values if isinstance(table, Listed) else table.listed,
            "rows": table.count,
            "rows_per_part": self.rows_per_part,
            "want": list(self.want),
            "level": self.level,
            "digits": self.digits,
            "tolerance": self.tolerance,
            "engine": self.engine,
            "identity": self.identity,
            "audit": self.audit,
        }

    @classmethod
    def of(cls, document: dict[str, Any]) -> Request:
        """Return the request that `document` wrote."""
        scene, typed = parse_scene(document["scene"]), document["over"]
        values = {key: tuple(texts) for key, texts in document["values"].items()}
        table: Grid | Listed = Listed(values)
        if typed is not None:
            known = values
            values = {key: known.get(key) or axis(f"{key}={word}", scene.inputs)[-1] for key, word in typed.items()}
            table = Grid(values, typed)
        names = ("level", "digits", "tolerance", "engine", "identity", "rows_per_part", "audit")
        return cls(scene, table, tuple(document["want"]), **{name: document[name] for name in names})

    @cached_property
    def hash(self) -> str:
        """The sha256 of `document`, which every part carries."""
        return hashlib.sha256(json.dumps(self.document(), sort_keys=True).encode()).hexdigest()


def _inverse(numbers: DoubleDouble) -> DoubleDouble:
    """Return 1/numbers, of infinity zero."""
    with np.errstate(invalid="ignore"):
        inverse = DoubleDouble(np.ones(len(numbers.high)), np.zeros(len(numbers.high))) / numbers
    zero = DoubleDouble(np.zeros(len(numbers.high)), np.zeros(len(numbers.high)))
    return zero.where(np.isinf(numbers.high), inverse)
