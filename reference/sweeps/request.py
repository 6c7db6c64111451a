"""The request of a sweep: scene, fields that vary, quantities, and parts.

`request` checks what a user asks for before any work, and chooses the engine and the size of parts.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from numbers import Real
from pathlib import Path
from typing import Any, cast

from pydantic import PositiveInt
from pydantic.dataclasses import dataclass as checked

from ..engines import AUTO
from ..engines.batch_interface import Batch, RunOptions
from ..engines.registry import batches
from ..errors import NOTHING, Described, InputError, check_whole, unknown
from ..model.sections import direction_of
from ..model.start import Start
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS
from ..scenes.fields import LEVELS, Level
from ..scenes.scene import Reading, Scene, checked_value, parse_scene
from ..solver.choice import need_heyoka
from ..system.imports import needed
from .axes import WORD_FIELDS, AxisTable, combinations, rows_of_file
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
    ParquetColumn,
    section_columns,
)
from .row_constants import ANGLES, POSITION

_SCHEMA = 2
_PART_S = 10.0  # CPU seconds of a part, by the cost model
_LEAST_PART = 8  # rows
_MOST_PART = 65_536  # rows
_PARTS = 16  # a sweep has this many parts, for its workers and its progress, unless
_SHORT_PART_S = 0.5  # they were shorter than this in CPU seconds
# attributes of a request that its document has as they are
_STORED = ("rows_per_part", "want", "level", "digits", "tolerance", "engine", "identity", "audit")
_ALL = "all"
_PROMOTED_S = 0.1  # CPU seconds of a row that the solver solves, at least
_ROW_SWINGS = 25  # swings that take as long as what a row takes beside its steps
# CPU seconds of a row of an audit, and what each swing adds
_AUDITED_S = 0.3
_AUDITED_SWING_S = 1.6e-3
# CPU seconds of a sweep, above which a faster engine is compiled for the next one
_WORTH_COMPILING_S = 1.0


@dataclass(frozen=True)
class Settings:
    """How the rows of a sweep are solved, as a user chooses it.

    Attributes:
        want: words of `parquet.WANTS`, "transit-times", or "all".
        level: the level of trust; above computed every row goes through the solver.
        digits: significant digits, by the solver; None for those of double.
        tolerance: rows with a larger error of the position in m go through the solver as well; None
            for any error.
        engine: the engine that solves many rows at once, or "auto".
        audit: how many rows are solved again in many digits; None where the default is taken.
    """

    want: Sequence[str] = (_ALL,)
    level: str = "computed"
    digits: int | None = None
    tolerance: float | None = None
    engine: str = AUTO
    audit: int | None = None

    def check(self, reading: Reading) -> None:
        """Refuse a wrong level, or a number out of range.

        Raises:
            InputError: one of these.
        """
        if self.level not in LEVELS:
            advice = f"There are {', '.join(LEVELS)}."
            raise unknown("--level", self.level, "a level of trust", LEVELS, advice)
        if self.promotes:
            need_heyoka("--level" if self.level != "computed" else "--digits")
        if self.level == "enclosed":
            needed("flint", "enclose", "--level", "the level enclosed")
        if self.digits is not None:
            checked_value("run.digits", str(self.digits), reading)
        tolerance = self.tolerance
        if tolerance is not None and not (isinstance(tolerance, Real) and tolerance >= 0):
            raise InputError("--tolerance", tolerance, "a number of metres, 0 or more")
        if self.audit is not None:
            check_whole("--audit", self.audit, 0, "a number of rows, 0 or more")

    @property
    def promotes(self) -> bool:
        """Whether every row is solved by the solver, because of the level or the digits."""
        return self.level != "computed" or self.digits is not None

    @property
    def quantities(self) -> tuple[str, ...]:
        """The quantities wanted, in the order of `parquet.WANTS`.

        Raises:
            InputError: a word is no quantity.
        """
        choices = (*WANTS, TIMES, _ALL)
        for word in self.want:
            if word not in choices:
                advice = f"There are {', '.join(WANTS)}."
                raise unknown("--want", word, "a quantity of a sweep", choices, advice)
        wanted = set(self.want)
        if _ALL in wanted:
            wanted |= set(WANTS)
        return tuple(word for word in (*WANTS, TIMES) if word in wanted)


_DEFAULTS = Settings()


@checked(frozen=True)
class Request:
    """A sweep.

    Attributes:
        scene: the scene that is varied; its grid is the end of the span alone.
        table: what varies, and how many rows there are.
        want: words of `parquet.WANTS`, and "transit-times".
        level: the level of trust asked for.
        digits: significant digits asked for, None for those of double.
        tolerance: largest error of a position in m with which a row stays as computed, None for
            any.
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
        """Whether every row is solved by the solver, because of the level or the digits."""
        return self.level != "computed" or self.digits is not None

    @property
    def solved_by(self) -> str:
        """What solves the rows: the name of an engine for many rows, or the solver."""
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
    def columns(self) -> tuple[ParquetColumn, ...]:
        """The columns: number, fields that vary, quantities that are wanted, and sections."""
        number, *described = COLUMNS
        varied = []
        for key in self.table.values:
            kind = WORDS if key in WORD_FIELDS else "float64"
            varied.append(ParquetColumn(key, kind, f"{key} of the scene, the nearest double"))
        want = set(self.want)
        results = [column for column in described if not column.wants or want & set(column.wants)]
        return (number, *varied, *results, *section_columns(self.sections))

    @property
    def parts(self) -> int:
        """The number of parts."""
        return -(-self.table.count // self.rows_per_part)

    @property
    def rows_per_audited(self) -> float:
        """An estimate of how many rows take as long as one row of the audit."""
        if self.promotes:
            return 1.0
        audited_s = _AUDITED_S + _AUDITED_SWING_S * _swings(self.scene)
        return audited_s / _row_s(batches()[self.engine], self.scene)

    def rows_of(self, part: int) -> range:
        """Return the rows of a part."""
        first = part * self.rows_per_part
        return range(first, min(first + self.rows_per_part, self.table.count))

    def part_of(self, row: int) -> int:
        """Return the part that contains a row."""
        return row // self.rows_per_part

    def scene_of(self, row: int) -> Scene:
        """Return the scene of a row.

        Raises:
            InputError: the combination of its values is wrong.
        """
        values = self.table.texts(row)
        t_end = values.get("run.t_end", self.scene.run.t_end)
        return self.scene.with_values(values | {"run.grid_step": t_end})

    def document(self) -> dict[str, Any]:
        """Return the request as a JSON document of everything that the digits depend on."""
        return {
            "schema": _SCHEMA,
            "scene": self.scene.model_dump(exclude_none=True),
            "over": self.table.typed,
            "values": self.table.stored,
            "rows": self.table.count,
            **{name: getattr(self, name) for name in _STORED},
        }

    @classmethod
    def of(cls, document: dict[str, Any]) -> Request:
        """Return the request that `document` wrote."""
        scene = parse_scene(document["scene"])
        table = AxisTable.restored(document["over"], document["values"], scene.inputs)
        return cls(scene, table, **{name: document[name] for name in _STORED})

    @cached_property
    def text(self) -> str:
        """The request as a text that can be sent, and that `request_of` reads."""
        return json.dumps(self.document())

    @cached_property
    def hash(self) -> str:
        """The sha256 of `document` and of the columns, which every part carries."""
        columns = [(column.name, column.kind) for column in (*self.columns, *TRANSIT_COLUMNS)]
        text = json.dumps([self.document(), columns], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


@lru_cache(maxsize=1)
def request_of(text: str) -> Request:
    """Return the request whose text was sent."""
    return Request.of(json.loads(text))


def request(
    scene: Scene,
    over: Iterable[str] = (),
    rows: Path | None = None,
    settings: Settings = _DEFAULTS,
) -> Request:
    """Return the request of a sweep, checked; the engine and the size of its parts are chosen.

    Args:
        scene: the scene that is varied.
        over: words of `--over`; all their combinations are rows.
        rows: instead, a file with a row a scene.
        settings: how the rows are solved.

    Raises:
        InputError: a wrong axis, setting or value.
    """
    settings.check(scene.inputs)
    words = list(over)
    if bool(words) == (rows is not None):
        got = Described("both --over and --rows") if words else NOTHING
        expected = "--over KEY=…, or --rows FILE"
        raise InputError("--over", got, expected, "Give one of the two.")
    scene = scene.with_values([f"run.grid_step={scene.run.t_end}"])
    table = rows_of_file(rows) if rows else combinations(words, scene.inputs)
    _check_release(scene, table.values)
    engine = _engine(settings.engine, scene, table.count)
    row_s = _PROMOTED_S if settings.promotes else _row_s(engine, scene)
    return Request(
        scene=scene,
        table=table,
        want=settings.quantities,
        level=cast(Level, settings.level),
        digits=settings.digits,
        tolerance=settings.tolerance,
        engine=engine.name,
        identity=engine.identity,
        rows_per_part=_rows_per_part(row_s, table.count, 1 if settings.promotes else engine.lanes),
        audit=min(settings.audit or 0, table.count),
    )


def _rows_per_part(row_s: float, count: int, lanes: int) -> int:
    """Return the rows of a part: a power of two that takes about `_PART_S`, or fewer.

    Args:
        row_s: CPU seconds of a row.
        count: rows of the sweep, which has `_PARTS` parts if none would be too short.
        lanes: rows that are solved at a time.
    """
    rows = 1 << round(math.log2(max(_PART_S / row_s, 1)))
    rows = min(max(rows, _LEAST_PART), _MOST_PART)
    share = max(count / _PARTS, _SHORT_PART_S / row_s)
    return min(rows, lanes * math.ceil(share / lanes))


def _check_release(scene: Scene, keys: Iterable[str]) -> None:
    """Refuse fields of the kind of release that the scene does not have."""
    kind, other = (POSITION, ANGLES) if scene.release.angle is None else (ANGLES, POSITION)
    refused = [f"release.{name}" for name in other]
    for key in keys:
        if key in refused:
            names = ", ".join(f"release.{name}" for name in kind)
            expected = f"one of {names}, by which this scene is released"
            raise InputError("--over", key, expected, "Or choose a scene released the other way.")


def _swings(scene: Scene) -> float:
    """Return the number of small swings of a scene's run."""
    start = Start.of(scene.exact, DOUBLE_BITS + GUARD_BITS)
    rate = float(start.ctx.norm(start.k.pull) ** 0.5)
    return float(scene.exact.t_end) * rate / (2 * math.pi)


def _row_s(engine: Batch, scene: Scene) -> float:
    """Return the CPU seconds of a row in an engine, by its small swings and its sections."""
    swings = _ROW_SWINGS + _swings(scene)
    work = sum(engine.section_work[abs(direction_of(word))] for word in scene.run.sections or ())
    return engine.swing_s * swings * (1 + work)


def worth_compiling(request: Request) -> Batch | None:
    """Return an engine that is not compiled yet and would solve a sweep's rows faster, if any."""
    row_s = _row_s(batches()[request.engine], request.scene)
    if request.promotes or row_s * request.table.count < _WORTH_COMPILING_S:
        return None
    has_drag = request.scene.exact.drag != 0 or "pendulum.drag" in request.table.values
    for other in batches().values():
        if not other.installed or (has_drag and not other.drag):
            continue
        faster = _row_s(other, request.scene) < row_s
        if faster and other.compiling_s(bool(request.sections)):
            return other
    return None


def _engine(name: str, scene: Scene, count: int) -> Batch:
    """Return the engine that is asked for, or the one that is expected to be done first.

    Raises:
        InputError: there is none of this name, or its packages are missing.
    """
    engines = batches()
    if name == AUTO:
        return _fastest(scene, count)
    if name not in engines:
        advice = f"There are {', '.join(engines)}."
        raise unknown("--engine", name, "an engine for many rows", (AUTO, *engines), advice)
    engines[name].check_installed()
    return engines[name]


def _fastest(scene: Scene, count: int) -> Batch:
    """Return the engine that is expected to finish first, loading and compiling included.

    Raises:
        InputError: none that can solve the scene is installed.
    """
    sections = bool(scene.run.sections)

    def cost_s(engine: Batch) -> float:
        return engine.load_s + engine.compiling_s(sections) + count * _row_s(engine, scene)

    serving = [
        engine
        for engine in batches().values()
        if engine.installed and (engine.drag or not scene.exact.drag)
    ]
    if not serving:
        batches()["heyoka"].check_installed()  # it would serve any scene
    return min(serving, key=cost_s)
