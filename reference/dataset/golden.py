"""A golden dataset as read: its columns as doubles, texts or fractions, and states at times between its rows."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import DatasetError, Described, InputError, counted
from ..numbers.columns import POSITION, STATE, Framed, GridColumns, place_of
from ..numbers.function import GoldenFunction, States, moments_of
from ..numbers.precision import Array
from ..scenes.fields import Level
from ..scenes.scene import Scene
from .files import DatasetFiles, read_files
from .function import evaluated_grid, evaluated_transits
from .manifest import FUNCTION, Manifest
from .place import golden_folder
from .sheets import TRANSITS_HEADER, Sheet

WITHIN = 2.0**-58  # error allowed, relative to the cord length: enough to judge programs in double
_ROUNDED = 2.0**-40  # relative, of the times that a program has added up
_PAIR = Fraction(1, 1 << 104)  # relative resolution of a number held as two doubles


@dataclass(frozen=True, repr=False)
class PrintedTable(Framed):
    """A CSV table of a dataset: columns of decimals by name, and the largest error bound of each."""

    _sheet: Sheet
    _bounds: Mapping[str, str]

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns, in order."""
        return self._sheet.header

    def __repr__(self) -> str:
        """Return the names of the columns and the number of rows."""
        return f"PrintedTable({', '.join(self.columns)}; rows: {len(self)})"

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self._sheet.rows)

    def __getitem__(self, name: str) -> Array:
        """Return a column as the nearest doubles, shape (rows,)."""
        return np.array([float(text) for text in self.decimals(name)], dtype=np.float64)

    array = __getitem__

    def exact(self, name: str) -> list[Fraction]:
        """Return the exact values of the printed decimals of a column."""
        # faster than a fraction of the text
        return [Fraction(Decimal(text)) for text in self.decimals(name)]

    def bound(self, name: str) -> list[Fraction]:
        """Return bounds on the errors of a column's printed values: proven at the level enclosed, otherwise estimated.

        A transit time has a bound of its own; for other columns it is the largest of all rows.
        """
        if name == "t":
            return self.exact("bound") if "bound" in self.columns else [Fraction(0)] * len(self)
        # a table without rows has no bounds
        bounded = self._bounds if len(self) else self.columns
        if name not in bounded:
            raise KeyError(
                f"there is no bound for {name!r}; there are bounds for {', '.join(['t', *self._bounds])}"
            )
        return [Fraction(self._bounds[name])] * len(self) if len(self) else []

    def decimals(self, name: str) -> list[str]:
        """Return a column as printed."""
        i = place_of(name, self.columns)
        return [row[i] for row in self._sheet.rows]


@dataclass(frozen=True, repr=False)
class Golden(GridColumns):
    """A golden dataset, as read from disk: the same columns as a `Solution`, as printed.

    `golden.t`, `.x`, … are the columns of the grid as binary64 arrays of shape (rows,). Of both
    tables, `table["x"]` is such an array, `table.exact("x")` are fractions, `table.bound("x")`
    are bounds on the errors (proven at the level enclosed, otherwise estimated), and
    `table.decimals("x")` are the printed texts.

    Attributes:
        path: the folder.
        manifest: its manifest.json.
        scene: the scene that it solves.
        grid: `grid.csv`.
        transits: `transits.csv`; without rows if they were not asked for, or if xdot is identically
            zero.
        function: the golden function, or None; `at` works without it too.
        sections: the rows of `sections.csv` for each section of the scene, by its word; empty if the
            dataset has only a function.
    """

    path: Path
    manifest: Manifest
    scene: Scene
    grid: PrintedTable
    transits: PrintedTable
    function: GoldenFunction | None = None
    sections: Mapping[str, PrintedTable] = field(default_factory=dict)

    def at(self, t: npt.ArrayLike) -> States:
        """Return the states at times in s (any shape, any order), with bounds on their errors.

        They come from the golden function, or the scene is solved again (needs heyoka, takes
        longer) and its numbers are rounded to doubles.

        Raises:
            InputError: a time is not finite, or outside of the dataset's span.
        """
        if self.function is not None:
            return self.function.at(t)
        moments = moments_of(t, self.times[-1])
        if not moments.size:
            return States.of(moments, np.empty((6, 0)), {})
        trajectory = dense(self, moments)
        rows = trajectory.states[np.searchsorted(trajectory.t, moments.ravel())]
        rounding = np.spacing(np.abs(trajectory.states).max(axis=0)).tolist()
        bounds = {}
        for name, ulp in zip(STATE, rounding, strict=True):
            bound = trajectory.bound_m if name in POSITION else trajectory.bound_m_s
            bounds[name] = bound + ulp
        return States.of(moments, rows.T, bounds)

    @property
    def level(self) -> Level:
        """Level of trust in the numbers, one of `scene.LEVELS`."""
        return self.manifest.level

    @cached_property
    def times(self) -> tuple[Fraction, ...]:
        """Grid times in s, exact."""
        return tuple(self.grid.exact("t"))

    @property
    def directions(self) -> list[int]:
        """For each transit, +1 if xdot goes from - to +, and -1 otherwise."""
        return [int(text) for text in self.transits.decimals("direction")]

    def decimals(self, column: str) -> list[str]:
        """Return a grid column as printed."""
        return self.grid.decimals(column)

    def __repr__(self) -> str:
        """Return id, level, digits, and the numbers of rows and transits."""
        manifest = self.manifest
        times = counted(manifest.counts.grid, "grid time")
        transits = counted(manifest.counts.transits, "transit")
        accuracy = f"{manifest.level}, {manifest.digits} digits"
        return f"Golden({manifest.id}: {accuracy}, {times}, {transits})"


