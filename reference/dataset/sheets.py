"""CSV files of a dataset: its tables rounded to their decimals, and the nearest doubles."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

from ..numbers.columns import GRID, STATE, TRANSITS
from ..numbers.precision import fixed_decimal, outward, rounded_up
from ..numbers.table import Integers, Table, integers
from ..numbers.zeros import XDOT, Zeros
from ..scenes.fields import SECTION_SEPARATOR
from ..scenes.scene import Scene
from ..solver.solution import Solution, decimals_of_zeros, exact_decimals, grid_decimals

GRID_HEADER = ("t", *GRID)
TRANSITS_HEADER = ("k", "t", "direction", *TRANSITS[1:], "bound")
SECTIONS_HEADER = ("section", "k", "t", "direction", *STATE, "bound")
# the decimals with a fixed number of digits, also doubles
NUMBERS = {"grid": ("t", *GRID), "transits": TRANSITS}


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
            yield [Fraction(Decimal(row[i])) for i in places]

    def integers(self, columns: tuple[str, ...]) -> tuple[list[Integers], int]:
        """Return some columns of decimals as integers over a common unit, and the unit, a power of ten."""
        places = [self.header.index(name) for name in columns]
        parted = [[row[i].partition(".") for row in self.rows] for i in places]
        decimals = max((len(part) for column in parted for _, _, part in column), default=0)
        scaled = (
            (int(whole + part) * 10 ** (decimals - len(part)) for whole, _, part in column)
            for column in parted
        )
        return [integers(column) for column in scaled], 10**decimals

    def csv(self) -> str:
        """Return the text of the file: one header line, commas, LF."""
        return "".join(",".join(row) + "\n" for row in (self.header, *self.rows))


def grid_sheet(solution: Solution) -> Sheet:
    """Return `grid.csv`: exact times, and the state at each; of the release what the scene gives, as it is."""
    decimals = {"t": exact_decimals(solution.times), **grid_decimals(solution)}
    times = (fixed_decimal(t, decimals["t"]) for t in solution.times)
    first, *later = solution.grid.printed(decimals)
    given = {
        name: fixed_decimal(value, decimals[name])
        for name, value in solution.scene.exact.released.items()
    }
    release = tuple(given.get(name, text) for name, text in zip(GRID, first, strict=True))
    printed = [release, *later]
    return Sheet(GRID_HEADER, [(t, *row) for t, row in zip(times, printed, strict=True)], decimals)


def transits_sheet(solution: Solution) -> Sheet:
    """Return `transits.csv`: every zero of xdot; the bound on t includes the rounding of t to its digits."""
    decimals = decimals_of_zeros(solution, XDOT)
    rows = _zeros(solution.zeros[XDOT], decimals) if XDOT in solution.zeros else []
    return Sheet(TRANSITS_HEADER, rows, decimals)


def sections_sheet(solution: Solution) -> Sheet:
    """Return `sections.csv`: every passage of each section, in the order of the scene's words."""
    rows = list[tuple[str, ...]]()
    for word, passages in solution.sections.items():
        decimals = decimals_of_zeros(solution, word)  # the same for every section
        rows += [(word, *row) for row in _zeros(passages, decimals)]
    return Sheet(SECTIONS_HEADER, rows, decimals)


def _zeros(zeros: Zeros[Table], decimals: Mapping[str, int]) -> list[tuple[str, ...]]:
    """Return the rows of zeros: number, time, direction, the other columns, and the bound on the time."""
    half_unit = Fraction(1, 2 * 10 ** decimals["t"])
    rows = zip(zeros.table.printed(decimals), zeros.table.bound("t"), zeros.directions, strict=True)
    return [
        (str(k), row[0], f"{direction:+d}", *row[1:], rounded_up(error + half_unit))
        for k, (row, error, direction) in enumerate(rows, 1)
    ]


def binary64_sheet(sheet: Sheet, doubles: Mapping[str, Sequence[float]]) -> Sheet:
    """Return a sheet with doubles for its numbers, by column: 17 significant digits, then all again as hexfloats."""
    columns = [doubles.get(name) for name in sheet.header]
    rows = []
    for i, row in enumerate(sheet.rows):
        numbers = [None if column is None else float(column[i]) for column in columns]
        plain = (
            text if number is None else f"{number:.16e}"
            for text, number in zip(row, numbers, strict=True)
        )
        rows.append((*plain, *(number.hex() for number in numbers if number is not None)))
    return Sheet(
        (*sheet.header, *(f"{name}_hex" for name in sheet.header if name in doubles)), rows, {}
    )


def nearest_doubles(table: Table, sheet: Sheet) -> dict[str, list[float]]:
    """Return the doubles nearest to the numbers of a table, which are known to more digits than its sheet prints.

    A number smaller than its error bound is noise about zero, and gets the double of the printed decimal.
    """
    unit, doubles = 1 << table.bits, {}
    for i, name in enumerate(table.columns):
        place, column = sheet.header.index(name), []
        for value, error, row in zip(table.values, table.errors, sheet.rows, strict=True):
            is_noise = abs(value[i]) <= error[i]
            column.append(float(Fraction(row[place])) if is_noise else value[i] / unit)
        doubles[name] = column
    return doubles


def column_bounds(table: Table, decimals: Mapping[str, int]) -> dict[str, str]:
    """Return the largest bound of each column as text, rounding to the printed digits included."""
    bounds = table.largest_bounds()
    return {
        name: rounded_up(bounds[name] + Fraction(1, 2 * 10 ** decimals[name]))
        for name in table.columns
    }


def open_intervals(intervals: Iterable[tuple[Fraction, Fraction, str]]) -> list[dict[str, str]]:
    """Return intervals that may hold other zeros as text, rounded outwards, each with the parity of their number."""
    return [
        {"from_s": outward(low, -1), "to_s": outward(high, 1), "parity": parity}
        for low, high, parity in intervals
    ]


def by_field(inputs: Mapping[str, Mapping[str, str]]) -> dict[str, str]:
    """Return the inputs of a scene, given section by section, by names such as site.latitude."""
    return {
        f"{section}.{key}": value
        for section, table in inputs.items()
        for key, value in table.items()
    }


def scene_inputs(scene: Scene) -> dict[str, dict[str, str]]:
    """Return all inputs of a scene as strings, section by section."""
    document = scene.model_dump(exclude_none=True, include={"pendulum", "site", "release", "run"})

    def text(value: Any) -> str:
        if isinstance(value, tuple):
            return SECTION_SEPARATOR.join(value)
        return str(value).lower() if isinstance(value, bool) else str(value)

    return {
        section: {key: text(value) for key, value in table.items()}
        for section, table in document.items()
    }
