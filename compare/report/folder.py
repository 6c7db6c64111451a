"""A report: a JSON document, and text, rows and a page made from it; its files are written all or none."""

from __future__ import annotations

import csv
import io
import os
import shutil
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reference import InputError
from reference.errors import plain_json, plain_lines
from reference.system.workspace import workspace

from .page import MARK

CSV, PAGE = "rows.csv", "index.html"
_FORMULA = ("=", "+", "-", "@", "\t", "\n")  # may begin a formula in a spreadsheet, as OWASP lists them
_HEAD = 1024  # bytes at the start of a page that hold its mark


@dataclass(frozen=True)
class Report:
    """The shape of a report: all that is shown is made from one JSON document; the same document gives the same bytes.

    Attributes:
        json: name of the document's file.
        text: makes the text for a terminal.
        page: makes the page as HTML.
    """

    json: str
    text: Callable[[dict[str, Any]], str]
    page: Callable[[dict[str, Any]], str]

    def check(self, out: Path | None) -> None:
        """Refuse a folder before the work, as `check_folder` does; None is no folder."""
        if out is not None:
            check_folder(out, (CSV, self.json, PAGE))

    def write(self, document: dict[str, Any], out: Path | None) -> Path | None:
        """Write the files as `write_files` does, and return the path of the page; `document["rows"]` is the table."""
        if out is None:
            return None
        rows = csv_text(document["rows"][0], document["rows"])
        write_files(out, {CSV: rows, self.json: json_text(document), PAGE: self.page(document)})
        return out / PAGE


def check_folder(folder: Path, names: Iterable[str]) -> None:
    """Refuse a folder with one of these files but without a page of ours: somebody else's file would be replaced.

    Raises:
        InputError: there is such a file, or `folder` is not a folder.
    """
    existing = next((name for name in names if (folder / name).exists()), None)
    if (existing is not None and not _is_ours(folder / PAGE)) or (folder.exists() and not folder.is_dir()):
        reason = "It is not a folder" if existing is None else f"It has a {existing} of its own"
        expected = "a new folder, or one that an earlier run wrote"
        raise InputError("--out", str(folder), expected, f"{reason}: choose another name.")


def _is_ours(page: Path) -> bool:
    try:
        with page.open("rb") as stream:
            return MARK.encode() in stream.read(_HEAD)
    except OSError:
        return False


def write_files(folder: Path, texts: Mapping[str, str]) -> None:
    """Write files into a folder, all or none; other files in it are left alone.

    All files are first written beside their targets and then renamed in order. After an error or an interruption the
    old files are put back.

    Args:
        folder: created if it does not exist.
        texts: content of each file, by name.

    Raises:
        InputError: the folder cannot be written to, or `check_folder` refuses it.
    """
    check_folder(folder, texts)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with workspace(folder, "report") as work:
            new, old = ({name: work / f"{name}.{word}" for name in texts} for word in ("new", "before"))
            for name, content in texts.items():
                _write(new[name], content)
                if (folder / name).exists():
                    shutil.copy2(folder / name, old[name])
            _replace(folder, new, old)
    except OSError as error:
        advice = f"{error.strerror}."
        raise InputError("--out", str(folder), "a folder that can be written to", advice) from None


def _replace(folder: Path, new: Mapping[str, Path], old: Mapping[str, Path]) -> None:
    """Rename the new files into the folder, in order; bring the old ones back if that ends in between."""
    renamed: list[str] = []
    try:
        for name, path in new.items():
            os.replace(path, folder / name)
            renamed.append(name)
    except BaseException:
        for name in renamed:
            _bring_back(old[name], folder / name)
        raise


def _write(path: Path, content: str) -> None:
    # a name on the command line may hold bytes that are not UTF-8; JSON too reads the escapes
    with path.open("w", encoding="utf-8", errors="backslashreplace", newline="") as stream:
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())


def _bring_back(old: Path, target: Path) -> None:
    with suppress(OSError):
        if old.exists():
            os.replace(old, target)
        else:
            target.unlink()


def csv_text(columns: Iterable[str], rows: Iterable[Mapping[str, Any]]) -> str:
    """Return rows as CSV: a header line, doubles with all their digits, an empty field where there is no value.

    Control characters are written out, and what a spreadsheet would run as a formula begins with an apostrophe.
    """
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(columns), lineterminator="\n")
    writer.writeheader()
    writer.writerows({name: _harmless(value) for name, value in row.items()} for row in rows)
    return stream.getvalue()


def _harmless(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    text = plain_lines(value)
    if not text.startswith(_FORMULA):
        return text
    try:
        float(text)
    except ValueError:
        return f"'{text}"
    return text


def json_text(document: Any) -> str:
    """Return a document as JSON; NaN and infinity, which JSON does not have, become null."""
    return plain_json(document) + "\n"
