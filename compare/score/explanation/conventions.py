"""Conventions of a file: digits, heights, axes and clock, put right one after the other.

Each stage changes the rows alone, and gives them back as a right program would write them. Axes that a program uses
from its release on are no matter of the rows: they stand among the `causes`.
"""

from __future__ import annotations

import numpy as np

from reference.numbers.precision import Array

from .axes import axes
from .clock import clock, shifted, unit_of_time
from .heights import heights
from .printed import digits
from .rows import Rows


def made_right(
    times: Array, columns: dict[str, Array], release: Array, length: float, frequency: float, rename: bool = True
) -> Rows:
    """Return the rows in the scene's conventions.

    Args:
        times: as in the file.
        columns: x, y and perhaps z as in the file.
        release: x, y, z, vx, vy, vz of the exact release in m and m/s.
        length: of the cord in m.
        frequency: of the scene's swing in rad/s.
        rename: whether the horizontal axes may have each other's names, or point the other way.
    """
    names = [name for name in "xyz" if name in columns]
    positions = np.column_stack([columns[name] for name in names])
    noise, found = digits(positions)
    rows = Rows(times, positions, noise, tuple(found))
    rows = heights(rows, length)
    rows = axes(rows, release, length, rename)
    rows = clock(rows, release)
    rows = unit_of_time(rows, frequency)
    return rows if rows.starts else shifted(rows, release, frequency, length)
