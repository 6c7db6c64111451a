"""A solved scene: tables of numbers with error bounds, their decimals, and the runs or the proof that support them.

The decimals follow from the bounds, and so does whether a proof decides each digit; `Table` rounds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, TypeVar

import numpy.typing as npt

from ..engines.plan import Run
from ..errors import Described, InputError, UnreachableError, counted
from ..numbers.columns import POSITION, TRANSITS, VELOCITY, GridColumns
from ..numbers.function import GoldenFunction, States
from ..numbers.table import Table, UndecidedNumber, decimals_of, resolved
from ..numbers.zeros import WithZeros, Zeros, columns_of
from ..scenes.fields import Confirmation, Level
from ..scenes.scene import Scene
from .agreement import zero_decimals
from .swing import NO_SECTION, UNDECIDED, Swing, swing_or_reason

T = TypeVar("T")
SAMPLED = 10  # a sampled confirmation integrates one in ten intervals of the grid


@dataclass(frozen=True)
class Source:
    """A run that numbers come from: engine, formulation, number type, order, steps, cost."""

    engine: str
    formulation: str
    number: str
    order: int
    steps: int
    cpu_s: float
    compile_s: float

    @classmethod
    def of(cls, run: Run) -> Source:
        """Build from a run."""
        return cls(
            engine=run.plan.engine,
            formulation=run.plan.formulation,
            number=str(run.plan.number),
            order=run.order,
            steps=run.steps,
            cpu_s=run.cpu_s,
            compile_s=run.compile_s,
        )


@dataclass(frozen=True)
class CrossCheck(Source):
    """A run that checks the published numbers, and its largest distance from them, in m, m/s, s."""

    position_m: Fraction
    velocity_m_s: Fraction
    transit_s: Fraction | None

    @classmethod
    def by(
        cls, witness: Run, gaps: Mapping[str, Fraction], transit_s: Fraction | None
    ) -> CrossCheck:
        """Build from a run and its largest differences, by grid column, and of transit times."""
        return cls(
            **vars(Source.of(witness)),
            position_m=max(gaps[name] for name in POSITION),
            velocity_m_s=max(gaps[name] for name in VELOCITY),
            transit_s=transit_s,
        )


@dataclass(frozen=True)
class Proof:
    """A proof, its audit and its confirmation.

    Attributes:
        enclosure: the `Enclosure`: method, size, largest radii in m and m/s, and what trusted code
            returned, which is compared with what is written.
        transit_radius: the largest radius of a transit's time in s.
        agreement_bits: bits to which its run agrees with it.
        audited: whether all that compiled code returned for it was checked, so that FLINT alone
            proves the same.
        confirmed: what heyoka's run in another formulation agrees with to every printed digit:
            "whole", all rows and transits; "sampled", a tenth of the grid's intervals, each from
            its first row; or "none".
        audit_s: CPU seconds of the audit.
    """

    enclosure: Any = field(repr=False)
    transit_radius: Fraction | None
    agreement_bits: int
    audited: bool = False
    confirmed: Confirmation = "none"
    audit_s: float = 0.0


@dataclass(frozen=True, repr=False)
class Solution(GridColumns, WithZeros[Table]):
    """A solved scene.

    Attributes:
        scene: the scene as solved.
        times: grid times in s, exact.
        grid: `columns.GRID` at those times, in SI units.
        zeros: the zeros that the scene asks for, by word: "xdot" for transits, and its sections;
            without xdot where that is identically zero.
        run: the run that computed the numbers.
        checks: runs that agree with it.
        pilot_s: CPU seconds of the pilot runs, from which the precision was chosen.
        proof: the enclosure, at the level enclosed.
        guard: at the level enclosed, if no run confirms every transit: a run with event detection
            that found them all, in the cheapest sufficient type; no dataset mentions it.
        discarded_s: CPU seconds of runs and proofs in too few bits, whose numbers are not used.
        not_checked: why there is neither a whole confirmation nor a guard. The proof does not rely
            on them; a run that finds other transits is an error.

    `solution.t`, `.x`, `.y`, `.z`, `.vx`, `.vy`, `.vz` are binary64 arrays of shape (rows,),
    `solution.exact("x")` are fractions. Both tables have `table["x"]`, `table.exact("x")` and
    `table.bound("x")`, bounds on the errors, proven at the level enclosed and otherwise estimated.
    With a golden function `solution.at(t)` is the motion at any time.
    """

    scene: Scene
    times: tuple[Fraction, ...]
    grid: Table
    zeros: Mapping[str, Zeros[Table]] = field(repr=False)
    run: Source
    checks: tuple[CrossCheck, ...]
    pilot_s: float
    proof: Proof | None = None
    guard: CrossCheck | None = None
    discarded_s: float = 0.0
    not_checked: str = ""

    def _none(self) -> Table:
        return Table(TRANSITS, 0, [])

    @property
    def level(self) -> Level:
        """Level of trust in the numbers, one of `scene.LEVELS`."""
        return self.scene.run.level

    @property
    def check_s(self) -> float:
        """CPU seconds of the runs that check the numbers, of the proof, and of its audit."""
        cpu_s = sum(check.cpu_s for check in (*self.checks, self.guard) if check)
        if self.proof:
            cpu_s += self.proof.enclosure.cpu_s + self.proof.audit_s
        return cpu_s

    @property
    def cpu_s(self) -> float:
        """CPU seconds of all runs and proofs, without imports and compilation."""
        return self.pilot_s + self.run.cpu_s + self.check_s + self.discarded_s

    @property
    def swing(self) -> Swing | None:
        """Frequency and precession as intervals from highest points; None without a swing."""
        return self.swing_or_reason if isinstance(self.swing_or_reason, Swing) else None

    @cached_property
    def swing_or_reason(self) -> Swing | str:
        """The swing, or a sentence that says why there is none."""
        passages = self.sections.get("highest")
        if passages is None:
            return NO_SECTION
        if passages.possible:
            return UNDECIDED
        table = passages.table
        columns = []
        for name in ("t", "x", "y", "z"):
            pairs = zip(table.exact(name), table.bound(name), strict=True)
            columns.append([(middle - bound, middle + bound) for middle, bound in pairs])
        points = [*zip(*columns, strict=True)]
        return swing_or_reason(points, self.scene.exact, table.bits)

    @cached_property
    def function(self) -> GoldenFunction | None:
        """The golden function, if it was asked for."""
        proved = self.proof and self.proof.enclosure.function
        if not proved:
            return None
        return GoldenFunction.of(proved.facts, proved.bounds, proved.data)

    def at(self, t: npt.ArrayLike) -> States:
        """Return the states, with their bounds, at times in s of any shape and in any order.

        They are those of the golden function.

        Raises:
            InputError: the solution has no golden function, or a time lies outside of its span.
        """
        if self.function is None:
            advice = "Solve it with level='enclosed', function=True, or write it and load it."
            got = Described("a solution without a golden function")
            raise InputError("at", got, "a solution with a golden function", advice)
        return self.function.at(t)

    def __repr__(self) -> str:
        """Return scene, level, digits, and the numbers of rows and transits."""
        run = self.scene.run
        times = counted(len(self.times), "grid time")
        transits = counted(len(self.directions), "transit")
        return f"Solution({self.scene.id}: {run.level}, {run.digits} digits, {times}, {transits})"


def grid_decimals(solution: Solution) -> dict[str, int]:
    """Return the number of decimals of each column of the grid.

    Its largest number gets the significant digits asked for.
    """
    sizes = resolved(solution.grid.largest(), solution.grid.largest_bounds())
    return decimals_of(sizes, solution.scene.run.digits)


def decimals_of_zeros(solution: Solution, word: str) -> dict[str, int]:
    """Return the number of decimals of each column of a section's zeros; empty if there are no zeros."""
    if word not in solution.zeros:
        return {}
    tables = {other: zeros.table for other, zeros in solution.zeros.items()}
    return zero_decimals(tables, word, grid_decimals(solution), solution.scene.run.digits)


