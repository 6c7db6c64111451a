"""Read a golden dataset: hashes and schema are checked, columns given as doubles, decimal strings or fractions."""

from __future__ import annotations

import csv
import hashlib
import json
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from pydantic import ValidationError

from ..errors import DatasetError, InputError
from ..scene import Scene, is_scene_id, parse_scene
from ..shipped import data_root
from .manifest import Manifest

MANIFEST = "manifest.json"


@dataclass(frozen=True)
class Golden:
    """A golden dataset, as read from disk.

    `golden.t`, `.x`, … are the grid as binary64 arrays; `golden.transits["t"]` the transits;
    `golden.decimals("x")` the printed strings, `golden.exact("x")` the same as fractions;
    `golden.manifest.bounds` bounds the error of each of them.
    """

    path: Path
    manifest: Manifest
    grid_text: dict[str, list[str]] = field(repr=False)
    transits_text: dict[str, list[str]] = field(repr=False)

    @cached_property
    def scene(self) -> Scene:
        """The scene that the dataset solves."""
        return scene_of(self.manifest)

    @cached_property
    def transits(self) -> dict[str, npt.NDArray[np.float64]]:
        """Columns of `transits.csv` as the nearest doubles, shape (transits,)."""
        return {name: np.array([float(text) for text in column]) for name, column in self.transits_text.items()}

    def decimals(self, column: str) -> list[str]:
        """Return a grid column as printed."""
        return self.grid_text[column]

    def exact(self, column: str) -> list[Fraction]:
        """Return the exact values of the printed decimals of a grid column."""
        return [Fraction(text) for text in self.grid_text[column]]

    def __getattr__(self, name: str) -> Any:
        """Return a grid column as the nearest doubles, shape (rows,)."""
        if name.startswith("_") or name not in self.grid_text:
            raise AttributeError(name)
        return np.array([float(text) for text in self.grid_text[name]])


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
    return Golden(folder, manifest, read_table(folder / "grid.csv"), read_table(folder / "transits.csv"))


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
