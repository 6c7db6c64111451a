"""The files of a golden dataset, read once: every byte hashed, nothing used but what was hashed, tables well formed."""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from ..errors import DatasetError, FoucaultError, InputError, did_you_mean
from ..numbers.function import GoldenFunction
from ..scenes.fields import SECTION_WORD
from ..scenes.scene import Scene, parse_scene
from ..scenes.shipped import seals
from .function import FunctionRecord, read_function
from .manifest import FORMAT, FUNCTION, MANIFEST, Manifest
from .place import RANGES
from .sheets import GRID_HEADER, NUMBERS, SECTIONS_HEADER, TRANSITS_HEADER, Sheet

MAX_MANIFEST = 1 << 20  # bytes
HEADERS = {"grid": GRID_HEADER, "transits": TRANSITS_HEADER, "sections": SECTIONS_HEADER}
_BOUND = "[0-9](?:[.][0-9])?e(?:[+][0-9]{2}|-[0-9]{2,4})|0"
_PATTERNS = {
    "k": "[1-9][0-9]{0,9}",
    "direction": "[+]1|-1",
    "bound": _BOUND,
    "section": SECTION_WORD,
}
_DOUBLE = r"-?[0-9][.][0-9]{16}e[+-][0-9]{2,3}"
_HEXFLOAT = r"-?0x[01][.][0-9a-f]{1,13}p[+-][0-9]{1,4}"