def exact_decimals(values: tuple[Fraction, ...]) -> int:
    """Return the number of decimals with which terminating decimals are printed exactly."""
    digits = 0
    for value in values:
        while (value * 10**digits).denominator != 1:
            digits += 1
    return digits


def _tables_of(solution: Solution) -> list[tuple[Table, dict[str, int]]]:
    """Return the tables of grid, transits and sections, each with the decimals of its columns."""
    tables = [(solution.grid, grid_decimals(solution))]
    for word, zeros in solution.zeros.items():
        tables.append((zeros.table, decimals_of_zeros(solution, word)))
    return tables


def separated(
    zeros: Sequence[Any], word: str, end: Fraction, table: Callable[[tuple[str, ...], Any], T]
) -> Zeros[T]:
    """Return the zeros that a proof found up to `end`: single ones as a table, and undecided ones.

    Zeros lie in (0, end], to which the ball of an undecided cluster is cut.
    """
    columns = columns_of(word)
    rows = []
    directions = []
    possible = []
    for zero in zeros:
        if zero.kind == "one":
            rows.append(tuple(getattr(zero, name) for name in columns))
            directions.append(zero.direction)
        else:
            interval = (max(zero.t.low, Fraction(0)), min(zero.t.high, end))
            possible.append((*interval, zero.parity))
    return Zeros(table(columns, tuple(rows)), directions, tuple(possible))


def check_decided(solution: Solution) -> None:
    """Raise `UndecidedRounding` for the widest interval that does not decide a printed digit.

    The numbers of the release that the scene itself gives are exact, and rounded as they are.
    """
    (grid, decimals), *zeros = _tables_of(solution)
    widest = [grid.undecided(decimals, solution.scene.exact.released)]
    widest += [table.undecided(places) for table, places in zeros]
    undecided = [number for number in widest if number]
    if undecided:
        raise UndecidedRounding(max(undecided))


class UndecidedRounding(UnreachableError):
    """A proven interval contains a number halfway between two decimals: a finer enclosure is needed.

    Attributes:
        width: half-width of the widest such interval, in units of the last printed digit.
        column: the column of its number.
    """

    def __init__(self, number: UndecidedNumber) -> None:
        super().__init__(
            f"The enclosure of {number.column} = {number.text} does not decide its last digit."
        )
        self.width = number.width
        self.column = number.column
