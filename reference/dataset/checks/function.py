"""Check the golden function against the manifest, the rows of the grid, and the motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

import numpy as np

from ...numbers.columns import STATE
from ...numbers.function import GoldenFunction
from ...numbers.precision import double_below
from ...numbers.table import Table
from ..files import DatasetFiles
from ..function import FunctionRecord
from ..manifest import FUNCTION, differences

# random times in each piece that are compared with the motion, besides both of its ends
_RANDOM_TIMES = 2


def problems(files: DatasetFiles) -> Iterator[str]:
    """Yield a sentence for everything that does not follow from manifest and scene, or contradicts the grid."""
    if files.function is None:
        return
    record, function = files.function
    expected = FunctionRecord.following(files.manifest)
    recorded = {name: getattr(record, name) for name in expected}
    for place, old, new in differences(recorded, expected):
        yield f"{FUNCTION[0]}: {place} = {old} does not follow from the manifest, which gives {new}"

    end = double_below(files.scene.exact.t_end)
    if function.times[-1] != end:
        yield f"{FUNCTION[0]}: it ends at {function.times[-1]:.17g} s, not at {end:.17g} s"
        return
    if "grid.csv" in files.tables:
        yield from _far_from_grid(files, function)


def _far_from_grid(files: DatasetFiles, function: GoldenFunction) -> Iterator[str]:
    """Yield each number of the grid, at a time that is a double, that the function contradicts."""
    rows = [
        row for row in files.tables["grid.csv"].rows if Fraction(float(row[0])) == Fraction(row[0])
    ]
    states = function.at([float(row[0]) for row in rows])
    for i, name in enumerate(STATE, 1):
        printed = np.array([float(row[i]) for row in rows])
        gaps = np.abs(getattr(states, name) - printed)
        bound = float(files.manifest.bound("grid", name)) + function.bound[name]
        limits = bound + np.spacing(np.abs(printed))
        for k in np.flatnonzero(gaps > limits):
            off = f"{name} is {gaps[k]:.2g} from grid.csv, its bound is {limits[k]:.2g}"
            yield f"{FUNCTION[0]}: t = {rows[k][0]}: {off}"


def moments(files: DatasetFiles) -> list[float]:
    """Return times at which the function is compared with the motion.

    In every piece these are both ends and random ones.
    """
    if files.function is None:
        return []
    _, function = files.function
    ends = function.times
    last_before_ends = np.nextafter(ends[1:], 0.0)
    chance = np.random.default_rng(int(files.manifest.seal, 16))
    random = chance.uniform(ends[:-1], ends[1:], (_RANDOM_TIMES, len(ends) - 1)).ravel()
    return sorted({*ends.tolist(), *last_before_ends.tolist(), *random.tolist()})


def contradicted(
    files: DatasetFiles, times: list[float], table: Table, distance: Mapping[str, Fraction]
) -> list[str]:
    """Return a sentence for every value of the function that a run contradicts.

    Args:
        files: the dataset.
        times: the moments that are compared, in s.
        table: the states of the run at these times.
        distance: the largest distance of two runs, by column.
    """
    if files.function is None:
        return []
    record, function = files.function
    states = function.at(times)
    sentences = []
    for name in STATE:
        limit = Fraction(record.bounds[name]) + distance[name]
        values = getattr(states, name).tolist()
        for t, value, integer in zip(times, values, table.whole(name, table.bits), strict=True):
            numerator, denominator = value.as_integer_ratio()
            difference = (numerator << table.bits) - integer * denominator
            gap = Fraction(abs(difference), denominator << table.bits)
            if gap > limit:
                text = f"{FUNCTION[0]}: t = {t:.17g}: {name} is off by {float(gap):.2g}"
                sentences.append(f"{text}, its bound is {record.bounds[name]}")
    return sentences
