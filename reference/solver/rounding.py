"""Rounding to printed digits: the decimals of every column, and whether a proof decides each digit."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from ..errors import UnreachableError
from ..precision import decimals_for, with_decimal_point
from ..table import Table
from .solution import Solution

NOISE = 8  # a column whose largest number is within this many times its error is taken for zero


def grid_decimals(largest: Sequence[Fraction], errors: Sequence[Fraction], digits: int) -> list[int]:
    """Return the digits after the point of x, y, z, vx, vy, vz, from each column's largest number and error.

    The largest number of a column gets `digits` significant digits (`precision.decimals_for`). A column that is nothing
    but error takes the digits of the largest column of its kind: a coordinate that vanishes by symmetry comes out of a
    run as rounding noise, and noise has no significant digits.
    """
    resolved = [size if size > NOISE * error else Fraction(0) for size, error in zip(largest, errors, strict=True)]
    of_kind = [max(resolved[:3])] * 3 + [max(resolved[3:])] * 3
    return [decimals_for(size or kind, digits) for size, kind in zip(resolved, of_kind, strict=True)]


def transit_decimals(of_grid: Sequence[int], t: Fraction, ax: Fraction, digits: int) -> list[int]:
    """Return the digits after the point of t, x, y, z, vy, ax: states as in the grid, t and ax by their own size."""
    x, y, z, _, vy, _ = of_grid
    return [decimals_for(t, digits), x, y, z, vy, decimals_for(ax, digits)]


def exact_decimals(values: tuple[Fraction, ...]) -> int:
    """Return the digits after the point that print terminating decimals exactly."""
    digits = 0
    for value in values:
        while (value * 10**digits).denominator != 1:
            digits += 1
    return digits


def decimals_of(solution: Solution) -> tuple[dict[str, int], dict[str, int]]:
    """Return the digits after the point of the columns of the grid and of the transits (empty without transits)."""
    grid, transits, digits = solution.grid, solution.transits, solution.scene.run.digits
    of_grid = grid_decimals(grid.largest(), grid.largest_bounds(), digits)
    named = dict(zip(grid.columns, of_grid, strict=True))
    if transits is None:
        return named, {}
    t, *_, ax = transits.largest()
    return named, dict(zip(transits.columns, transit_decimals(of_grid, t, ax, digits), strict=True))


def printed_grid(solution: Solution) -> list[tuple[str, ...]]:
    """Return the rows of the grid, without their times, as text.

    Raises:
        UndecidedRounding: a proven interval does not decide a digit.
    """
    return _printed(solution.grid, decimals_of(solution)[0], solution.level == "enclosed")


def printed_transits(solution: Solution) -> list[tuple[str, ...]]:
    """Return the rows of the transits as text, without number, direction and bound; raise as `printed_grid`."""
    if solution.transits is None:
        return []
    return _printed(solution.transits, decimals_of(solution)[1], solution.level == "enclosed")


def check_decided(solution: Solution) -> None:
    """Raise `UndecidedRounding` where a proven interval does not decide a printed digit."""
    printed_grid(solution)
    printed_transits(solution)


def _printed(table: Table, decimals: dict[str, int], proven: bool) -> list[tuple[str, ...]]:
    """Round every number to its column's digits; if it is proven, both ends of its interval must round alike."""
    units = [10 ** decimals[name] for name in table.columns]
    rows = []
    for values, errors in zip(table.values, table.errors, strict=True):
        whole = [_nearest(value * unit, table.bits) for value, unit in zip(values, units, strict=True)]
        texts = tuple(with_decimal_point(n, decimals[name]) for n, name in zip(whole, table.columns, strict=True))
        if proven:
            for n, value, error, unit, name, text in zip(
                whole, values, errors, units, table.columns, texts, strict=True
            ):
                low, high = (_nearest((value + side * error) * unit, table.bits) for side in (-1, 1))
                if not low == n == high:
                    raise UndecidedRounding(name, text)
        rows.append(texts)
    return rows


def _nearest(value: int, bits: int) -> int:
    """Return the integer nearest to value / 2**bits (ties upwards)."""
    return (value + (1 << bits >> 1)) >> bits


class UndecidedRounding(UnreachableError):
    """A proven interval holds a number halfway between two printed ones: a finer enclosure is needed."""

    def __init__(self, column: str, text: str) -> None:
        super().__init__(f"The enclosure of {column} = {text} does not decide its last digit.")