@dataclass(frozen=True)
class Files:
    """The files of a dataset, read once: those of their hashes, well formed.

    Attributes:
        folder: where they stand.
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


LINE_ENDS = (
    "its lines end with CR LF and not with LF: copy the files as binary ones (in Git: `* -text`)"
)


def with_lf(data: bytes) -> bytes:
    """Return a text whose lines end with LF, where a copy ended them with CR LF."""
    return data.replace(b"\r\n", b"\n")


def read_files(folder: Path) -> Files:
    """Read a dataset and check its seal, its hashes and the form of its tables.

    Raises:
        InputError: there is no dataset, or it cannot be read.
        DatasetError: a file is missing, changed or malformed, or the manifest breaks its schema or its seal.
    """
    manifest = read_manifest(folder)
    name_of_scene = manifest.id.partition("+")[0].removesuffix(f".{manifest.inputs}")
    top = manifest.model_dump(include={"title", "source", "flags", "inputs"})
    try:
        scene = parse_scene({"id": name_of_scene, **top, **manifest.scene})
    except FoucaultError as error:
        raise DatasetError(str(folder), [f"the manifest's scene is refused: {error}"]) from None
    texts: dict[str, str] = {}
    tables: dict[str, Sheet] = {}
    problems, numbers = [], b""
    for name, record in manifest.files.items():
        try:
            size = (folder / name).stat().st_size
            if size > 2 * record.bytes:  # so that nothing larger is read
                problems.append(f"{name}: {size} bytes, the manifest says {record.bytes}")
                continue
            data = (folder / name).read_bytes()
            if size != record.bytes:
                ends_changed = hashlib.sha256(with_lf(data)).hexdigest() == record.sha256
                what = (
                    LINE_ENDS if ends_changed else f"{size} bytes, the manifest says {record.bytes}"
                )
                problems.append(f"{name}: {what}")
                continue
            if hashlib.sha256(data).hexdigest() != record.sha256:
                problems.append(f"{name}: a byte was changed (sha256 differs)")
            elif name == FUNCTION[1]:
                numbers = data
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
    try:
        function = read_function(texts[FUNCTION[0]], numbers) if FUNCTION[0] in texts else None
    except ValueError as error:
        raise DatasetError(str(folder), [f"{FUNCTION[0]} {error}"]) from None
    foreign = sorted(set(os.listdir(folder)) - {MANIFEST, *manifest.files})
    return Files(folder, manifest, scene, texts, function, tables, foreign)


def read_manifest(folder: Path) -> Manifest:
    """Read a dataset's manifest alone and check its seal.

    Raises:
        InputError: there is no dataset, or it cannot be read.
        DatasetError: the manifest is missing or malformed, or breaks its schema or its seal.
    """

    def refused(problem: str) -> DatasetError:
        return DatasetError(str(folder), [f"{MANIFEST} {problem}"])

    try:
        if MANIFEST not in os.listdir(folder):
            raise _no_dataset(folder)
    except (FileNotFoundError, NotADirectoryError, ValueError):
        raise _no_dataset(folder) from None
    except OSError as error:
        raise InputError("PATH", str(folder), "a readable folder", f"{error.strerror}.") from None
    try:
        if (size := (folder / MANIFEST).stat().st_size) > MAX_MANIFEST:
            raise refused(f"has {size} bytes, {MAX_MANIFEST} are the most")
        text = (folder / MANIFEST).read_bytes().decode()
        document = json.loads(text)
        manifest = Manifest.model_validate(document)
    except OSError as error:
        raise refused(f"cannot be read: {error.strerror}") from None
    except ValidationError as error:
        older = document.get("schema_version") if isinstance(document, dict) else None
        if older in range(1, FORMAT):
            raise refused(
                f"is of format {older}: make the dataset again with `foucault generate`"
            ) from None
        details = error.errors()[0]
        where = ".".join(map(str, details["loc"]))
        raise refused(
            f"breaks the schema{' at ' + where if where else ''}: {details['msg']}"
        ) from None
    except (ValueError, RecursionError) as error:
        raise refused(f"is not JSON in UTF-8: {error}") from None
    if manifest.text() == with_lf(text.encode()).decode() != text:
        raise DatasetError(str(folder), [f"{MANIFEST}: {LINE_ENDS}"])
    if manifest.text() != text:
        raise refused(
            "is not in the form in which it is written: spaces, the order of keys, or a key twice"
        )
    if manifest.expected_seal() != manifest.seal:
        raise refused("does not fit its seal: a byte was changed")
    return manifest


def _no_dataset(folder: Path) -> InputError:
    if (folder / RANGES).is_file():
        advice = "These are ranges: reference.load_ranges reads them."
        return InputError("PATH", str(folder), "a golden dataset", advice)
    advice = did_you_mean(
        folder.name, () if folder.exists() else seals(), "Make it with `foucault generate`."
    )
    return InputError("PATH", str(folder), f"a golden dataset (a folder with {MANIFEST})", advice)


def _table(name: str, text: str, manifest: Manifest) -> Sheet:
    """Return a table from its text; ValueError says what is wrong with it."""
    kind = name.partition(".")[0]
    patterns = _patterns(name, kind, manifest)
    counts = manifest.sections.counts if kind == "sections" and manifest.sections else None
    count = getattr(manifest.counts, kind) if counts is None else sum(counts.values())
    lines, header = io.StringIO(text), tuple(patterns)
    if next(lines, "") != ",".join(header) + "\n":
        raise ValueError(f"the header must be {','.join(header)}")
    if text.count("\n") != count + 1 or not text.endswith("\n"):
        raise ValueError(f"{text.count(chr(10)) - 1} rows, the manifest counts {count}")
    row_pattern = re.compile(",".join(f"(?:{pattern})" for pattern in patterns.values()), re.ASCII)
    rows = []
    for number, line in enumerate(lines, 1):
        cells = tuple(line[:-1].split(","))
        if not row_pattern.fullmatch(line[:-1]):
            raise ValueError(f"row {number}: {_wrong_cell(cells, patterns)}")
        rows.append(cells)
    return Sheet(header, rows, {})


def _patterns(name: str, kind: str, manifest: Manifest) -> dict[str, str]:
    """Return the pattern of each column's numbers, in the order of the columns."""
    doubles, decimals = name.endswith(".binary64.csv"), manifest.decimals.get(kind, {})  # type: ignore[call-overload]
    decimals = manifest.sections.decimals if kind == "sections" and manifest.sections else decimals
    patterns = {}
    for column in HEADERS[kind]:
        places = decimals.get(column)
        plain = "-?[0-9]{1,308}" + (f"[.][0-9]{{{places}}}" if places else "")
        patterns[column] = _PATTERNS.get(column, _DOUBLE if doubles else plain)
    return patterns | ({f"{column}_hex": _HEXFLOAT for column in NUMBERS[kind]} if doubles else {})


def _wrong_cell(cells: Sequence[str], patterns: dict[str, str]) -> str:
    if len(cells) != len(patterns):
        return f"{len(cells)} numbers, not {len(patterns)}"
    pairs = zip(patterns.items(), cells, strict=True)
    name, cell = next(
        (name, cell) for (name, form), cell in pairs if not re.fullmatch(form, cell, re.ASCII)
    )
    return f"{name} = {cell[:80]!r} is not a number of this column's form"
