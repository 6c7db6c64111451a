"""Check the rows together: integrate the scene again in limbs, and compare every printed number with the result.

Two runs from the exact release, at two precisions, show by their disagreement how far the finer one can be trusted.
Where even the most bits that limbs have do not decide, as on a chaotic scene, that is said, and nothing is wrong.
Each zero of xdot is a row of `transits.csv`, or lies in a possible interval, where xdot only grazes zero.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np

from ...engines.limbs.size import LEAST_PREC, LIMB_BITS, MOST_PREC
from ...engines.plan import Plan, Run
from ...engines.registry import engines, run
from ...errors import UnreachableError
from ...model.start import Start
from ...numbers.columns import GRID, SECTION, TRANSITS, VELOCITY
from ...numbers.precision import DOUBLE_BITS, GUARD_BITS, bits_of
from ...numbers.table import Table
from ...numbers.zeros import Zeros, sections_of
from ..files import Files
from ..manifest import MANIFEST, Kind, Manifest
from . import function
from .scene_check import largest_jerk

# CPU seconds that the runs may take: some, and more for longer tables
BASE_S, ROW_S, TRANSIT_S = 2.0, 0.01, 0.001
PATIENCE = 4  # times that, for all attempts together, where the first does not decide
GRAZES = 8  # of the bounds on vx, and of xdot where a proof may not have decided whether it is zero
# times the time that the radius of a velocity is worth: a ball about a zero, which also holds the end
UNSURE = 4
OUTWARD = Fraction(2, 10**20)  # s, by which the ends of a possible interval are rounded outward
FINER_BITS = 44  # two limbs, between two attempts; one limb between the two runs of an attempt

# called with the simulated time reached and the whole span, in s
Progress = Callable[[float, float], None]


def problems(files: Files, report: Progress | None = None) -> tuple[list[str], list[str]]:
    """Return a sentence for every number that the motion contradicts, and what was not decided, with the reason."""
    if not engines()["limbs"].installed:
        return [], _undecided(
            "integrating it again needs numba: pip install 'foucault-reference[fast]'"
        )
    manifest = files.manifest
    allowed_s = BASE_S + ROW_S * manifest.counts.grid + TRANSIT_S * manifest.counts.transits
    prec, steps, expected_s, most_s = _first_prec(manifest), _steps(files), 0.0, allowed_s
    try:
        while prec <= MOST_PREC:
            expected_s += 2 * engines()["limbs"].expected_s(steps, prec)
            if expected_s > most_s:
                return [], _undecided(f"integrating it again would take about {expected_s:.0f} s")
            coarse, fine = (_run(files, bits, report) for bits in (prec - LIMB_BITS, prec))
            differing = _compared(files, coarse, fine)
            if differing is not None:
                return differing, ["the possible transits"] * bool(manifest.possible)
            prec, most_s = prec + FINER_BITS, PATIENCE * allowed_s
    except UnreachableError as error:
        return [], _undecided(str(error))
    return [], _undecided(f"two runs in up to {MOST_PREC} bits are further apart than the bounds")


def _undecided(reason: str) -> list[str]:
    """Return what is said of a dataset whose motion was not compared."""
    return [f"the motion (each row was checked by itself; {reason})"]


def _first_prec(manifest: Manifest) -> int:
    """Return the bits of the published run where limbs have as many, and at least those of the digits."""
    claimed = re.search(r"\((\d{1,4})\)", manifest.run.number)
    prec = max(
        int(claimed[1]) if claimed else DOUBLE_BITS, bits_of(manifest.digits) + GUARD_BITS // 2
    )
    return min(max(prec, LEAST_PREC + LIMB_BITS), MOST_PREC)


def _steps(files: Files) -> int:
    """Return about how many steps a run takes: the fastest rate in the scene, over the whole span."""
    start = Start.of(files.scene.exact, GUARD_BITS)
    if files.manifest.alone:
        at = files.function[1].at(function.moments(files))  # type: ignore[index]
        speed = Fraction(float(sum(np.abs(getattr(at, name)) for name in VELOCITY).max()))
    else:
        speed = max(
            sum(map(abs, row), Fraction(0)) for row in files.tables["grid.csv"].numbers(VELOCITY)
        )
    rate = float(start.ctx.sqrt(start.ctx.norm(start.k.pull)) + abs(start.k.rate) + start.k.drag)
    return int(
        min(1e15, float(files.scene.exact.t_end) * (rate + float(speed / files.scene.exact.length)))
    )


def _run(files: Files, prec: int, report: Progress | None) -> Run:
    limbs, inputs = engines()["limbs"], files.scene.exact
    times = sorted({*inputs.grid, *map(Fraction, function.moments(files))})
    sections = files.manifest.sections
    undecided = (
        [word for word, possible in sections.possible.items() if possible] if sections else []
    )
    words = tuple(word for word in files.scene.run.zeros if word not in undecided)
    plan = limbs.plan(inputs, prec, tuple(times), words)
    return run(plan, report and (lambda t: report(t, float(inputs.t_end))))


def _compared(files: Files, coarse: Run, fine: Run) -> list[str] | None:
    """Return the numbers that are off; None where the two runs are too far apart to tell."""
    states = [_at(files.scene.exact.grid, run) for run in (coarse, fine)]
    kinds: list[tuple[Kind, Table, Table]] = [("grid", states[0], states[1])]
    differing: list[str] = []
    if any(coarse.zeros[word].directions != zeros.directions for word, zeros in fine.zeros.items()):
        return None
    if coarse.transits is not None and fine.transits is not None:
        outside, differing = _outside_intervals(files, fine.plan, fine.transits)
        sheet, count = files.tables.get("transits.csv"), files.manifest.counts.transits
        expected = [fine.directions[k] for k in outside]
        listed = (
            [direction for (direction,) in sheet.numbers(("direction",))] if sheet else expected
        )
        if listed != expected or count != len(expected):
            where = "transits.csv" if sheet else MANIFEST
            differing.append(
                f"{where}: {count} transits are not the motion's, which are {len(expected)}"
            )
        elif expected:
            tables = [
                replace(run, values=[run.values[k] for k in outside])
                for run in (coarse.transits, fine.transits)
            ]
            kinds.append(("transits", tables[0], tables[1]))
    if sheet := files.tables.get("sections.csv"):
        passages = sections_of(fine.zeros)
        decided = [row for row in sheet.rows if row[0] in passages]
        signs = [
            (word, f"{sign:+d}") for word, zeros in passages.items() for sign in zeros.directions
        ]
        if [(row[0], row[3]) for row in decided] != signs:
            differing.append(
                f"sections.csv: {len(decided)} passages are not the motion's, which are {len(signs)}"
            )
        elif signs:
            files = replace(
                files, tables={**files.tables, "sections.csv": replace(sheet, rows=decided)}
            )
            kinds.append(("sections", _joined(sections_of(coarse.zeros)), _joined(passages)))
    for kind, rough, table in kinds:
        columns = table.only({"grid": GRID, "transits": TRANSITS, "sections": SECTION}[kind])
        apart = columns.distance(rough).largest()
        if any(apart[name] > files.manifest.bound(kind, name) for name in columns.columns):
            return None
        if f"{kind}.csv" in files.tables:
            differing += _off(files, kind, columns, apart)
    times = function.moments(files)
    rough, table = (_at(map(Fraction, times), run) for run in (coarse, fine))
    return differing + function.contradicted(files, times, table, table.distance(rough).largest())


def _joined(passages: Mapping[str, Zeros[Table]]) -> Table:
    """Return the passages of all sections in one table."""
    tables = [zeros.table for zeros in passages.values()]
    return replace(tables[0], values=[row for table in tables for row in table.values], errors=[])


def _at(times: Iterable[Fraction], run: Run) -> Table:
    """Return the states of a run at some of its times."""
    row = {t: k for k, t in enumerate(run.plan.times)}
    values = run.grid.only(GRID).values
    return Table(GRID, run.grid.bits, [values[row[t]] for t in times])


def _outside_intervals(files: Files, plan: Plan, zeros: Table) -> tuple[list[int], list[str]]:
    """Return which zeros of xdot lie in no possible interval, and a sentence for each interval that is refuted.

    By Taylor's theorem xdot at a zero, or in the middle of an interval, tells how near to zero it comes elsewhere.

    Args:
        files: the dataset, with its intervals.
        plan: of the run that found the zeros.
        zeros: their times and states.
    """
    parts, times, slopes, refuted = files.manifest.possible, zeros.exact("t"), zeros.exact("ax"), []
    near, jerk, outside = (
        GRAZES * files.manifest.bound("grid", "vx"),
        largest_jerk(files),
        {*range(len(times))},
    )
    spans = [(Fraction(part.from_s), Fraction(part.to_s)) for part in parts]
    moments = (Fraction(0), *((low + high) / 2 for low, high in spans))
    middles = engines()["limbs"].run(replace(plan, times=moments, zeros=())).grid
    for part, (low, high), vx, ax in zip(
        parts, spans, middles.exact("vx")[1:], middles.exact("ax")[1:], strict=True
    ):
        inside, half = range(bisect_left(times, low), bisect_right(times, high)), (high - low) / 2
        outside.difference_update(inside)
        shown = (
            any(slopes[k] ** 2 > near * jerk for k in inside)
            or part.parity == ("odd", "even")[len(inside) % 2]
        )
        shown = shown and not _ends_the_run(files, low, high, [slopes[k] for k in inside])
        if shown or abs(vx) > near + half * (abs(ax) + jerk * half / 2):
            place = f"possible: from {part.from_s} to {part.to_s} s"
            refuted.append(
                f"{MANIFEST}: {place} the motion has {len(inside)} transits, and that is decided"
            )
    return sorted(outside), refuted


def _ends_the_run(files: Files, low: Fraction, high: Fraction, slopes: list[Fraction]) -> bool:
    """Return whether an interval ends with the run, and is so short that a proof could not tell if a zero comes before.

    Args:
        files: the dataset.
        low: where it begins, in s.
        high: where it ends, in s.
        slopes: the rate of xdot at each zero in it, in m/s².
    """
    proof = files.manifest.enclosure
    if proof is None or high != files.scene.exact.t_end or len(slopes) != 1:
        return False
    late = Fraction(proof.velocity_radius_m_s) / abs(slopes[0])
    return high - low <= UNSURE * late + OUTWARD


def _off(files: Files, kind: Kind, table: Table, apart: Mapping[str, Fraction]) -> list[str]:
    """Return a sentence for every printed number that is further from a run than its bound and the runs' distance."""
    off, word = [], {"grid": "t =", "transits": "transit", "sections": "passage of"}[kind]
    sheet = files.tables[f"{kind}.csv"]
    printed, scale = sheet.integers(table.columns)
    unit = scale << table.bits
    for i, name in enumerate(table.columns):
        of_rows = [files.manifest.bound(kind, name)] * len(sheet.rows)
        if name == "t":
            of_rows = [bound for (bound,) in sheet.numbers(("bound",))]
        limits = {bound: int((bound + apart[name]) * unit) for bound in set(of_rows)}
        rows = zip(sheet.rows, printed[i] << table.bits, table.values, of_rows, strict=True)
        for row, number, values, bound in rows:
            gap = abs(number - values[i] * scale)
            if gap > limits[bound]:
                where = f"{kind}.csv: {word} {row[0]}: {name} is off by {gap / unit:.2g}"
                off.append(f"{where}, its bound is {float(bound):.2g}")
    return off
