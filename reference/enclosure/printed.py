"""TRUSTED. The files that are printed from a proof, read back exactly and held against its intervals.

So nothing that rounds or prints between a proof and its files has to be believed.
"""

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from .balls import demand
from .shapes import EnclosedTransit, Interval

GRID = "t,x,y,z,vx,vy,vz"
TRANSITS = "k,t,direction,x,y,z,vy,ax,bound"
DECIMAL = frozenset("+-.0123456789")
Bounds = Mapping[str, str]


def check_grid(text: str, times: Iterable[Fraction], states: Iterable[Sequence[Interval]], bounds: Bounds) -> None:
    """Demand that grid.csv has the exact times, and that each number is the nearest to all of its interval."""
    check_rows(text, GRID, ([t, *state] for t, state in zip(times, states, strict=True)), bounds)


def check_transits(text: str, found: Iterable[EnclosedTransit], bounds: Bounds) -> None:
    """Demand that transits.csv has the single zeros, in order, each number the nearest to all of its interval."""
    ones = enumerate((z for z in found if z.parity == "one"), 1)
    rows = ([k, z.t, z.direction, z.x, z.y, z.z, z.vy, z.ax] for k, z in ones)
    check_rows(text, TRANSITS, rows, bounds)


def check_rows(text: str, header: str, rows: Iterable[list[Any]], bounds: Bounds) -> None:
    """Demand that a file has these rows; what has no bound must be exact, and t has its row's, if any."""
    names, (first, *lines) = header.split(","), text.splitlines()
    demand(first == header, f"misprint: the header {first}")
    for line, row in zip(lines, rows, strict=True):
        cells = dict(zip(names, line.split(","), strict=True))
        of_row = {**bounds, "t": cells.get("bound", "0")}
        for name, x in zip(names, row, strict=False):
            check(cells[name], x if isinstance(x, Interval) else Interval(x, x), of_row.get(name, "0"))


def check(number: str, x: Interval, bound: str) -> None:
    """Demand that a decimal is within half a unit of its last digit, and its bound, of all of an interval."""
    value, most = Fraction(number), min(Fraction(bound), Fraction(1, 2 * 10 ** len(number.partition(".")[2])))
    demand(set(number) <= DECIMAL and max(value - x.low, x.high - value) <= most, f"misprint: {number}")
