"""Check the rows together: integrate the scene again in limbs, and compare every printed number with the result.

Two runs from the exact release, at two precisions, show by their disagreement how far the finer one can be trusted.
Where even the most bits that limbs have do not decide, as on a chaotic scene, that is said, and nothing is wrong.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from fractions import Fraction

from ...engines.limbs.size import LEAST_PREC, LIMB_BITS, MOST_PREC
from ...engines.plan import Run
from ...engines.registry import engines
from ...errors import IntegrationError, UnreachableError
from ...model.start import Start
from ...numbers.columns import GRID, TRANSITS
from ...numbers.precision import DOUBLE_BITS, GUARD_BITS, bits_of
from ...numbers.table import Table
from ..golden import Files
from ..manifest import Kind, Manifest
from ..sheets import Sheet

BASE_S, ROW_S, TRANSIT_S = 2.0, 0.01, 0.001  # CPU seconds that the runs may take: some, and more for longer tables
PATIENCE = 4  # times that, for all attempts together, where the first does not decide
FINER_BITS = 44  # two limbs, between two attempts; one limb between the two runs of an attempt

Progress = Callable[[float, float], None]  # called with the simulated time reached and the whole span, in s


def problems(files: Files, report: Progress | None = None) -> tuple[list[str], list[str]]:
    """Return a sentence for every number that the motion contradicts, and what could not be checked."""
    if not engines()["limbs"].installed:
        return [], _undecided("integrating it again needs numba (pip install 'foucault-reference[methods]')")
    manifest = files.manifest
    allowed_s = BASE_S + ROW_S * manifest.counts.grid + TRANSIT_S * manifest.counts.transits
    prec, steps, expected_s, most_s = _first_prec(manifest), _steps(files), 0.0, allowed_s
    seek = files.scene.run.transits and manifest.transits == "complete" and "transits.csv" in files.tables
    try:
        while prec <= MOST_PREC:
            expected_s += 2 * engines()["limbs"].expected_s(steps, prec)
            if expected_s > most_s:
                return [], _undecided(f"integrating it again would take about {expected_s:.0f} s")
            coarse, fine = (_run(files, bits, seek, report) for bits in (prec - LIMB_BITS, prec))
            differing = _compared(files, coarse, fine)
            if differing is not None:
                return differing, []
            prec, most_s = prec + FINER_BITS, PATIENCE * allowed_s
    except (IntegrationError, UnreachableError) as error:
        return [], _undecided(str(error))
    return [], _undecided(f"two runs in up to {MOST_PREC} bits are further apart than the bounds")


def _undecided(reason: str) -> list[str]:
    """Return the note on a dataset whose motion was not compared."""
    return [f"motion not decided without --recompute: each row was checked by itself; {reason}"]


def _first_prec(manifest: Manifest) -> int:
    """Return the bits of the published run where limbs have as many, and at least those of the digits."""
    claimed = re.search(r"\((\d{1,4})\)", manifest.run.number)
    prec = max(int(claimed[1]) if claimed else DOUBLE_BITS, bits_of(manifest.digits) + GUARD_BITS // 2)
    return min(max(prec, LEAST_PREC + LIMB_BITS), MOST_PREC)


def _steps(files: Files) -> int:
    """Return about how many steps a run takes: the fastest rate in the scene, over the whole span."""
    start = Start.of(files.scene.exact, GUARD_BITS)
    rate = float(start.ctx.sqrt(start.ctx.norm(start.k.pull)) + abs(start.k.rate) + start.k.drag)
    rate += float(files.fastest / files.scene.exact.length)
    return int(min(1e15, float(files.scene.exact.t_end) * rate))


def _run(files: Files, prec: int, seek: bool, report: Progress | None) -> Run:
    limbs, inputs = engines()["limbs"], files.scene.exact
    end = float(inputs.t_end)
    return limbs.run(limbs.plan(inputs, prec, tuple(inputs.grid), seek), report and (lambda t: report(t, end)))


def _compared(files: Files, coarse: Run, fine: Run) -> list[str] | None:
    """Return the numbers that are off; None where the two runs are too far apart to tell."""
    kinds: list[tuple[Kind, Table, Table]] = [("grid", coarse.grid, fine.grid)]
    if fine.transits is not None:
        if coarse.directions != fine.directions:
            return None
        sheet = files.tables["transits.csv"]
        directions = [int(row[sheet.header.index("direction")]) for row in sheet.rows]
        if directions != fine.directions:
            return [f"transits.csv: {len(directions)} transits, the motion has {len(fine.directions)}"]
        assert coarse.transits is not None
        if directions:
            kinds.append(("transits", coarse.transits, fine.transits))
    differing = []
    for kind, rough, table in kinds:
        columns = table.only(GRID if kind == "grid" else TRANSITS)
        apart = columns.distance(rough).largest()
        bounds = {name: files.manifest.bound(kind, name) for name in columns.columns}
        if any(apart[name] > bound for name, bound in bounds.items()):
            return None
        differing += _off(kind, files.tables[f"{kind}.csv"], columns, apart, bounds)
    return differing


def _off(
    kind: Kind, sheet: Sheet, table: Table, apart: Mapping[str, Fraction], bounds: Mapping[str, Fraction]
) -> list[str]:
    """Return a sentence for every printed number that is further from a run than its bound and the runs' distance."""
    off, word = [], "transit" if kind == "transits" else "t ="
    printed, ten = sheet.integers(table.columns)
    unit = ten << table.bits
    for i, name in enumerate(table.columns):
        of_rows = [bounds[name]] * len(sheet.rows)
        if name == "t":
            of_rows = [bound for (bound,) in sheet.numbers(("bound",))]
        limits = {bound: int((bound + apart[name]) * unit) for bound in set(of_rows)}
        rows = zip(sheet.rows, printed[i] << table.bits, table.values, of_rows, strict=True)
        for row, number, values, bound in rows:
            gap = abs(number - values[i] * ten)
            if gap > limits[bound]:
                where = f"{kind}.csv: {word} {row[0]}: {name} is off by {gap / unit:.2g}"
                off.append(f"{where}, its bound is {float(bound):.2g}")
    return off
