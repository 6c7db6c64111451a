"""The request of a sweep: the scene, what varies, which quantities, and how the rows are cut into parts.

`request` checks what a user asks for before any work, and chooses the engine and the size of parts.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Sequence
from functools import cached_property, lru_cache
from numbers import Real
from pathlib import Path
from typing import Any

from pydantic import PositiveInt
from pydantic.dataclasses import dataclass as checked

from ..engines import AUTO
from ..engines.batch_interface import Batch, RunOptions
from ..engines.registry import batches
from ..errors import InputError, check_whole, unknown
from ..model.sections import direction_of
from ..model.start import Start
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS
from ..scenes.fields import LEVELS, Level
from ..scenes.scene import Scene, checked_value, parse_scene
from ..system.imports import needed
from .axes import TEXTS, AxisTable, grid, listed
from .parquet import (
    AMPLITUDE,
    COLUMNS,
    FREQUENCY,
    PRECESSION,
    TIMES,
    TRANSIT_COLUMNS,
    TRANSITS,
    WANTS,
    WORDS,
    Column,
    section_columns,
)
from .row_constants import ANGLES, POSITION

SCHEMA = 2
PART_S = 10.0  # CPU seconds of a part, by the cost model
LEAST_PART, MOST_PART = 8, 65_536  # rows
# as they are
SETTINGS = ("rows_per_part", "want", "level", "digits", "tolerance", "engine", "identity", "audit")
ALL = "all"
PROMOTED_S = 0.1  # CPU seconds of a row that the solver solves, at least
ROW_SWINGS = 25  # swings that take as long as what a row takes beside its steps
# CPU seconds of rows, above which it is told that a compiled engine would be cheaper
WORTH_A_LINE_S = 1.0


@checked(frozen=True)
class Request:
    """A sweep.

    Attributes:
        scene: the scene that is varied; its grid is the end of the span alone.
        table: what varies, and how many rows there are.
        want: words of `parquet.WANTS`, and "transit-times".
        level: the level of trust asked for.
        digits: significant digits asked for, None for those of double.
        tolerance: largest error of a position in m with which a row stays as computed, None for any.
        engine: the engine that solves many rows at once.
        identity: what decides its digits.
        rows_per_part: rows of a part.
        audit: how many rows are solved again in many digits.
    """

    scene: Scene
    table: AxisTable
    want: tuple[str, ...]
    level: Level
    digits: int | None
    tolerance: float | None
    engine: str
    identity: str
    rows_per_part: PositiveInt
    audit: int = 0

    @property
    def promotes(self) -> bool:
        """Whether every row goes through the solver, by its level or digits."""
        return self.level != "computed" or self.digits is not None

    @property
    def solved_by(self) -> str:
        """What solves the rows: an engine for many at once, or the solver, where every row goes through it."""
        return "the solver" if self.promotes else self.engine

    @property
    def run_options(self) -> RunOptions:
        """Which results the engine gives of each row."""
        want = set(self.want)
        return RunOptions(
            transits=bool(want & {TRANSITS, FREQUENCY, TIMES}),
            apsides=bool(want & {PRECESSION, FREQUENCY, AMPLITUDE} or self.sections),
            times=TIMES in want,
        )

    @property
    def sections(self) -> tuple[str, ...]:
        """The words of the scene's sections, whose passages are found as well."""
        return self.scene.run.sections or ()

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The columns of a row: its number, one for each field that is varied, those that are wanted, of sections."""
        varied = [
            Column(
                key, WORDS if key in TEXTS else "float64", f"{key} of the scene, the nearest double"
            )
            for key in self.table.values
        ]
        results = [
            column
            for column in COLUMNS[1:]
            if not column.wants or set(column.wants) & set(self.want)
        ]
        return (COLUMNS[0], *varied, *results, *section_columns(self.sections))

    @property
    def parts(self) -> int:
        """The number of parts."""
        return -(-self.table.count // self.rows_per_part)

    def rows_of(self, part: int) -> range:
        """Return the rows of a part."""
        first = part * self.rows_per_part
        return range(first, min(first + self.rows_per_part, self.table.count))

    def part_of(self, row: int) -> int:
        """Return the part in which a row is."""
        return row // self.rows_per_part

    def scene_of(self, row: int) -> Scene:
        """Return the scene of a row.

        Raises:
            InputError: the combination of its values is wrong.
        """
        texts = self.table.texts(row)
        return self.scene.with_values(
            texts | {"run.grid_step": texts.get("run.t_end", self.scene.run.t_end)}
        )

    def document(self) -> dict[str, Any]:
        """Return the request as JSON, all that decides the digits."""
        return {
            "schema": SCHEMA,
            "scene": self.scene.model_dump(exclude_none=True),
            "over": self.table.typed,
            "values": self.table.stored,
            "rows": self.table.count,
            **{name: getattr(self, name) for name in SETTINGS},
        }

    @classmethod
    def of(cls, document: dict[str, Any]) -> Request:
        """Return the request that `document` wrote."""
        scene = parse_scene(document["scene"])
        table = AxisTable.of(document["over"], document["values"], scene.inputs)
        return cls(scene, table, **{name: document[name] for name in SETTINGS})

    @cached_property
    def text(self) -> str:
        """The request as a text that can be sent, and that `request_of` reads."""
        return json.dumps(self.document())

    @cached_property
    def hash(self) -> str:
        """The sha256 of `document` and of the columns, which every part carries."""
        columns = [(column.name, column.kind) for column in (*self.columns, *TRANSIT_COLUMNS)]
        return hashlib.sha256(
            json.dumps([self.document(), columns], sort_keys=True).encode()
        ).hexdigest()


@lru_cache(maxsize=1)
def request_of(text: str) -> Request:
    """Return the request whose text was sent."""
    return Request.of(json.loads(text))


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
    """Return a sweep, checked, its engine and the size of its parts chosen; arguments as those of `sweep.sweep`.

    Raises:
        InputError: a wrong axis, option or value.
    """
    if level not in LEVELS:
        raise unknown(
            "--level", level, "a level of trust", LEVELS, f"There are {', '.join(LEVELS)}."
        )
    if level == "enclosed":
        needed("flint", "enclose", "--level", "the level enclosed")
    if digits is not None:
        checked_value("run.digits", str(digits), scene.inputs)
    if tolerance is not None and not (isinstance(tolerance, Real) and tolerance >= 0):
        raise InputError("--tolerance", tolerance, "a number of metres from 0")
    if audit is not None:
        check_whole("--audit", audit, 0, "a number of rows from 0")
    words = list(over)
    if bool(words) == (rows is not None):
        raise InputError(
            "--over",
            " ".join(words) or "nothing",
            "--over KEY=…, or --rows FILE",
            "Give one of the two.",
        )
    scene = scene.with_values([f"run.grid_step={scene.run.t_end}"])
    table = listed(rows) if rows else grid(words, scene.inputs)
    _check_release(scene, table.values)
    chosen = _engine(engine, scene, table.count)
    row_s = PROMOTED_S if level != "computed" or digits is not None else _row_s(chosen, scene)
    return Request(
        scene=scene,
        table=table,
        want=_quantities(want),
        level=level,
        digits=digits,
        tolerance=tolerance,
        engine=chosen.name,
        identity=chosen.identity,
        rows_per_part=min(
            max(1 << round(math.log2(max(PART_S / row_s, 1))), LEAST_PART), MOST_PART
        ),
        audit=min(audit or 0, table.count),
    )


def _check_release(scene: Scene, keys: Iterable[str]) -> None:
    """Refuse fields of the kind of release that the scene does not have."""
    kind, other = (POSITION, ANGLES) if scene.release.angle is None else (ANGLES, POSITION)
    for key in keys:
        if key in [f"release.{name}" for name in other]:
            expected = f"one of {', '.join(f'release.{name}' for name in kind)}, the scene's kind of release"
            raise InputError("--over", key, expected, "Or take a scene with the other kind.")


def _quantities(words: Sequence[str]) -> tuple[str, ...]:
    known = (*WANTS, TIMES, ALL)
    for word in words:
        if word not in known:
            raise unknown(
                "--want", word, "a quantity of a sweep", known, f"There are {', '.join(WANTS)}."
            )
    return tuple(
        word for word in (*WANTS, TIMES) if word in words or (ALL in words and word in WANTS)
    )


def _row_s(engine: Batch, scene: Scene) -> float:
    """Return the CPU seconds that an engine takes for a row, by the small swings in its span and by its sections."""
    start = Start.of(scene.exact, DOUBLE_BITS + GUARD_BITS)
    rate = float(start.ctx.norm(start.k.pull) ** 0.5)
    swings = ROW_SWINGS + float(scene.exact.t_end) * rate / (2 * math.pi)
    work = sum(engine.section_work[abs(direction_of(word))] for word in scene.run.sections or ())
    return engine.swing_s * swings * (1 + work)


def worth_compiling(request: Request) -> str:
    """Return from how many rows it pays to compile an engine that would be cheaper for each, or "" if there is none."""
    row_s = _row_s(batches()[request.engine], request.scene)
    if request.promotes or row_s * request.table.count < WORTH_A_LINE_S:
        return ""
    for other in batches().values():
        once_s, gained_s = (
            other.compiling_s(bool(request.sections)),
            row_s - _row_s(other, request.scene),
        )
        drag = request.scene.exact.drag != 0 or "pendulum.drag" in request.table.values
        if once_s and gained_s > 0 and other.installed and (other.drag or not drag):
            rows = float(f"{once_s / gained_s:.1g}")
            return (
                f"From some {rows:,.0f} such rows on, in one sweep or several, {other.name} costs less "
                f"than {request.engine}: it is compiled once, for about {once_s:.0f} s (--engine {other.name})."
            )
    return ""


def _engine(name: str, scene: Scene, count: int) -> Batch:
    """Return the engine that is asked for, or the one that is expected to be done first.

    Raises:
        InputError: there is none of this name, or its packages are missing.
    """
    engines = batches()
    if name == AUTO:
        serving = [
            engine
            for engine in engines.values()
            if engine.installed and (engine.drag or not scene.exact.drag)
        ]
        sections = bool(scene.run.sections)
        return min(
            serving,
            key=lambda engine: (
                engine.load_s + engine.compiling_s(sections) + count * _row_s(engine, scene)
            ),
        )
    if name not in engines:
        raise unknown(
            "--engine",
            name,
            "an engine for many rows",
            (AUTO, *engines),
            f"There are {', '.join(engines)}.",
        )
    engines[name].check_installed()
    return engines[name]
