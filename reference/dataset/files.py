"""The files of a golden dataset, read once: the hash of each and the form of each table are checked."""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ..errors import DatasetError, FoucaultError, InputError, did_you_mean
from ..numbers.function import GoldenFunction
from ..scenes.fields import SECTION_WORD
from ..scenes.scene import Scene, parse_scene
from ..scenes.shipped import seals
from .function import FunctionRecord, read_function
from .manifest import FORMAT, FUNCTION, MANIFEST, FileRecord, Kind, Manifest
from .place import RANGES
from .sheets import GRID_HEADER, NUMBERS, SECTIONS_HEADER, TRANSITS_HEADER, Sheet

_MAX_MANIFEST = 1 << 20  # bytes
_HEADERS = {"grid": GRID_HEADER, "transits": TRANSITS_HEADER, "sections": SECTIONS_HEADER}
_BOUND = "[0-9](?:[.][0-9])?e(?:[+][0-9]{2}|-[0-9]{2,4})|0"
_PATTERNS = {
    "k": "[1-9][0-9]{0,9}",
    "direction": "[+]1|-1",
    "bound": _BOUND,
    "section": SECTION_WORD,
}
_DOUBLE = r"-?[0-9][.][0-9]{16}e[+-][0-9]{2,3}"
_HEXFLOAT = r"-?0x[01][.][0-9a-f]{1,13}p[+-][0-9]{1,4}"
LINE_ENDS = (
    "its lines end with CR LF instead of LF: copy the files in binary mode (in Git: `* -text`)"
)


@dataclass(frozen=True)
class DatasetFiles:
    """The files of a dataset, read once: each has the recorded hash and the right form.

    Attributes:
        folder: their folder.
        manifest: `manifest.json`, with its seal intact.
        scene: the scene that it describes.
        texts: every other file of text, by name.
        function: the golden function and its description, None if it has none.
        tables: the CSV tables among them, by name.
        foreign: names of other files in the folder, which are ignored.
    """

    folder: Path
    manifest: Manifest
    scene: Scene
    texts: dict[str, str]
    function: tuple[FunctionRecord, GoldenFunction] | None
    tables: dict[str, Sheet]
    foreign: list[str]


def read_files(folder: Path) -> DatasetFiles:
    """Read a dataset and check its seal, its hashes and the form of its tables.

    Raises:
        InputError: there is no dataset, or it cannot be read.
        DatasetError: a file is missing, changed or malformed, or the manifest breaks its schema or
            its seal.
    """
    manifest = read_manifest(folder)
    scene = _scene(folder, manifest)
    texts: dict[str, str] = {}
    tables: dict[str, Sheet] = {}
    coefficients = b""
    problems = []
    for name, record in manifest.files.items():
        try:
            data = _checked_bytes(folder / name, record)
            if name == FUNCTION[1]:
                coefficients = data
            else:
                texts[name] = data.decode()
            if name.endswith(".csv"):
                tables[name] = _table(name, texts[name], manifest)
        except OSError as error:
            problems.append(f"{name}: {error.strerror}")
        except ValueError as error:
            problems.append(f"{name}: {error}")
    if problems:
        raise DatasetError(str(folder), problems)

    function = _function(folder, texts, coefficients)
    foreign = sorted(set(os.listdir(folder)) - {MANIFEST, *manifest.files})
    return DatasetFiles(folder, manifest, scene, texts, function, tables, foreign)


def _scene(folder: Path, manifest: Manifest) -> Scene:
    """Return the scene that a manifest describes.

    Raises:
        DatasetError: there is no such scene.
    """
    scene_id = manifest.id.partition("+")[0].removesuffix(f".{manifest.inputs}")
    fields = manifest.model_dump(include={"title", "source", "flags", "inputs"})
    try:
        return parse_scene({"id": scene_id, **fields, **manifest.scene})
    except FoucaultError as error:
        raise DatasetError(str(folder), [f"the manifest's scene is refused: {error}"]) from None


def _checked_bytes(path: Path, record: FileRecord) -> bytes:
    """Return the content of a file, if it has the size and hash of its record.

    Raises:
        OSError: it cannot be read.
        ValueError: the file has another size or hash; the message says which.
    """
    size = path.stat().st_size
    wrong_size = f"{size} bytes, the manifest says {record.bytes}"
    if size > 2 * record.bytes:  # so that nothing larger is read
        raise ValueError(wrong_size)
    data = path.read_bytes()
    if size != record.bytes:
        line_ends_changed = hashlib.sha256(_with_lf(data)).hexdigest() == record.sha256
        raise ValueError(LINE_ENDS if line_ends_changed else wrong_size)
    if hashlib.sha256(data).hexdigest() != record.sha256:
        raise ValueError("a byte was changed (sha256 differs)")
    return data


def _function(
    folder: Path, texts: dict[str, str], coefficients: bytes
) -> tuple[FunctionRecord, GoldenFunction] | None:
    """Return the golden function and its description, None if the dataset has none.

    Raises:
        DatasetError: its files are malformed.
    """
    description = FUNCTION[0]
    if description not in texts:
        return None
    try:
        return read_function(texts[description], coefficients)
    except ValueError as error:
        raise DatasetError(str(folder), [f"{description} {error}"]) from None


def read_manifest(folder: Path) -> Manifest:
    """Read a dataset's manifest alone and check its seal.

    Raises:
        InputError: there is no dataset, or it cannot be read.
        DatasetError: the manifest is missing or malformed, or breaks its schema or its seal.
    """
    _check_is_dataset(folder)
    text = _manifest_text(folder)
    manifest = _parsed(folder, text)
    canonical_text = manifest.text()
    if text != canonical_text:
        if _with_lf(text.encode()).decode() == canonical_text:
            raise DatasetError(str(folder), [f"{MANIFEST}: {LINE_ENDS}"])
        form = "the form in which it is written: spaces, the order of keys, or a key twice"
        raise _refused(folder, f"is not in {form}")
    if manifest.expected_seal() != manifest.seal:
        raise _refused(folder, "does not fit its seal: a byte was changed")
    return manifest


