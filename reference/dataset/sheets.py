"""CSV files of a dataset: its tables rounded to their decimals, and the nearest doubles."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Any

from ..numbers.columns import GRID, STATE, TRANSITS
from ..numbers.precision import endpoint_text, fixed_decimal, rounded_up
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
    """A printed table.

    Attributes:
        header: the names of the columns.
        rows: the cells of each row as text.
        decimals: the number of digits after the point, by column.
    """

    header: tuple[str, ...]
    rows: list[tuple[str, ...]]
    decimals: dict[str, int]

    def numbers(self, columns: tuple[str, ...]) -> Iterator[list[Fraction]]:
        """Yield, row by row, the printed numbers of some columns."""
        indices = [self.header.index(name) for name in columns]
        for row in self.rows:
            yield [Fraction(Decimal(row[i])) for i in indices]

    def scaled_integers(self, columns: tuple[str, ...]) -> tuple[list[Integers], int]:
        """Return some columns times a common power of ten, as integers, and that power of ten."""
        texts_by_column = []
        decimals = 0
        for name in columns:
            index = self.header.index(name)
            texts = [row[index] for row in self.rows]
            decimals = max([decimals, *map(_decimals_in, texts)])
            texts_by_column.append(texts)

        scaled = []
        for texts in texts_by_column:
            scaled.append(integers(_scaled(text, decimals) for text in texts))
        return scaled, 10**decimals

    def csv(self) -> str:
        """Return the text of the file: one header line, commas, LF."""
        return "".join(",".join(row) + "\n" for row in (self.header, *self.rows))


def _decimals_in(text: str) -> int:
    """Return the number of digits after the point of a decimal."""
    return len(text.partition(".")[2])


def _scaled(text: str, decimals: int) -> int:
    """Return a decimal times 10**decimals, which is an integer."""
    whole, _, fraction = text.partition(".")
    factor: int = 10 ** (decimals - len(fraction))
    return int(whole + fraction) * factor


def grid_sheet(solution: Solution) -> Sheet:
    """Return `grid.csv`: exact times, and the state at each.

    The row of the release has the scene's own numbers.
    """
    decimals = {"t": exact_decimals(solution.times), **grid_decimals(solution)}
    first, *later = solution.grid.printed(decimals)
    release = dict(zip(GRID, first, strict=True))
    for name, value in solution.scene.exact.released.items():
        release[name] = fixed_decimal(value, decimals[name])

    states = [tuple(release.values()), *later]
    rows = [
        (fixed_decimal(t, decimals["t"]), *state)
        for t, state in zip(solution.times, states, strict=True)
    ]
    return Sheet(GRID_HEADER, rows, decimals)


def transits_sheet(solution: Solution) -> Sheet:
    """Return `transits.csv`: every zero of xdot; the bound on t includes the rounding of t."""
    decimals = decimals_of_zeros(solution, XDOT)
    rows = _zeros(solution.zeros[XDOT], decimals) if XDOT in solution.zeros else []
    return Sheet(TRANSITS_HEADER, rows, decimals)


def sections_sheet(solution: Solution) -> Sheet:
    """Return `sections.csv`: every passage of each section, in the order in which the scene lists the sections."""
    rows = list[tuple[str, ...]]()
    for word, passages in solution.sections.items():
        decimals = decimals_of_zeros(solution, word)  # the same for every section
        rows += [(word, *row) for row in _zeros(passages, decimals)]
    return Sheet(SECTIONS_HEADER, rows, decimals)


def _zeros(zeros: Zeros[Table], decimals: Mapping[str, int]) -> list[tuple[str, ...]]:
    """Return the rows of zeros: number, time, direction, other columns, bound on the time."""
    half_unit = Fraction(1, 2 * 10 ** decimals["t"])
    rows = zip(zeros.table.printed(decimals), zeros.table.bound("t"), zeros.directions, strict=True)
    return [
        (str(k), row[0], f"{direction:+d}", *row[1:], rounded_up(error + half_unit))
        for k, (row, error, direction) in enumerate(rows, 1)
    ]


def binary64_sheet(sheet: Sheet, doubles: Mapping[str, Sequence[float]]) -> Sheet:
    """Return a sheet whose numbers are replaced by doubles, given by column.

    Doubles have 17 significant digits, and are repeated as hexfloats after the last column.
    """
    columns = [doubles.get(name) for name in sheet.header]
    rows = []
    for i, row in enumerate(sheet.rows):
        cells = []
        hexfloats = []
        for text, column in zip(row, columns, strict=True):
            if column is None:
                cells.append(text)
            else:
                number = float(column[i])
                cells.append(f"{number:.16e}")
                hexfloats.append(number.hex())
        rows.append((*cells, *hexfloats))
    hex_header = [f"{name}_hex" for name in sheet.header if name in doubles]
    return Sheet((*sheet.header, *hex_header), rows, {})


def nearest_doubles(table: Table, sheet: Sheet) -> dict[str, list[float]]:
    """Return the doubles nearest to the numbers of a table, by column.

    The table has more digits than the sheet prints. A number smaller than its error bound is noise
    about zero, and gets the double of the printed decimal.
    """
    unit = 1 << table.bits
    doubles = {}
    for i, name in enumerate(table.columns):
        index = sheet.header.index(name)
        column = []
        for value, error, row in zip(table.values, table.errors, sheet.rows, strict=True):
            is_noise = abs(value[i]) <= error[i]
            column.append(float(Fraction(row[index])) if is_noise else value[i] / unit)
        doubles[name] = column
    return doubles


def column_bounds(table: Table, decimals: Mapping[str, int]) -> dict[str, str]:
    """Return the largest bound of each column as text, with the rounding to the printed digits."""
    bounds = table.largest_bounds()
    texts = {}
    for name in table.columns:
        half_unit = Fraction(1, 2 * 10 ** decimals[name])
        texts[name] = rounded_up(bounds[name] + half_unit)
    return texts


def open_intervals(intervals: Iterable[tuple[Fraction, Fraction, str]]) -> list[dict[str, str]]:
    """Return intervals that may hold further zeros as text, rounded outwards, with their parity."""
    return [
        {"from_s": endpoint_text(low, -1), "to_s": endpoint_text(high, 1), "parity": parity}
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
    inputs = {}
    for section, table in document.items():
        inputs[section] = {key: _input_text(value) for key, value in table.items()}
    return inputs


def _input_text(value: Any) -> str:
    """Return a field of a scene as text, as `--set` takes it."""
    if isinstance(value, tuple):
        return SECTION_SEPARATOR.join(value)
    if isinstance(value, bool):
        return str(value).lower()
    return str(value)
