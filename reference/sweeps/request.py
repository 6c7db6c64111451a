"""A sweep as it was asked for: the scene, what varies, what is wanted, and how the rows are cut into parts.

`request` checks what a user asks for before any work, and chooses the engine and the size of parts.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..engines import AUTO
from ..engines.batch_interface import Batch, Rows, Wanted
from ..engines.registry import batches
from ..errors import InputError, unknown
from ..model.start import Start
from ..numbers.double_double import DoubleDouble
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS
from ..scenes.scene import LEVELS, Level, Scene, parse_scene
from .axes import Grid, Listed, axis, grid, listed
from .row import AMPLITUDE, FREQUENCY, PRECESSION, TIMES, TRANSITS, WANTS, Column, columns_for
from .row_constants import columns_of, row_constants

SCHEMA = 2
PART_S = 10.0  # CPU seconds of a part, by the cost model
LEAST_PART, MOST_PART = 8, 65_536  # rows
CARTESIAN, ANGULAR = ("x", "y", "vx", "vy"), ("angle", "azimuth", "angle_rate", "azimuth_rate")
ALL = "all"
PROMOTED_S = 0.1  # CPU seconds of a row that the solver solves, at least
LEAST_AUDIT, MOST_AUDIT, AUDITED = 8, 1000, 1000  # audited rows: at least, at most, else one in AUDITED


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


def request(
    scene: Scene,
    over: Iterable[str] = (),
    rows: Path | None = None,
    *,
    want: Sequence[str] = (ALL,),
    level: str = "computed",
    digits: int | None = None,
    tolerance: float | None = None,
    engine: str = AUTO,
    audit: int | None = None,
) -> Request:
    """Return a sweep, checked.

    Args:
        scene: what is varied.
        over: words KEY=START:STOP:STEP, KEY=V1,V2,… or KEY=@FILE.csv, for the full grid of their values.
        rows: instead of `over`, a CSV or Parquet file whose columns are fields, one row a scene.
        want: words of `row.WANTS`, "all", "transit-times".
        level: level of trust, a word of `scene.LEVELS`.
        digits: significant digits; more than double's go through the solver row by row.
        tolerance: largest error of a position in m with which a row stays in double.
        engine: the engine that solves many rows at once; "auto" takes the one that is done first.
        audit: rows to be solved again in many digits; None for none.

    Raises:
        InputError: a wrong axis, option or value.
    """
    if level not in LEVELS:
        raise unknown("--level", level, "a level of trust", LEVELS, "")
    words = list(over)
    if bool(words) == (rows is not None):
        raise InputError("--over", " ".join(words) or "nothing", "--over KEY=…, or --rows FILE", "Give one of the two.")
    scene = scene.with_values([f"run.grid_step={scene.run.t_end}"])
    table: Grid | Listed = listed(rows) if rows else grid(words, scene.inputs)
    _check_release(scene, table.keys)
    swings = _swings(scene) * table.count
    chosen = _engine(engine, swings)
    row_s = PROMOTED_S if level != "computed" or digits is not None else chosen.expected_s(swings) / table.count
    wanted = _wanted(want)
    return Request(
        scene=scene,
        table=table,
        want=wanted,
        level=level,
        digits=digits,
        tolerance=tolerance,
        engine=chosen.name,
        identity=chosen.identity,
        rows_per_part=_power_of_two(PART_S / row_s),
        audit=min(audit or 0, table.count),
    )


def default_audit(count: int) -> int:
    """Return how many rows of a sweep are solved again unless told: one in a thousand, within limits."""
    return min(max(LEAST_AUDIT, count // AUDITED), MOST_AUDIT, count)


def _check_release(scene: Scene, keys: Sequence[str]) -> None:
    """Refuse fields of the kind of release that the scene does not have."""
    other, own = (ANGULAR, CARTESIAN) if scene.release.angle is None else (CARTESIAN, ANGULAR)
    for key in keys:
        section, _, name = key.rpartition(".")
        if section == "release" and name in other:
            expected = f"one of {', '.join(f'release.{name}' for name in own)}, the scene's kind of release"
            raise InputError("--over", key, expected, "Or take a scene with the other kind.")


def _wanted(words: Sequence[str]) -> tuple[str, ...]:
    chosen: set[str] = set()
    for word in words:
        if word not in (*WANTS, TIMES, ALL):
            raise unknown("--want", word, "a quantity of a sweep", (*WANTS, TIMES, ALL), "")
        chosen |= set(WANTS) if word == ALL else {word}
    return tuple(word for word in (*WANTS, TIMES) if word in chosen)


def _swings(scene: Scene) -> float:
    """Return how many small swings the scene's span holds, one at least."""
    start = Start.of(scene.exact, DOUBLE_BITS + GUARD_BITS)
    rate = float(start.ctx.norm(start.k.pull) ** 0.5)
    return max(1.0, float(scene.exact.t_end) * rate / (2 * math.pi))


def _engine(name: str, swings: float) -> Batch:
    """Return the engine that is asked for, or the one that is expected to be done first.

    Raises:
        InputError: there is none of this name, or its packages are missing.
    """
    known = batches()
    if name == AUTO:
        return min(
            (one for one in known.values() if one.installed), key=lambda one: one.expected_s(swings) - one.saved_s
        )
    if name not in known:
        raise unknown("--engine", name, "an engine for many rows", (AUTO, *known), "")
    if not known[name].installed:
        needed = ", ".join(known[name].requires)
        advice = f"Install it with pip install 'foucault-reference[{known[name].extra}]'."
        raise InputError("--engine", name, f"the package {needed}, which it needs", advice)
    return known[name]


def _power_of_two(rows: float) -> int:
    return min(max(1 << round(math.log2(max(rows, 1))), LEAST_PART), MOST_PART)
