"""Check the rows together: integrate the scene again in limbs, and compare every printed number with the result.

Two runs from the exact release, at two precisions, show by their disagreement how far the finer one can be trusted.
Where even the most bits that limbs have do not decide, as on a chaotic scene, that is said, and nothing is wrong.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ...engines.limbs.size import LEAST_PREC, LIMB_BITS, MOST_PREC
from ...engines.plan import Run
from ...engines.registry import engines
from ...errors import IntegrationError, UnreachableError
from ...model.start import Start
from ...numbers.columns import GRID, TRANSITS, VELOCITY
from ...numbers.precision import DOUBLE_BITS, GUARD_BITS, bits_of
from ...numbers.table import Table
from ..golden import Files
from ..manifest import Manifest
from ..sheets import Sheet

BASE_S, ROW_S, TRANSIT_S = 2.0, 0.01, 0.001  # CPU seconds that the runs may take: some, and more for longer tables
PATIENCE = 4  # times that, before a run that was expected to be short is given up
FINER_BITS = 44  # two limbs, between two attempts; one limb between the two runs of an attempt

Progress = Callable[[float, float], None]  # called with the simulated time reached and the whole span, in s


class _TooLong(Exception):
    """The runs have taken `PATIENCE` times what they may."""


@dataclass
class _Budget:
    """CPU seconds that are left for the steps of all runs; compiling, before the first step, does not count."""

    left: float

    def watched(self, report: Callable[[float], None]) -> Callable[[float], None]:
        """Return what a run calls from time to time; it passes the simulated time on.

        Raises:
            _TooLong: nothing is left.
        """
        last: float | None = None

        def watch(t: float) -> None:
            nonlocal last
            now = time.process_time()
            self.left -= now - (now if last is None else last)
            last = now
            if self.left <= 0:
                raise _TooLong
            report(t)

        return watch


def problems(files: Files, report: Progress | None = None) -> tuple[list[str], list[str]]:
    """Return a sentence for every number that the motion contradicts, and what could not be checked."""
    if not engines()["limbs"].installed:
        return [], _undecided("integrating it again needs numba (pip install 'foucault-reference[methods]')")
    manifest = files.manifest
    allowed = BASE_S + ROW_S * manifest.counts.grid + TRANSIT_S * manifest.counts.transits
    prec = _first_prec(manifest)
    expected = 2 * engines()["limbs"].expected_s(_steps(files), prec)
    if expected > allowed:
        return [], _undecided(f"integrating it again would take about {expected:.0f} s")
    seek = files.scene.run.transits and manifest.transits == "complete" and "transits.csv" in files.tables
    budget = _Budget(PATIENCE * allowed)
    try:
        while prec <= MOST_PREC:
            coarse = _run(files, prec - LIMB_BITS, seek, budget, report)
            fine = _run(files, prec, seek, budget, report)
            found = _compared(files, coarse, fine)
            if found is not None:
                return found, []
            prec += FINER_BITS
    except _TooLong:
        return [], _undecided(f"integrating it again takes more than {PATIENCE * allowed:.0f} s")
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
    speeds = (sum(abs(part) for part in row) for row in files.tables["grid.csv"].numbers(VELOCITY))
    rate = float(start.ctx.sqrt(start.ctx.norm(start.k.pull)) + abs(start.k.rate) + start.k.drag)
    rate += float(max(speeds) / files.scene.exact.length)
    return int(min(1e15, float(files.scene.exact.t_end) * rate))


def _run(files: Files, prec: int, seek: bool, budget: _Budget, report: Progress | None) -> Run:
    limbs, inputs = engines()["limbs"], files.scene.exact

    def show(t: float) -> None:
        if report is not None:
            report(t, float(inputs.t_end))

    return limbs.run(limbs.plan(inputs, prec, tuple(inputs.grid), seek), budget.watched(show))


def _compared(files: Files, coarse: Run, fine: Run) -> list[str] | None:
    """Return the numbers that are off; None where the two runs are too far apart to tell."""
    manifest = files.manifest
    comparisons = [_Comparison.of(manifest, "grid", files.tables["grid.csv"], coarse.grid, fine.grid)]
    found = []
    if fine.transits is not None:
        if coarse.directions != fine.directions:
            return None
        sheet = files.tables["transits.csv"]
        directions = [int(row[sheet.header.index("direction")]) for row in sheet.rows]
        if directions != fine.directions:
            return [f"transits.csv: {len(directions)} transits, the motion has {len(fine.directions)}"]
        assert coarse.transits is not None
        if directions:
            comparisons.append(_Comparison.of(manifest, "transits", sheet, coarse.transits, fine.transits))
    for comparison in comparisons:
        if not comparison.decided:
            return None
        found += comparison.problems()
    return found


@dataclass(frozen=True)
class _Comparison:
    """A printed table beside the same columns of two runs."""

    kind: str
    sheet: Sheet
    table: Table
    apart: dict[str, Fraction]
    bounds: dict[str, Fraction]
    decimals: dict[str, int]

    @classmethod
    def of(cls, manifest: Manifest, kind: str, sheet: Sheet, coarse: Table, fine: Table) -> _Comparison:
        columns: Sequence[str] = GRID if kind == "grid" else TRANSITS
        table = fine.only(tuple(columns))
        bounds = {name: manifest.bound(kind, name) for name in columns}  # type: ignore[arg-type]
        apart = table.distance(coarse).largest()
        return cls(kind, sheet, table, apart, bounds, manifest.decimals[kind])  # type: ignore[index]

    @property
    def decided(self) -> bool:
        """Whether the runs are nearer to each other than the bounds ask."""
        return all(self.apart[name] <= bound for name, bound in self.bounds.items())

    def problems(self) -> list[str]:
        """Return a sentence for every printed number that is not within its bound."""
        found, word = [], "transit" if self.kind == "transits" else "t ="
        printed, ten = self.sheet.integers(self.table.columns)
        of_row = list(self.sheet.numbers(("bound",))) if self.kind == "transits" else []
        unit = ten << self.table.bits
        for i, name in enumerate(self.table.columns):
            bounds = (
                [row[0] for row in of_row] if of_row and name == "t" else [self.bounds[name]] * len(self.sheet.rows)
            )
            limits = {bound: int((bound + self.apart[name]) * unit) for bound in set(bounds)}
            rows = zip(self.sheet.rows, printed[i] << self.table.bits, self.table.values, bounds, strict=True)
            for row, number, values, bound in rows:
                off = abs(number - values[i] * ten)
                if off > limits[bound]:
                    where = f"{self.kind}.csv: {word} {row[0]}: {name} is off by {off / unit:.2g}"
                    found.append(f"{where}, its bound is {float(bound):.2g}")
        return found
