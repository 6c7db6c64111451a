"""TRUSTED. The files that are printed from a proof, read back exactly and held against its intervals.

So nothing that rounds or prints between a proof and its files has to be believed.
"""

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from .shapes import EnclosedTransit, Interval

GRID = "t,x,y,z,vx,vy,vz"
TRANSITS = "k,t,direction,x,y,z,vy,ax,bound"
DECIMAL = frozenset("-.0123456789")


class Misprint(ArithmeticError):
    """A printed number is not that of the proof."""


def check_grid(
    text: str, times: Iterable[Fraction], states: Iterable[list[Interval]], bounds: Mapping[str, str]
) -> None:
    """Raise Misprint unless grid.csv has the exact times, and each number is the nearest to all of its interval."""
    for (time, *row), t, state in zip(rows(text, GRID), times, states, strict=True):
        if Fraction(time) != t:
            raise Misprint(f"the time {time}")
        for name, number, x in zip(GRID.split(",")[1:], row, state, strict=True):
            check(number, x, bounds[name])


def check_transits(text: str, found: Iterable[EnclosedTransit], bounds: Mapping[str, str]) -> None:
    """Raise Misprint unless transits.csv has the single zeros, in order, each number nearest to all of its interval."""
    ones = [z for z in found if z.parity == "one"]
    for k, (row, z) in enumerate(zip(rows(text, TRANSITS), ones, strict=True), 1):
        cells: dict[str, Any] = dict(zip(TRANSITS.split(","), row, strict=True))
        if (int(cells.pop("k")), int(cells.pop("direction"))) != (k, z.direction):
            raise Misprint(f"transit {k}")
        check(cells.pop("t"), z.t, cells.pop("bound"))
        for name, number in cells.items():
            check(number, getattr(z, name), bounds[name])


def rows(text: str, header: str) -> list[list[str]]:
    """Return the cells of a file with this header."""
    first, *lines = text.splitlines()
    if first != header:
        raise Misprint(f"the header {first}")
    return [line.split(",") for line in lines]


def check(number: str, x: Interval, bound: str) -> None:
    """Raise Misprint unless a decimal is within half a unit of its last digit, and its bound, of all of an interval."""
    value, half = Fraction(number), Fraction(1, 2 * 10 ** len(number.partition(".")[2]))
    if set(number) - DECIMAL or not max(value - x.low, x.high - value) <= min(half, Fraction(bound)):
        raise Misprint(f"{number}, which is not what was proved")
