"""A solved scene: tables of numbers with bounds, the decimals to print of each column, the runs or proof behind them.

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
from ..errors import InputError, UnreachableError, counted
from ..numbers.columns import POSITION, TRANSITS, VELOCITY, GridColumns
from ..numbers.function import GoldenFunction, States
from ..numbers.table import Table, decimals_of, resolved
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
        plan = run.plan
        return cls(
            plan.engine,
            plan.formulation,
            str(plan.number),
            run.order,
            run.steps,
            run.cpu_s,
            run.compile_s,
        )


@dataclass(frozen=True)
class CrossCheck(Source):
    """A run that checks the published numbers, and its largest disagreement with them, in m, m/s and s."""

    position_m: Fraction
    velocity_m_s: Fraction
    transit_s: Fraction | None

    @classmethod
    def by(
        cls, witness: Run, gaps: Mapping[str, Fraction], transit_s: Fraction | None
    ) -> CrossCheck:
        """Build from a run, its largest difference in each column of the grid, and that of the transits' times."""
        position_m, velocity_m_s = (
            max(gaps[name] for name in kind) for kind in (POSITION, VELOCITY)
        )
        return cls(
            **vars(Source.of(witness)),
            position_m=position_m,
            velocity_m_s=velocity_m_s,
            transit_s=transit_s,
        )


