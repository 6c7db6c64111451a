"""The columns of tables: their names, kinds and units, listed once.

CONTRIBUTING.md says what else one more column of `grid.csv` takes.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError, NotInstalledError, no_attribute
from .precision import Array

POSITION = ("x", "y", "z")
VELOCITY = ("vx", "vy", "vz")
STATE = POSITION + VELOCITY
RUN = (*STATE, "ax")  # an engine's results at each output time, and after t at each transit

GRID = STATE  # of grid.csv, after t
SECTION = ("t", *STATE)  # of sections.csv, beside section, number, direction and bound
_WHOLE = ("k", "direction")  # columns of whole numbers
TRANSITS = ("t", "x", "y", "z", "vy", "ax")  # of transits.csv, beside number, direction and bound

# of the columns of each kind
UNITS = {("t",): "s", POSITION: "m", VELOCITY: "m/s", ("ax",): "m/s^2"}
# the columns of a column's kind, which are alike in size
KINDS = {name: kind for kind in UNITS for name in kind}
# columns that are assumed to have the same errors
HORIZONTAL = {name: pair for pair in (("x", "y"), ("vx", "vy")) for name in pair}


def place_of(name: str, columns: tuple[str, ...]) -> int:
    """Return the place of a column.

    Raises:
        KeyError: there is no column of that name; it says which there are.
    """
    if name not in columns:
        raise KeyError(f"there is no column {name!r}; the columns are {', '.join(columns)}")
    return columns.index(name)


def data_frame(columns: Mapping[str, Any]) -> Any:
    """Return columns as a pandas.DataFrame.

    Raises:
        InputError: pandas is not installed.
    """
    try:
        from pandas import DataFrame
    except ImportError:
        raise NotInstalledError(
            "to_pandas", "a DataFrame", "pandas", "pip install pandas"
        ) from None
    return DataFrame(columns)


class Framed:
    """Columns that pandas can hold: a notebook shows them as a table where it is installed."""

    columns: Any
    array: Any

    def to_pandas(self) -> Any:
        """Return the columns as a pandas.DataFrame of the nearest doubles.

        Raises:
            InputError: pandas is not installed.
        """
        columns = {}
        for name in self.columns:
            column = self.array(name)
            columns[name] = column.astype(int) if name in _WHOLE else column
        return data_frame(columns)

    def _repr_html_(self) -> str | None:
        try:
            return str(self.to_pandas()._repr_html_())
        except InputError:
            return None


class GridColumns(Framed):
    """A solution or dataset with a table `grid` of a row per time, whose columns are attributes."""

    grid: Any
    times: Any

    @property
    def t(self) -> Array:
        """Grid times in s, shape (rows,)."""
        return np.array([float(t) for t in self.times])

    def __getitem__(self, column: str) -> Array:
        """Return a grid column, or the times, as the nearest doubles, shape (rows,)."""
        return self.t if column == "t" else np.asarray(self.grid[column])

    def exact(self, column: str) -> list[Fraction]:
        """Return the exact values of a grid column."""
        return list(self.times if column == "t" else self.grid.exact(column))

    def to_pandas(self) -> Any:
        """Return time and state as a pandas.DataFrame of the nearest doubles, in s, m and m/s.

        Raises:
            InputError: pandas is not installed.
        """
        return data_frame({"t": self.t, **{name: self.grid[name] for name in STATE}})

    if TYPE_CHECKING:
        x = y = z = vx = vy = vz = np.empty(0)
    else:  # not seen by mypy, so that it finds an unknown attribute

        def __getattr__(self, name: str) -> Array:
            """Return a grid column, shape (rows,)."""
            if name in GRID:
                return self.grid[name]
            public = [attribute for attribute in dir(self) if attribute[0] != "_"]
            raise no_attribute(f"a {type(self).__name__}", name, {*GRID, *public})