def load(name: str | Path) -> Golden:
    """Read a golden dataset by id or path; check its seal, its hashes and the form of every file.

    Raises:
        InputError: there is no such dataset.
        DatasetError: a file is missing, changed or malformed, or the manifest breaks its schema or
            its seal.
    """
    files = read_files(golden_folder(name))
    function = files.function[1] if files.function else None
    if function is not None and files.manifest.alone:
        grid, transits = _evaluated_tables(files, function)
    else:
        grid, transits = _printed_tables(files)
    return Golden(
        files.folder, files.manifest, files.scene, grid, transits, function, _sections(files)
    )


def _printed_tables(files: DatasetFiles) -> tuple[PrintedTable, PrintedTable]:
    """Return grid and transits as printed."""
    bounds = files.manifest.bounds
    without_transits = Sheet(TRANSITS_HEADER, [], {})
    transits = files.tables.get("transits.csv", without_transits)
    return (
        PrintedTable(files.tables["grid.csv"], bounds.grid),
        PrintedTable(transits, bounds.transits),
    )


def _evaluated_tables(
    files: DatasetFiles, function: GoldenFunction
) -> tuple[PrintedTable, PrintedTable]:
    """Return grid and transits of a dataset without tables, evaluated in doubles.

    Raises:
        DatasetError: the function does not have the transits that the manifest counts.
    """
    grid = evaluated_grid(function, files.scene)
    try:
        transits = evaluated_transits(function, files.scene, files.manifest)
    except ValueError as error:
        raise DatasetError(str(files.folder), [f"{FUNCTION[0]}: {error}"]) from None
    return PrintedTable(grid.sheet, grid.bounds), PrintedTable(transits.sheet, transits.bounds)


class _Sections(dict[str, PrintedTable]):
    """The passages of each section, by its word; a word that is not there is refused."""

    def __missing__(self, word: str) -> PrintedTable:
        expected = f"a section in sections.csv ({', '.join(self) or 'it has none'})"
        advice = "reference.solve(golden.scene, sections=…) finds the passages of others."
        raise InputError("sections", word, expected, advice)


def _sections(files: DatasetFiles) -> _Sections:
    """Return the rows of `sections.csv` of each section that the manifest counts."""
    sections = _Sections()
    sheet = files.tables.get("sections.csv")
    record = files.manifest.sections
    if sheet is None or record is None:
        return sections
    for word in record.counts:
        rows = [row[1:] for row in sheet.rows if row[0] == word]
        sections[word] = PrintedTable(Sheet(sheet.header[1:], rows, {}), record.bounds)
    return sections


@dataclass(frozen=True)
class Dense:
    """A trajectory at chosen times, more accurate than binary64.

    Attributes:
        t: times in s, shape (rows,), increasing, without repeats.
        states: nearest doubles of x, y, z (m), vx, vy, vz (m/s), shape (rows, 6).
        low: low parts, shape (rows, 6): the values are states + low.
        bound_m: bound on the error of every position, in m.
        bound_m_s: bound on that of every velocity, in m/s.
    """

    t: Array
    states: Array = field(repr=False)
    low: Array = field(repr=False)
    bound_m: float
    bound_m_s: float

    @classmethod
    def of(cls, times: Array, table: Any, rows: Any) -> Dense:
        """Return the trajectory in some rows of a table with bounds."""
        doubles = []
        remainders = []
        bounds = []
        for name in STATE:
            exact = table.exact(name)
            pairs = [_as_pair(exact[i]) for i in rows]
            high = [double for double, _ in pairs]
            doubles.append(high)
            remainders.append([remainder for _, remainder in pairs])
            size = Fraction(max(map(abs, high)))
            bounds.append(max(table.bound(name)) + _PAIR * size)
        bound_m = float(max(bounds[:3]))
        bound_m_s = float(max(bounds[3:]))
        return cls(times, np.array(doubles).T, np.array(remainders).T, bound_m, bound_m_s)


def _as_pair(value: Fraction) -> tuple[float, float]:
    """Return the nearest double, and the double nearest to what it leaves over.

    In integers, which is faster than in fractions.
    """
    p, q = value.as_integer_ratio()
    double = p / q
    n, d = double.as_integer_ratio()
    return double, (p * d - n * q) / (q * d)


def dense(golden: Golden, times: npt.ArrayLike, within: float = WITHIN) -> Dense:
    """Return the states of a golden dataset's solution at any times in its span.

    Args:
        golden: the dataset: its rows are taken where all times are those of its grid.
        times: in s, in any order; repeated ones are merged.
        within: error aimed at, relative to the cord length; the bound that was reached is
            `bound_m`.

    Raises:
        InputError: there is no time, or one is not finite, negative, or more than a grid step
            beyond the dataset's end.
        UnreachableError: the scene cannot be solved so closely.
    """
    grid = golden.times
    # a program that counts steps may end with one more
    later = float(grid[-1] - grid[-2]) + _ROUNDED * float(grid[-1])
    requested = np.unique(moments_of(times, grid[-1], later))
    if not requested.size:
        raise InputError("t", Described("no times"), "at least one time in s")
    exact_times = [Fraction(t) for t in requested.tolist()]
    row = {t: i for i, t in enumerate(grid)}
    if row.keys() >= set(exact_times):
        return Dense.of(requested, golden.grid, [row[t] for t in exact_times])
    from ..solver.solve import solve_at

    digits = math.ceil(-math.log10(within)) + 1
    solution = solve_at(golden.scene, exact_times, digits)
    row = {t: i for i, t in enumerate(solution.times)}
    return Dense.of(requested, solution.grid, [row[t] for t in exact_times])