@dataclass(frozen=True)
class Proof:
    """A proof, and what stands beside it.

    Attributes:
        enclosure: the `Enclosure`: method, size, largest radii in m and m/s, and what trusted code returned, which it
            compares with what is written.
        transit_radius: the largest radius of a transit's time in s.
        agreement_bits: bits to which its run agrees with it.
        audited: whether FLINT alone proves it too.
        confirmed: whether heyoka's run in another formulation agrees to every printed digit, the whole of it with every
            transit, or a sample: a tenth of the grid's intervals, each from its first row.
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
        zeros: the zeros that the scene asks for, by word: "xdot" for transits, and its sections; without xdot where
            that is identically zero.
        run: the run that the numbers come from.
        checks: runs that agree with it.
        pilot_s: CPU seconds of the pilot runs, which the precision was chosen from.
        proof: the enclosure, at the level enclosed.
        guard: at the level enclosed, where no run confirms every transit, one with event detection that found them
            all, in the cheapest type that serves; it goes into no dataset.
        discarded_s: CPU seconds of runs and proofs in too few bits, whose numbers are not used.
        not_checked: why there is neither a whole confirmation nor a guard. The proof does not rest on it, and a run
            that finds other transits is an error.

    `solution.t`, `.x`, `.y`, `.z`, `.vx`, `.vy`, `.vz` are binary64 arrays of shape (rows,), `solution.exact("x")` are
    fractions; both tables have `table["x"]`, `table.exact("x")`, the same, and `table.bound("x")`. With a golden
    function `solution.at(t)` is the motion at any time.
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
        runs = sum(check.cpu_s for check in (*self.checks, self.guard) if check)
        return runs + (self.proof.enclosure.cpu_s + self.proof.audit_s if self.proof else 0.0)

    @property
    def cpu_s(self) -> float:
        """CPU seconds of all runs and proofs, imports and compilation apart."""
        return self.pilot_s + self.run.cpu_s + self.check_s + self.discarded_s

    @property
    def swing(self) -> Swing | None:
        """Frequency and precession as intervals, with the section `highest`; None without it, or where it is open."""
        return self.swing_or_reason if isinstance(self.swing_or_reason, Swing) else None

    @cached_property
    def swing_or_reason(self) -> Swing | str:
        """The swing, or a sentence that says why there is none."""
        passages = self.sections.get("highest")
        if passages is None:
            return NO_SECTION
        if passages.possible:
            return UNDECIDED
        table, names = passages.table, ("t", "x", "y", "z")
        pairs = (zip(table.exact(name), table.bound(name), strict=True) for name in names)
        ends = ([(q - bound, q + bound) for q, bound in column] for column in pairs)
        return swing_or_reason([*zip(*ends, strict=True)], self.scene.exact, table.bits)

    @cached_property
    def function(self) -> GoldenFunction | None:
        """The golden function, if it was asked for."""
        proved = self.proof and self.proof.enclosure.function
        return GoldenFunction.of(proved.facts, proved.bounds, proved.data) if proved else None

    def at(self, t: npt.ArrayLike) -> States:
        """Return the states at times in s, of any shape and in any order, by the golden function; with their bounds.

        Raises:
            InputError: the solution has no golden function, or a time lies outside of its span.
        """
        if self.function is None:
            advice = "Solve it with level='enclosed', function=True, or write it and load it."
            raise InputError("at", "a solution without a golden function", "one with it", advice)
        return self.function.at(t)

    def __repr__(self) -> str:
        """Return scene, level, digits, and the numbers of rows and transits."""
        run, transits = self.scene.run, counted(len(self.directions), "transit")
        times = counted(len(self.times), "grid time")
        return f"Solution({self.scene.id}: {run.level}, {run.digits} digits, {times}, {transits})"


def grid_decimals(solution: Solution) -> dict[str, int]:
    """Return the digits after the point of each column of the grid: its largest number gets the digits asked for."""
    grid = solution.grid
    return decimals_of(resolved(grid.largest(), grid.largest_bounds()), solution.scene.run.digits)


def decimals_of_zeros(solution: Solution, word: str) -> dict[str, int]:
    """Return those of the zeros of a word; empty where there are none."""
    if word not in solution.zeros:
        return {}
    tables = {other: zeros.table for other, zeros in solution.zeros.items()}
    return zero_decimals(tables, word, grid_decimals(solution), solution.scene.run.digits)


def exact_decimals(values: tuple[Fraction, ...]) -> int:
    """Return the digits after the point that print terminating decimals exactly."""
    digits = 0
    for value in values:
        while (value * 10**digits).denominator != 1:
            digits += 1
    return digits


def tables_of(solution: Solution) -> list[tuple[Table, dict[str, int]]]:
    """Return the tables of grid, transits and sections, each with the digits after the point of its columns."""
    of_zeros = [
        (zeros.table, decimals_of_zeros(solution, word)) for word, zeros in solution.zeros.items()
    ]
    return [(solution.grid, grid_decimals(solution)), *of_zeros]


def separated(
    zeros: Sequence[Any], word: str, end: Fraction, table: Callable[[tuple[str, ...], Any], T]
) -> Zeros[T]:
    """Return what a proof found up to `end`: single zeros as a table of intervals, and what it left open.

    Zeros lie in (0, end], and the ball of a cluster may be a little wider.
    """
    single = [z for z in zeros if z.kind == "one"]
    undecided = [z for z in zeros if z.kind != "one"]
    possible = tuple((max(z.t.low, Fraction(0)), min(z.t.high, end), z.parity) for z in undecided)
    columns = columns_of(word)
    rows = tuple(tuple(getattr(z, name) for name in columns) for z in single)
    return Zeros(table(columns, rows), [z.direction for z in single], possible)


def check_decided(solution: Solution) -> None:
    """Raise `UndecidedRounding`, for the widest of them, where proven intervals do not decide a printed digit.

    What the scene itself gives of the release is exact, and rounded as it is.
    """
    (grid, decimals), *others = tables_of(solution)
    every = [grid.undecided(decimals, solution.scene.exact.released)]
    every += [table.undecided(places) for table, places in others]
    undecided = [number for number in every if number]
    if undecided:
        raise UndecidedRounding(*max(undecided))


class UndecidedRounding(UnreachableError):
    """A proven interval holds a number halfway between two printed ones: a finer enclosure is needed.

    Attributes:
        width: half-width of the widest of these intervals, in units of the last printed digit.
        column: the column that it stands in.
    """

    def __init__(self, width: Fraction, column: str, text: str) -> None:
        super().__init__(f"The enclosure of {column} = {text} does not decide its last digit.")
        self.width, self.column = width, column
