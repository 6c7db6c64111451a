"""From what a user asks to a `Request`: checked before any work, with the engine and the size of parts chosen."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from ..engines import AUTO
from ..engines.batch_interface import Batch
from ..engines.registry import batches
from ..errors import InputError, unknown
from ..model.start import Start
from ..numbers.precision import DOUBLE_BITS, GUARD_BITS
from ..scenes.scene import LEVELS, Scene
from .axes import Grid, grid
from .lists import Listed, listed
from .request import ANGULAR, CARTESIAN, LEAST_PART, MOST_PART, PART_S, Request
from .row import TIMES, WANTS

ALL = "all"
PROMOTED_S = 0.1  # CPU seconds of a row that the solver solves, at least
LEAST_AUDIT, MOST_AUDIT, AUDITED = 8, 1000, 1000  # audited rows: at least, at most, else one in AUDITED


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
