"""The decimals of a solution's printed columns, and whether a proof decides every digit."""

from __future__ import annotations

from fractions import Fraction

from ..errors import UnreachableError
from ..numbers.table import Table, decimals_of, resolved
from .solution import Solution


def grid_decimals(solution: Solution) -> dict[str, int]:
    """Return the digits after the point of each column of the grid: its largest number gets the digits asked for."""
    grid = solution.grid
    return decimals_of(resolved(grid.largest(), grid.largest_bounds()), solution.scene.run.digits)


def transit_decimals(solution: Solution) -> dict[str, int]:
    """Return those of the transits, empty without any table: as in the grid, and t and ax by their own size."""
    if solution.transits is None:
        return {}
    return {**decimals_of(solution.transits.largest(), solution.scene.run.digits)} | {
        name: places for name, places in grid_decimals(solution).items() if name in solution.transits.columns
    }


def exact_decimals(values: tuple[Fraction, ...]) -> int:
    """Return the digits after the point that print terminating decimals exactly."""
    digits = 0
    for value in values:
        while (value * 10**digits).denominator != 1:
            digits += 1
    return digits


def check_decided(solution: Solution) -> None:
    """Raise `UndecidedRounding`, for the widest of them, where proven intervals do not decide a printed digit."""
    tables: list[tuple[Table, dict[str, int]]] = [(solution.grid, grid_decimals(solution))]
    if solution.transits is not None:
        tables.append((solution.transits, transit_decimals(solution)))
    undecided = [number for table, decimals in tables if (number := table.undecided(decimals)) is not None]
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
