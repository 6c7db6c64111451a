"""Check the rows together: integrate the scene again in limbs, and compare every number.

Two runs from the exact release, at two precisions, show by their disagreement how far the finer one
can be trusted. On a chaotic scene even the most bits that limbs have may not decide; that is
reported, and is no problem. Each zero of xdot is a row of `transits.csv`, or lies in a possible
interval, where xdot only grazes zero.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
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
from ..files import DatasetFiles
from ..manifest import MANIFEST, Kind, Manifest, Possible
from ..sheets import Sheet
from . import function
from .scene_check import largest_jerk

# CPU seconds that the runs may take: some, and more for longer tables
_BASE_S = 2.0
_ROW_S = 0.01
_TRANSIT_S = 0.001
_PATIENCE = 4  # times that, for all attempts together, where the first does not decide
_GRAZES = (
    8  # of the bounds on vx, and of xdot where a proof may not have decided whether it is zero
)
# times the time that the radius of a velocity is worth: a ball about a zero, which also holds the
# end
_UNSURE = 4
_OUTWARD = Fraction(2, 10**20)  # s, by which the ends of a possible interval are rounded outward
_FINER_BITS = 44  # two limbs, between two attempts; one limb between the two runs of an attempt
_MOST_STEPS = 1e15

_COLUMNS: dict[Kind, tuple[str, ...]] = {"grid": GRID, "transits": TRANSITS, "sections": SECTION}
_ROW_WORD: dict[Kind, str] = {"grid": "t =", "transits": "transit", "sections": "passage of"}

# called with the simulated time reached and the whole span, in s
Progress = Callable[[float, float], None]


@dataclass(frozen=True)
class _Comparison:
    """A table as printed, None if the dataset does not have it, and the same rows by two runs."""

    kind: Kind
    sheet: Sheet | None
    coarse: Table
    fine: Table


def problems(files: DatasetFiles, report: Progress | None = None) -> tuple[list[str], list[str]]:
    """Return a sentence for every number that the motion contradicts, and what could not be decided."""
    if not engines()["limbs"].installed:
        return [], _undecided(
            "integrating it again needs numba: pip install 'foucault-reference[fast]'"
        )
    manifest = files.manifest
    counts = manifest.counts
    allowed_s = _BASE_S + _ROW_S * counts.grid + _TRANSIT_S * counts.transits
    most_s = allowed_s
    expected_s = 0.0
    prec = _first_prec(manifest)
    steps = _steps(files)
    try:
        while prec <= MOST_PREC:
            expected_s += 2 * engines()["limbs"].expected_s(steps, prec)
            if expected_s > most_s:
                return [], _undecided(f"integrating it again would take about {expected_s:.0f} s")
            coarse = _run(files, prec - LIMB_BITS, report)
            fine = _run(files, prec, report)
            differing = _differing(files, coarse, fine)
            if differing is not None:
                return differing, ["the possible transits"] if manifest.possible else []
            prec += _FINER_BITS
            most_s = _PATIENCE * allowed_s
    except UnreachableError as error:
        return [], _undecided(str(error))
    return [], _undecided(f"two runs in up to {MOST_PREC} bits differ by more than the bounds")


def _undecided(reason: str) -> list[str]:
    """Return what is reported of a dataset whose motion was not compared."""
    return [f"the motion (each row was checked by itself; {reason})"]


def _first_prec(manifest: Manifest) -> int:
    """Return the bits of the first attempt: as in the published run, or more for the digits."""
    published = re.search(r"\((\d{1,4})\)", manifest.run.number)
    published_bits = int(published[1]) if published else DOUBLE_BITS
    digits_bits = bits_of(manifest.digits) + GUARD_BITS // 2
    prec = max(published_bits, digits_bits, LEAST_PREC + LIMB_BITS)
    return min(prec, MOST_PREC)


def _steps(files: DatasetFiles) -> int:
    """Estimate the steps of a run: the fastest rate in the scene, times the span."""
    start = Start.of(files.scene.exact, GUARD_BITS)
    k = start.k
    rate = float(start.ctx.sqrt(start.ctx.norm(k.pull)) + abs(k.rate) + k.drag)
    speed_over_length = float(_largest_speed(files) / files.scene.exact.length)
    t_end = float(files.scene.exact.t_end)
    return int(min(_MOST_STEPS, t_end * (rate + speed_over_length)))


def _largest_speed(files: DatasetFiles) -> Fraction:
    """Return |vx| + |vy| + |vz| where it is largest, in the grid or at moments of the function."""
    if files.manifest.alone:
        _, golden_function = files.function  # type: ignore[misc]
        states = golden_function.at(function.moments(files))
        speeds = sum(np.abs(getattr(states, name)) for name in VELOCITY)
        return Fraction(float(speeds.max()))
    rows = files.tables["grid.csv"].numbers(VELOCITY)
    return max(sum(map(abs, row), Fraction(0)) for row in rows)


def _run(files: DatasetFiles, prec: int, report: Progress | None) -> Run:
    """Return a run through the grid and the moments at which the function is compared."""
    inputs = files.scene.exact
    times = sorted({*inputs.grid, *map(Fraction, function.moments(files))})
    plan = engines()["limbs"].plan(inputs, prec, tuple(times), _decided_words(files))
    if report is None:
        return run(plan, None)
    return run(plan, lambda t: report(t, float(inputs.t_end)))


def _decided_words(files: DatasetFiles) -> tuple[str, ...]:
    """Return the zeros to look for: all but sections with intervals that the proof left open."""
    sections = files.manifest.sections
    possible = sections.possible if sections else {}
    return tuple(word for word in files.scene.run.zeros if not possible.get(word))


def _differing(files: DatasetFiles, coarse: Run, fine: Run) -> list[str] | None:
    """Return a sentence for each number that is off; None if the two runs cannot decide."""
    if any(coarse.zeros[word].directions != zeros.directions for word, zeros in fine.zeros.items()):
        return None
    miscounted_transits, transits = _transits(files, coarse, fine)
    miscounted_passages, passages = _sections(files, coarse, fine)
    comparisons = [_grid(files, coarse, fine), *transits, *passages]
    off = _off_in_tables(files.manifest, comparisons)
    if off is None:
        return None
    off_in_function = _off_in_function(files, coarse, fine)
    return [*miscounted_transits, *miscounted_passages, *off, *off_in_function]


def _off_in_tables(manifest: Manifest, comparisons: Iterable[_Comparison]) -> list[str] | None:
    """Return a sentence for each printed number that is off; None if the two runs cannot decide."""
    sentences = []
    for comparison in comparisons:
        kind = comparison.kind
        table = comparison.fine.only(_COLUMNS[kind])
        distance = table.distance(comparison.coarse).largest()
        if any(distance[name] > manifest.bound(kind, name) for name in table.columns):
            return None
        if comparison.sheet is not None:
            sentences += _off(manifest, kind, comparison.sheet, table, distance)
    return sentences


def _off_in_function(files: DatasetFiles, coarse: Run, fine: Run) -> list[str]:
    """Return a sentence for each value of the golden function that is off."""
    moments = function.moments(files)
    times = [Fraction(t) for t in moments]
    table = _at(times, fine)
    distance = table.distance(_at(times, coarse)).largest()
    return function.contradicted(files, moments, table, distance)


def _grid(files: DatasetFiles, coarse: Run, fine: Run) -> _Comparison:
    """Return the states of the grid, to be compared."""
    times = files.scene.exact.grid
    sheet = files.tables.get("grid.csv")
    return _Comparison("grid", sheet, _at(times, coarse), _at(times, fine))


def _transits(files: DatasetFiles, coarse: Run, fine: Run) -> tuple[list[str], list[_Comparison]]:
    """Check possible intervals and the number of transits; return problems, and what to compare."""
    if coarse.transits is None or fine.transits is None:
        return [], []
    outside, sentences = _outside_intervals(files, fine.plan, fine.transits)
    sheet = files.tables.get("transits.csv")
    count = files.manifest.counts.transits
    directions = [fine.directions[k] for k in outside]
    printed = directions
    if sheet is not None:
        printed = [int(direction) for (direction,) in sheet.numbers(("direction",))]

    if printed != directions or count != len(directions):
        place = MANIFEST if sheet is None else "transits.csv"
        motion = f"the motion's, which are {len(directions)}"
        return [*sentences, f"{place}: {count} transits are not {motion}"], []
    if not directions:
        return sentences, []
    rough = _rows(coarse.transits, outside)
    return sentences, [_Comparison("transits", sheet, rough, _rows(fine.transits, outside))]


def _sections(files: DatasetFiles, coarse: Run, fine: Run) -> tuple[list[str], list[_Comparison]]:
    """Check the number of passages in decided sections; return problems, and what to compare."""
    sheet = files.tables.get("sections.csv")
    if sheet is None:
        return [], []
    passages = sections_of(fine.zeros)
    rows = [row for row in sheet.rows if row[0] in passages]
    printed = [(row[0], row[3]) for row in rows]
    expected = [
        (word, f"{direction:+d}")
        for word, zeros in passages.items()
        for direction in zeros.directions
    ]
    if printed != expected:
        motion = f"the motion's, which are {len(expected)}"
        return [f"sections.csv: {len(rows)} passages are not {motion}"], []
    if not expected:
        return [], []
    rough = _joined(sections_of(coarse.zeros))
    return [], [_Comparison("sections", replace(sheet, rows=rows), rough, _joined(passages))]


def _joined(passages: Mapping[str, Zeros[Table]]) -> Table:
    """Return the passages of all sections in one table."""
    tables = [zeros.table for zeros in passages.values()]
    return replace(tables[0], values=[row for table in tables for row in table.values], errors=[])


def _rows(table: Table, places: Iterable[int]) -> Table:
    """Return some rows of a table."""
    return replace(table, values=[table.values[k] for k in places])


def _at(times: Iterable[Fraction], run: Run) -> Table:
    """Return the states of a run at some of its times."""
    row = {t: k for k, t in enumerate(run.plan.times)}
    values = run.grid.only(GRID).values
    return Table(GRID, run.grid.bits, [values[row[t]] for t in times])


def _outside_intervals(
    files: DatasetFiles, plan: Plan, zeros: Table
) -> tuple[list[int], list[str]]:
    """Return which zeros of xdot lie in no possible interval, and a sentence for each refuted one.

    By Taylor's theorem xdot at a zero, or in the middle of an interval, bounds it elsewhere in the
    interval.

    Args:
        files: the dataset, with its intervals.
        plan: of the run that found the zeros.
        zeros: their times and states.
    """
    times = zeros.exact("t")
    slopes = zeros.exact("ax")
    grazing = _Grazing(_GRAZES * files.manifest.bound("grid", "vx"), largest_jerk(files))
    intervals = files.manifest.possible
    middles = _middles(plan, intervals)
    outside = set(range(len(times)))
    refuted = []
    for interval, vx, ax in zip(
        intervals, middles.exact("vx")[1:], middles.exact("ax")[1:], strict=True
    ):
        low, high = Fraction(interval.from_s), Fraction(interval.to_s)
        inside = range(bisect_left(times, low), bisect_right(times, high))
        outside.difference_update(inside)
        slopes_inside = slopes[inside.start : inside.stop]
        is_far = grazing.is_far(vx, ax, (high - low) / 2)
        if is_far or _is_decided(files, interval, slopes_inside, grazing):
            refuted.append(_refuted_text(interval, len(inside)))
    return sorted(outside), refuted


def _refuted_text(interval: Possible, count: int) -> str:
    place = f"possible: from {interval.from_s} to {interval.to_s} s"
    return f"{MANIFEST}: {place} the motion has {count} transits, and that is decided"


def _is_decided(
    files: DatasetFiles, interval: Possible, slopes: list[Fraction], grazing: _Grazing
) -> bool:
    """Return whether the slopes of xdot at its zeros in an interval decide how many there are."""
    low, high = Fraction(interval.from_s), Fraction(interval.to_s)
    if _ends_the_run(files, low, high, slopes):
        return False
    return grazing.crosses(slopes) or _has_other_parity(interval, len(slopes))


@dataclass(frozen=True)
class _Grazing:
    """What counts as a grazing zero.

    Attributes:
        near: |xdot| below which a proof may not have decided whether it is zero, in m/s.
        jerk: a bound on the rate of xddot, in m/s³.
    """

    near: Fraction
    jerk: Fraction

    def crosses(self, slopes: Iterable[Fraction]) -> bool:
        """Return whether one of some zeros, by its slope in m/s², does not graze."""
        return any(slope**2 > self.near * self.jerk for slope in slopes)

    def is_far(self, vx: Fraction, ax: Fraction, half_s: Fraction) -> bool:
        """Return whether xdot is nowhere near zero in an interval.

        Args:
            vx: xdot in its middle, in m/s.
            ax: the slope of xdot there, in m/s².
            half_s: half of its length.
        """
        return abs(vx) > self.near + half_s * (abs(ax) + self.jerk * half_s / 2)


def _has_other_parity(interval: Possible, count: int) -> bool:
    """Return whether a number of zeros contradicts the parity of an interval."""
    return interval.parity == ("even" if count % 2 else "odd")


def _middles(plan: Plan, intervals: Iterable[Possible]) -> Table:
    """Return the state at the release, where a run begins, and in the middle of each interval."""
    middles = [(Fraction(part.from_s) + Fraction(part.to_s)) / 2 for part in intervals]
    times = (Fraction(0), *middles)
    return engines()["limbs"].run(replace(plan, times=times, zeros=())).grid


def _ends_the_run(
    files: DatasetFiles, low: Fraction, high: Fraction, slopes: list[Fraction]
) -> bool:
    """Return whether an interval ends with the run and is so short that a proof cannot decide.

    The proof then cannot tell if a zero lies before or after the end.

    Args:
        files: the dataset.
        low: where it begins, in s.
        high: where it ends, in s.
        slopes: the rate of xdot at each zero in it, in m/s².
    """
    proof = files.manifest.enclosure
    if proof is None or high != files.scene.exact.t_end or len(slopes) != 1:
        return False
    time_radius_s = Fraction(proof.velocity_radius_m_s) / abs(slopes[0])
    return high - low <= _UNSURE * time_radius_s + _OUTWARD


def _off(
    manifest: Manifest, kind: Kind, sheet: Sheet, table: Table, distance: Mapping[str, Fraction]
) -> list[str]:
    """Return a sentence for every printed number that is too far from a run.

    The limit is its bound plus the distance of the two runs.

    Args:
        manifest: with the bounds of the columns.
        kind: of the table.
        sheet: the table as printed.
        table: its rows by the run.
        distance: the largest distance of the two runs, by column.
    """
    printed, scale = sheet.scaled_integers(table.columns)
    unit = scale << table.bits
    sentences = []
    for i, name in enumerate(table.columns):
        bounds = [manifest.bound(kind, name)] * len(sheet.rows)
        if name == "t":
            bounds = [bound for (bound,) in sheet.numbers(("bound",))]
        limits = {bound: int((bound + distance[name]) * unit) for bound in set(bounds)}
        rows = zip(sheet.rows, printed[i] << table.bits, table.values, bounds, strict=True)
        for row, number, values, bound in rows:
            gap = abs(number - values[i] * scale)
            if gap > limits[bound]:
                place = f"{kind}.csv: {_ROW_WORD[kind]} {row[0]}"
                sentences.append(f"{place}: {_error_text(name, gap / unit, bound)}")
    return sentences


def _error_text(name: str, error: float, bound: Fraction) -> str:
    return f"{name} is off by {error:.2g}, its bound is {float(bound):.2g}"
