"""CSV tables of a dataset: decimals with a fixed number of digits per column, and their nearest doubles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from ..columns import GRID, TRANSITS
from ..precision import fixed_decimal, rounded_up
from ..scene import Scene
from ..solver.rounding import exact_decimals, grid_decimals, transit_decimals
from ..solver.solution import Solution

GRID_HEADER = ("t", *GRID)
TRANSITS_HEADER = ("k", "t", "direction", *TRANSITS[1:], "bound")
WORDS = frozenset({"k", "direction", "bound"})  # columns that are not decimals with a fixed number of digits


@dataclass(frozen=True)
class Sheet:
    """A printed table: header, rows of text, and digits after the point per column."""

    header: tuple[str, ...]
    rows: list[tuple[str, ...]]
    decimals: dict[str, int]

    def numbers(self, columns: tuple[str, ...]) -> Iterator[list[Fraction]]:
        """Yield, row by row, the printed numbers of some columns."""
        places = [self.header.index(name) for name in columns]
        for row in self.rows:
            yield [Fraction(row[i]) for i in places]

    def csv(self) -> str:
        """Return the text of the file: one header line, commas, LF."""
        return "".join(",".join(row) + "\n" for row in (self.header, *self.rows))


def grid_sheet(solution: Solution) -> Sheet:
    """Return `grid.csv`: exact times, and the state at each."""
    decimals = {"t": exact_decimals(solution.times), **grid_decimals(solution)}
    times = (fixed_decimal(t, decimals["t"]) for t in solution.times)
    printed = solution.grid.printed(decimals)
    return Sheet(GRID_HEADER, [(t, *row) for t, row in zip(times, printed, strict=True)], decimals)


def transits_sheet(solution: Solution) -> Sheet:
    """Return `transits.csv`: every zero of xdot; the bound on t includes the rounding of t to its digits."""
    table = solution.transits
    if table is None:
        return Sheet(TRANSITS_HEADER, [], {})
    decimals = transit_decimals(solution)
    half_unit = Fraction(1, 2 * 10 ** decimals["t"])
    printed, rows = table.printed(decimals), []
    for k, (row, error, direction) in enumerate(zip(printed, table.bound("t"), solution.directions, strict=True), 1):
        rows.append((str(k), row[0], f"{direction:+d}", *row[1:], rounded_up(error + half_unit)))
    return Sheet(TRANSITS_HEADER, rows, decimals)


def binary64_sheet(sheet: Sheet) -> Sheet:
    """Return a sheet with every number as the nearest double: 17 significant digits, then all again as hexfloats."""
    names = [name for name in sheet.header if name not in WORDS]
    rows = []
    for row in sheet.rows:
        doubles = [float(text) for name, text in zip(sheet.header, row, strict=True) if name in names]
        queue = iter(doubles)
        plain = (f"{next(queue):.16e}" if name in names else text for name, text in zip(sheet.header, row, strict=True))
        rows.append((*plain, *(value.hex() for value in doubles)))
    return Sheet((*sheet.header, *(f"{name}_hex" for name in names)), rows, {})


def grid_bound(solution: Solution, columns: tuple[str, ...]) -> str:
    """Return the largest bound of some columns of the grid as text, rounding to the printed digits included."""
    bounds, decimals = solution.grid.largest_bounds(), grid_decimals(solution)
    return rounded_up(max(bounds[name] + Fraction(1, 2 * 10 ** decimals[name]) for name in columns))


def scene_inputs(scene: Scene) -> dict[str, dict[str, str]]:
    """Return all inputs of a scene as strings, section by section."""
    document = scene.model_dump(exclude_none=True, include={"pendulum", "site", "release", "run"})
    return {
        section: {key: str(value).lower() if isinstance(value, bool) else str(value) for key, value in table.items()}
        for section, table in document.items()
    }
