"""Read a golden dataset: hashes and schema are checked, columns given as doubles, decimal strings or fractions."""

from __future__ import annotations

import csv
import hashlib
import json
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from ..columns import POSITION, VELOCITY
from ..errors import DatasetError, InputError
from ..lazy import no_attribute
from ..precision import Array
from ..scene import Scene, is_scene_id, parse_scene
from ..shipped import data_root
from .manifest import Bounds, Manifest

MANIFEST = "manifest.json"


class PrintedTable:
    """A CSV table of a dataset: columns of decimals, by name.

    Attributes:
        columns: their names, in order.
    """

    def __init__(self, texts: dict[str, list[str]], bounds: Bounds) -> None:
        self.columns = tuple(texts)
        self._texts, self._bounds = texts, bounds

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.decimals(self.columns[0]))

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
        """Return bounds on the errors of a column's printed values: of positions and velocities the manifest's own."""
        if name == "t":
            return self.exact("bound") if "bound" in self.columns else [Fraction(0)] * len(self)
        kinds = dict.fromkeys(POSITION, self._bounds.position_m) | dict.fromkeys(VELOCITY, self._bounds.velocity_m_s)
        if name not in kinds:
            raise KeyError(f"a dataset bounds t, {', '.join(kinds)}, not {name!r}")
        return [Fraction(kinds[name])] * len(self)

    def decimals(self, name: str) -> list[str]:
        """Return a column as printed."""
        if name not in self._texts:
            raise KeyError(f"{name!r} is no column; there are {', '.join(self.columns)}")
        return self._texts[name]


@dataclass(frozen=True, repr=False)
class Golden:
    """A golden dataset, as read from disk: the same columns as a `Solution`, as printed.

    `golden.t`, `.x`, … are the grid as binary64 arrays of shape (rows,); both tables have `table["x"]`, the same,
    `table.exact("x")` as fractions, `table.bound("x")`, and `table.decimals("x")`, the printed texts.

    Attributes:
        path: the folder.
        manifest: its manifest.json.
        grid: `grid.csv`.
        transits: `transits.csv`; without rows if they were not asked for, or if xdot is identically zero.
    """

    path: Path
    manifest: Manifest
    grid: PrintedTable
    transits: PrintedTable

    @cached_property
    def scene(self) -> Scene:
        """The scene that the dataset solves."""
        return scene_of(self.manifest)

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


def scene_of(manifest: Manifest) -> Scene:
    """Return the scene that a manifest describes."""
    top = {key: getattr(manifest, key) for key in ("id", "title", "source", "flags", "inputs")}
    return parse_scene({**top, **manifest.scene})


def golden_folder(name: str | Path) -> Path:
    """Return the folder of a dataset given by id or by path."""
    word = str(name)
    return data_root() / "golden" / word if is_scene_id(word.removesuffix(".binary64")) else Path(word)


def read_manifest(folder: Path) -> Manifest:
    """Read the manifest of a dataset and check it against the schema.

    Raises:
        InputError: there is no dataset, or it cannot be read.
        DatasetError: the manifest does not follow the schema.
    """
    try:
        document = json.loads((folder / MANIFEST).read_bytes())
        return Manifest.model_validate(document)
    except FileNotFoundError:
        raise InputError(
            "PATH", str(folder), "a golden dataset (a folder with manifest.json)", "Make it with `foucault generate`."
        ) from None
    except OSError as error:
        raise InputError("PATH", str(folder), "a readable folder", f"{error.strerror}.") from None
    except ValidationError as error:
        details = error.errors()[0]
        where = ".".join(map(str, details["loc"]))
        raise DatasetError(str(folder), [f"manifest.json breaks the schema at {where}: {details['msg']}"]) from None
    except ValueError as error:
        raise DatasetError(str(folder), [f"manifest.json is not JSON: {error}"]) from None


def read_table(path: Path) -> dict[str, list[str]]:
    """Read a CSV table as columns of text, by header."""
    with path.open(encoding="utf-8", newline="") as handle:
        rows = list(csv.reader(handle))
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}


def load(name: str | Path) -> Golden:
    """Read a golden dataset by id or path, after checking its hashes and its schema.

    Raises:
        InputError: there is no such dataset.
        DatasetError: a file is missing, unlisted or changed, or the manifest does not follow the schema.
    """
    folder = golden_folder(name)
    manifest = read_manifest(folder)
    problems = changed_files(folder, manifest)
    if problems:
        raise DatasetError(str(folder), problems)
    tables = (PrintedTable(read_table(folder / f"{name}.csv"), manifest.bounds) for name in ("grid", "transits"))
    return Golden(folder, manifest, *tables)


def changed_files(folder: Path, manifest: Manifest) -> list[str]:
    """Return a sentence for every file that is missing, changed, or not listed in the manifest."""
    problems = []
    for name, record in manifest.files.items():
        try:
            data = (folder / name).read_bytes()
        except OSError as error:
            problems.append(f"{name}: {error.strerror}")
            continue
        if len(data) != record.bytes:
            problems.append(f"{name}: {len(data)} bytes, the manifest says {record.bytes}")
        elif hashlib.sha256(data).hexdigest() != record.sha256:
            problems.append(f"{name}: a byte was changed (sha256 differs)")
    unlisted = {path.name for path in folder.iterdir()} - {MANIFEST, *manifest.files}
    return problems + [f"{name}: not in the manifest" for name in sorted(unlisted)]
