"""Read a golden dataset: checked files, and their columns given as doubles, decimal strings or fractions."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ..numbers.precision import Array
from ..scenes.scene import Scene
from ..system.imports import no_attribute
from .files import read_files
from .manifest import Manifest
from .place import golden_folder
from .sheets import TRANSITS_HEADER, Sheet


class PrintedTable:
    """A CSV table of a dataset: columns of decimals, by name.

    Attributes:
        columns: their names, in order.
    """

    def __init__(self, sheet: Sheet, kind: Literal["grid", "transits"], manifest: Manifest) -> None:
        self.columns = sheet.header
        self._rows, self._kind, self._manifest = sheet.rows, kind, manifest

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self._rows)

    def __getitem__(self, name: str) -> Array:
        """Return a column as the nearest doubles, shape (rows,)."""
        return self.array(name)

    def array(self, name: str) -> Array:
        """Return a column as the nearest doubles, shape (rows,)."""
        return np.array([float(text) for text in self.decimals(name)], dtype=np.float64)

    def exact(self, name: str) -> list[Fraction]:
        """Return the exact values of the printed decimals of a column."""
        return [Fraction(text) for text in self.decimals(name)]

    def bound(self, name: str) -> list[Fraction]:
        """Return bounds on the errors of a column's printed values: a transit time's own, else the column's largest."""
        if name == "t":
            return self.exact("bound") if "bound" in self.columns else [Fraction(0)] * len(self)
        bounds = getattr(self._manifest.bounds, self._kind)
        if name not in bounds:
            raise KeyError(f"a dataset bounds t, {', '.join(bounds)}, not {name!r}")
        return [Fraction(bounds[name])] * len(self)

    def decimals(self, name: str) -> list[str]:
        """Return a column as printed."""
        if name not in self.columns:
            raise KeyError(f"{name!r} is no column; there are {', '.join(self.columns)}")
        i = self.columns.index(name)
        return [row[i] for row in self._rows]


@dataclass(frozen=True, repr=False)
class Golden:
    """A golden dataset, as read from disk: the same columns as a `Solution`, as printed.

    `golden.t`, `.x`, … are the grid as binary64 arrays of shape (rows,); both tables have `table["x"]`, the same,
    `table.exact("x")` as fractions, `table.bound("x")`, and `table.decimals("x")`, the printed texts.

    Attributes:
        path: the folder.
        manifest: its manifest.json.
        scene: the scene that it solves.
        grid: `grid.csv`.
        transits: `transits.csv`; without rows if they were not asked for, or if xdot is identically zero.
    """

    path: Path
    manifest: Manifest
    scene: Scene
    grid: PrintedTable
    transits: PrintedTable

    @property
    def times(self) -> tuple[Fraction, ...]:
        """Grid times in s, exact."""
        return tuple(self.grid.exact("t"))

    @property
    def directions(self) -> list[int]:
        """+1 where xdot goes from - to +, per transit."""
        return [int(text) for text in self.transits.decimals("direction")]

    def decimals(self, column: str) -> list[str]:
        """Return a grid column as printed."""
        return self.grid.decimals(column)

    def exact(self, column: str) -> list[Fraction]:
        """Return the exact values of the printed decimals of a grid column."""
        return self.grid.exact(column)

    def __getattr__(self, name: str) -> Any:
        """Return a grid column as the nearest doubles, shape (rows,)."""
        if not name.startswith("_") and name in self.grid.columns:
            return self.grid[name]
        raise no_attribute("a Golden", name, () if name.startswith("_") else {*self.grid.columns, *_NAMES})

    def __repr__(self) -> str:
        """Return id, level, digits, and the numbers of rows and transits."""
        about, counts = self.manifest, self.manifest.counts
        rows = f"{counts.grid} grid times, {counts.transits} transits"
        return f"Golden({about.id}: {about.level}, {about.digits} digits, {rows})"


_NAMES = ("path", "manifest", "grid", "transits", "scene", "times", "directions", "decimals", "exact")


def load(name: str | Path) -> Golden:
    """Read a golden dataset by id or path, after checking its seal, its hashes and the form of every file.

    Raises:
        InputError: there is no such dataset.
        DatasetError: a file is missing, changed or malformed, or the manifest breaks its schema or its seal.
    """
    files = read_files(golden_folder(name))
    sheets = files.tables["grid.csv"], files.tables.get("transits.csv", Sheet(TRANSITS_HEADER, [], {}))
    kinds: tuple[Literal["grid", "transits"], ...] = ("grid", "transits")
    tables = (PrintedTable(sheet, kind, files.manifest) for sheet, kind in zip(sheets, kinds, strict=True))
    return Golden(files.folder, files.manifest, files.scene, *tables)
