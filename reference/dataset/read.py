"""A golden dataset as it stands on disk: read, after its hashes and its schema were checked."""

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
from ..scene import Scene, data_root, is_scene_id, parse_scene
from .manifest import Manifest

MANIFEST = "manifest.json"


@dataclass(frozen=True)
class Golden:
    """A golden dataset as it stands on disk.

    `golden.t`, `.x`, … are the grid as binary64 arrays; `golden.transits["t"]` the transits;
    `golden.decimals("x")` the printed strings, `golden.exact("x")` the same as fractions;
    `golden.manifest.bounds` says how far any of them may be from the truth.
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
        """A grid column as printed."""
        return self.grid_text[column]

    def exact(self, column: str) -> list[Fraction]:
        """A grid column as the exact value of what is printed."""
        return [Fraction(text) for text in self.grid_text[column]]

    def __getattr__(self, name: str) -> Any:
        """A grid column as the nearest doubles, shape (rows,)."""
        if name.startswith("_") or name not in self.grid_text:
            raise AttributeError(name)
        return np.array([float(text) for text in self.grid_text[name]])


def scene_of(manifest: Manifest) -> Scene:
    """The scene that a manifest describes."""
    top = {key: getattr(manifest, key) for key in ("id", "title", "source", "flags", "inputs")}
    return parse_scene({**top, **manifest.scene})


def golden_folder(name: str | Path) -> Path:
    """The folder of a dataset given by id, or by path."""
    word = str(name)
    return data_root() / "golden" / word if is_scene_id(word.removesuffix(".binary64")) else Path(word)


def read_manifest(folder: Path) -> Manifest:
    """The manifest of a dataset.

    Raises:
        InputError: there is no dataset.
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
    """A CSV table as columns of text, by header."""
    with path.open(encoding="utf-8", newline="") as handle:
        rows = list(csv.reader(handle))
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}


def load(name: str | Path) -> Golden:
    """Read a golden dataset by id or path, after checking its hashes and its schema.

    Raises:
        InputError: there is none.
        DatasetError: a file was changed.
    """
    folder = golden_folder(name)
    manifest = read_manifest(folder)
    problems = changed_files(folder, manifest)
    if problems:
        raise DatasetError(str(folder), problems)
    return Golden(folder, manifest, read_table(folder / "grid.csv"), read_table(folder / "transits.csv"))


def changed_files(folder: Path, manifest: Manifest) -> list[str]:
    """Files that are missing, strange, or not the bytes that the manifest names."""
    found = []
    for name, record in manifest.files.items():
        try:
            data = (folder / name).read_bytes()
        except OSError as error:
            found.append(f"{name}: {error.strerror}")
            continue
        if len(data) != record.bytes:
            found.append(f"{name}: {len(data)} bytes, the manifest says {record.bytes}")
        elif hashlib.sha256(data).hexdigest() != record.sha256:
            found.append(f"{name}: a byte was changed (sha256 differs)")
    strangers = {path.name for path in folder.iterdir()} - {MANIFEST, *manifest.files}
    return found + [f"{name}: not in the manifest" for name in sorted(strangers)]
