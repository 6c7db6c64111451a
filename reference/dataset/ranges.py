"""A dataset of ranges: proven intervals for uncertain inputs, as tables whose ends are rounded outward."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

from ..errors import DatasetError
from ..numbers.columns import GRID, TRANSITS
from ..numbers.precision import fixed_decimal, magnitude, outward, rounded_up
from ..solver.ranges import Intervals, Ranges
from ..solver.solution import exact_decimals
from .place import GOLDEN, MAX_ID, dataset_id
from .sheets import scene_inputs
from .write import check_target, filled, replace, writable_place

RANGES, FORMAT = "ranges.json", 1
GRID_FILE, TRANSITS_FILE = "grid.csv", "transits.csv"
DIGITS = 2  # that a width has in the tables: the ends widen it by a tenth at most


def ranges_id(ranges: Ranges) -> str:
    """Return the id: that of the scene's dataset, with the half-widths, such as paris+-pendulum.length=0.001."""
    name, box = dataset_id(ranges.scene), ",".join(f"{key}={width}" for key, width in ranges.uncertain.items())
    if len(name) + len(box) >= MAX_ID:
        box = f"sha256={hashlib.sha256(box.encode()).hexdigest()[:16]}"
    return f"{name}+-{box}"


def default_ranges_folder(ranges: Ranges) -> Path:
    """Return the folder that ranges are written to."""
    return Path(GOLDEN) / ranges_id(ranges)


def check_ranges_target(folder: Path) -> None:
    """Refuse a target that cannot be written, or that holds something other than ranges.

    Raises:
        InputError: one of the two.
    """
    check_target(folder, RANGES, "older ranges")


def write_ranges(ranges: Ranges, folder: str | Path) -> Path:
    """Write ranges: `ranges.json`, which says the scene, the box and the proof, and the tables; whole or not at all.

    Args:
        ranges: what `solve(…, uncertain=…)` returned.
        folder: older ranges there are replaced.

    Raises:
        InputError: the folder cannot be written, or holds something else.
        DatasetError: a table does not hold what was proved; nothing is written then.
    """
    folder = Path(folder)
    check_ranges_target(folder)
    tables = {GRID_FILE: _grid(ranges), TRANSITS_FILE: _transits(ranges)}
    if not _holds(tables[GRID_FILE], ranges.grid) or not _holds(tables[TRANSITS_FILE], ranges.transits):
        raise DatasetError(str(folder), ["a printed interval does not hold the proven one"])
    texts = {**tables, RANGES: json.dumps(_manifest(ranges, tables), indent=1, ensure_ascii=False) + "\n"}
    with writable_place(folder) as (work, target):
        replace(target, filled(work, texts), work)
    return folder


def period_texts(ranges: Ranges) -> list[str] | None:
    """Return the ends of the period's interval as text, or None."""
    return ranges.period and list(ends(*ranges.period))


def ends(low: Fraction, high: Fraction, places: int | None = None) -> tuple[str, str]:
    """Return the ends of an interval as text, rounded outward to `places`, or to the digits that its width supports."""
    if places is None:
        places = places_of(low, high)
    return outward(low, -1, places), outward(high, 1, places)


def places_of(low: Fraction, high: Fraction) -> int:
    """Return the digits after the point that an interval's ends have."""
    return max(0, DIGITS - 1 - magnitude(high - low)) if high > low else 0


def _cells(table: Intervals) -> list[list[str]]:
    """Return the ends of all intervals as text, row by row."""
    columns = [[ends(*interval) for interval in table.exact(name)] for name in table.columns]
    return [[text for pair in row for text in pair] for row in zip(*columns, strict=True)]


def _grid(ranges: Ranges) -> str:
    decimals = exact_decimals(ranges.times)
    first, later = Intervals(GRID, ranges.grid.rows[:1]), Intervals(GRID, ranges.grid.rows[1:])
    # the release may be known exactly, up to the rounding of the proof: it has the digits of the next row
    places = [places_of(*later.exact(name)[0]) for name in GRID]
    release = [text for name, count in zip(GRID, places, strict=True) for text in ends(*first.exact(name)[0], count)]
    rows = [release, *_cells(later)]
    lines = [
        ["t", *_names(GRID)],
        *([fixed_decimal(t, decimals), *row] for t, row in zip(ranges.times, rows, strict=True)),
    ]
    return _csv(lines)


def _transits(ranges: Ranges) -> str:
    rows = zip(ranges.directions, _cells(ranges.transits), strict=True)
    lines = [["k", "direction", *_names(TRANSITS)]]
    lines += [[str(k), str(direction), *row] for k, (direction, row) in enumerate(rows, 1)]
    return _csv(lines)


def _names(columns: Sequence[str]) -> list[str]:
    return [f"{name}_{word}" for name in columns for word in ("low", "high")]


def _csv(lines: Sequence[Sequence[str]]) -> str:
    return "".join(",".join(line) + "\n" for line in lines)


def _holds(text: str, table: Intervals) -> bool:
    """Return whether each printed interval contains the proven one, read back from the text."""
    header, *lines = (line.split(",") for line in text.splitlines())
    for name in table.columns:
        low, high = header.index(f"{name}_low"), header.index(f"{name}_high")
        for line, (least, most) in zip(lines, table.exact(name), strict=True):
            if not Fraction(line[low]) <= least <= most <= Fraction(line[high]):
                return False
    return True


def _manifest(ranges: Ranges, tables: dict[str, str]) -> dict[str, Any]:
    proof, scene = ranges.proof, ranges.scene
    sections = scene_inputs(scene)
    sections["run"] = {name: text for name, text in sections["run"].items() if name != "digits"}  # as widths support
    return {
        "format": FORMAT,
        "id": ranges_id(ranges),
        "level": scene.run.level,
        "inputs": scene.inputs,
        "scene": sections,
        "uncertain": {name: f"±{width}" for name, width in ranges.uncertain.items()},
        "period_s": period_texts(ranges),
        "possible": [
            {"from_s": outward(low, -1), "to_s": outward(high, 1), "parity": parity}
            for low, high, parity in ranges.possible
        ],
        "counts": {"grid": len(ranges.times), "transits": len(ranges.transits), "possible": len(ranges.possible)},
        "proof": {"bits": proof.bits, "steps": proof.steps, "radius_m": rounded_up(proof.radius)},
        "sha256": {name: hashlib.sha256(text.encode()).hexdigest() for name, text in tables.items()},
    }