def _check_is_dataset(folder: Path) -> None:
    """Check that a folder has a manifest.

    Raises:
        InputError: it has none, or cannot be read.
    """
    try:
        is_dataset = MANIFEST in os.listdir(folder)
    except (FileNotFoundError, NotADirectoryError, ValueError):
        is_dataset = False
    except OSError as error:
        raise InputError("PATH", str(folder), "a readable folder", f"{error.strerror}.") from None
    if not is_dataset:
        raise _no_dataset(folder)


def _manifest_text(folder: Path) -> str:
    """Return the text of a manifest.

    Raises:
        DatasetError: it is too large, not UTF-8, or cannot be read.
    """
    path = folder / MANIFEST
    try:
        size = path.stat().st_size
        if size > _MAX_MANIFEST:
            raise _refused(folder, f"has {size} bytes, {_MAX_MANIFEST} are the most")
        return path.read_bytes().decode()
    except OSError as error:
        raise _refused(folder, f"cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise _refused(folder, f"is not JSON in UTF-8: {error}") from None


def _parsed(folder: Path, text: str) -> Manifest:
    """Return the manifest that a text holds.

    Raises:
        DatasetError: it is not JSON, or breaks the schema.
    """
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise _refused(folder, f"is not JSON in UTF-8: {error}") from None
    try:
        return Manifest.model_validate(document)
    except ValidationError as error:
        format_number = document.get("schema_version") if isinstance(document, dict) else None
        if format_number in range(1, FORMAT):
            advice = "make the dataset again with `foucault generate`"
            raise _refused(folder, f"is of format {format_number}: {advice}") from None
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        at_place = f" at {place}" if place else ""
        raise _refused(folder, f"breaks the schema{at_place}: {first['msg']}") from None
    except (ValueError, RecursionError) as error:
        raise _refused(folder, f"breaks the schema: {error}") from None


def _refused(folder: Path, problem: str) -> DatasetError:
    """Return the error for a manifest that is refused."""
    return DatasetError(str(folder), [f"{MANIFEST} {problem}"])


def _with_lf(data: bytes) -> bytes:
    """Return a text whose lines end with LF, where a copy ended them with CR LF."""
    return data.replace(b"\r\n", b"\n")


def _no_dataset(folder: Path) -> InputError:
    """Return the error for a folder that is no dataset; its advice depends on what is there."""
    if (folder / RANGES).is_file():
        advice = "The folder contains ranges: reference.load_ranges reads them."
        return InputError("PATH", str(folder), "a golden dataset", advice)
    names = () if folder.exists() else seals()
    advice = did_you_mean(folder.name, names, "Make it with `foucault generate`.")
    return InputError("PATH", str(folder), f"a golden dataset (a folder with {MANIFEST})", advice)


def _table(name: str, text: str, manifest: Manifest) -> Sheet:
    """Return a table from its text.

    Raises:
        ValueError: its header, a row or the number of rows is wrong; the message says which.
    """
    kind: Any = name.partition(".")[0]
    patterns = _patterns(kind, manifest, doubles=name.endswith(".binary64.csv"))
    header = tuple(patterns)
    lines = io.StringIO(text)
    if next(lines, "") != ",".join(header) + "\n":
        raise ValueError(f"the header must be {','.join(header)}")
    count = _count(kind, manifest)
    if text.count("\n") != count + 1 or not text.endswith("\n"):
        rows_there = text.count("\n") - 1
        raise ValueError(f"has {rows_there} rows, but the manifest says {count}")

    row_pattern = re.compile(",".join(f"(?:{pattern})" for pattern in patterns.values()), re.ASCII)
    rows = []
    for number, line in enumerate(lines, 1):
        row = line[:-1]
        cells = tuple(row.split(","))
        if not row_pattern.fullmatch(row):
            raise ValueError(f"row {number}: {_wrong_cell(cells, patterns)}")
        rows.append(cells)
    return Sheet(header, rows, {})


def _count(kind: Kind, manifest: Manifest) -> int:
    """Return the number of rows that a table should have."""
    if kind == "sections" and manifest.sections:
        return sum(manifest.sections.counts.values())
    return int(getattr(manifest.counts, kind))


def _patterns(kind: Kind, manifest: Manifest, doubles: bool) -> dict[str, str]:
    """Return the pattern of each column's numbers, in the order of the columns."""
    decimals = manifest.decimals.get(kind, {})
    if kind == "sections" and manifest.sections:
        decimals = manifest.sections.decimals
    patterns = {}
    for column in _HEADERS[kind]:
        places = decimals.get(column)
        decimal = "-?[0-9]{1,308}"
        if places:
            decimal += f"[.][0-9]{{{places}}}"
        patterns[column] = _PATTERNS.get(column, _DOUBLE if doubles else decimal)
    if doubles:
        for column in NUMBERS[kind]:
            patterns[f"{column}_hex"] = _HEXFLOAT
    return patterns


def _wrong_cell(cells: Sequence[str], patterns: dict[str, str]) -> str:
    """Return what is wrong with the cells of a row."""
    if len(cells) != len(patterns):
        return f"{len(cells)} numbers, not {len(patterns)}"
    wrong = (
        (name, cell)
        for (name, pattern), cell in zip(patterns.items(), cells, strict=True)
        if not re.fullmatch(pattern, cell, re.ASCII)
    )
    name, cell = next(wrong)
    return f"{name} = {cell[:80]!r} is not a number of this column's form"
