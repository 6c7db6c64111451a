"""Check the golden function: what follows from the manifest, the rows of the grid, and the motion between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

import numpy as np

from ...numbers.columns import STATE
from ...numbers.precision import double_below
from ...numbers.table import Table
from ..files import Files
from ..function import FunctionRecord
from ..manifest import FUNCTION, differences

INSIDE = 2  # random times in each piece that are compared with the motion; and both of its ends


def problems(files: Files) -> Iterator[str]:
    """Yield what does not follow from manifest and scene, and where the function contradicts a row of the grid."""
    if files.function is None:
        return
    (record, function), end = files.function, double_below(files.scene.exact.t_end)
    follows = FunctionRecord.following(files.manifest)
    for place, old, new in differences({name: getattr(record, name) for name in follows}, follows):
        yield f"{FUNCTION[0]}: {place} = {old} does not follow from the manifest, which gives {new}"
    if function.times[-1] != end:
        yield f"{FUNCTION[0]}: it ends at {function.times[-1]:.17g} s, not at {end:.17g} s"
        return
    rows = files.tables["grid.csv"].rows if "grid.csv" in files.tables else []
    texts = [row for row in rows if Fraction(float(row[0])) == Fraction(row[0])]
    at = function.at([float(row[0]) for row in texts])
    for i, name in enumerate(STATE, 1):
        numbers = np.array([float(row[i]) for row in texts])
        limit = (
            float(files.manifest.bound("grid", name))
            + function.bound[name]
            + np.spacing(np.abs(numbers))
        )
        off = np.abs(getattr(at, name) - numbers)
        for k in np.flatnonzero(off > limit):
            yield f"{FUNCTION[0]}: t = {texts[k][0]}: {name} is {off[k]:.2g} from grid.csv, its bound is {limit[k]:.2g}"


def moments(files: Files) -> list[float]:
    """Return times at which the function is compared with the motion: in every piece both ends and random ones."""
    if files.function is None:
        return []
    ends, chance = files.function[1].times, np.random.default_rng(int(files.manifest.seal, 16))
    inside = chance.uniform(ends[:-1], ends[1:], (INSIDE, len(ends) - 1)).ravel()
    return sorted({*ends.tolist(), *np.nextafter(ends[1:], 0.0).tolist(), *inside.tolist()})


def contradicted(
    files: Files, times: list[float], table: Table, apart: Mapping[str, Fraction]
) -> list[str]:
    """Return a sentence for every value that is further from a run than its bound and the distance of two runs."""
    if files.function is None:
        return []
    record, function = files.function
    at, sentences = function.at(times), []
    for name in STATE:
        limit = Fraction(record.bounds[name]) + apart[name]
        for t, value, whole in zip(
            times, getattr(at, name).tolist(), table.whole(name, table.bits), strict=True
        ):
            n, d = value.as_integer_ratio()
            gap = Fraction(abs((n << table.bits) - whole * d), d << table.bits)
            if gap > limit:
                text = f"{FUNCTION[0]}: t = {t:.17g}: {name} is off by {float(gap):.2g}"
                sentences.append(f"{text}, its bound is {record.bounds[name]}")
    return sentences
