"""A report: a JSON document, and text, rows and a page made from it; each file is replaced whole."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reference import InputError
from reference.errors import usable
from reference.plain_text import plain_json
from reference.system.checksums import SUMS, sums_text
from reference.system.workspace import replace_file

from .page import MARK, PageTable

CSV = "rows.csv"
PAGE = "index.html"
_HEAD = 1024  # bytes at the start of a page that hold its mark


@dataclass(frozen=True)
class Report:
    """The shape of a report: all that is shown is made from one JSON document.

    The same document gives the same bytes.

    Attributes:
        json: name of the document's file.
        text: makes the text for a terminal.
        page: makes the page as HTML.
    """

    json: str
    text: Callable[[dict[str, Any]], str]
    page: Callable[[dict[str, Any]], str]

    def check(self, out: Path | None) -> None:
        """Refuse an unusable folder before the work, as `check_folder` does; None means no folder."""
        if out is not None:
            check_folder(out, (CSV, self.json, PAGE))

    def write(self, document: dict[str, Any], out: Path | None) -> Path | None:
        """Write the files as `write_files` does, and return the path of the page.

        `document["rows"]` is the table.
        """
        if out is None:
            return None
        rows = PageTable.of_records(document["rows"][0], document["rows"]).csv()
        write_files(out, {CSV: rows, self.json: json_text(document), PAGE: self.page(document)})
        return out / PAGE


def check_folder(folder: Path, names: Iterable[str]) -> None:
    """Refuse an unusable folder before the work; nothing is created.

    Raises:
        InputError: it has one of these files but no page of ours, so that somebody else's would be
            replaced; it is no folder, or cannot be written to.
    """
    with usable("--out", folder):
        existing = next((name for name in names if (folder / name).exists()), None)
        if (existing is not None and not _is_ours(folder / PAGE)) or (
            folder.exists() and not folder.is_dir()
        ):
            reason = (
                "It is not a folder"
                if existing is None
                else f"It contains a {existing} that no run wrote"
            )
            expected = "a new folder, or one that an earlier run wrote"
            raise InputError("--out", str(folder), expected, f"{reason}. Choose another name.")
        absolute = folder.absolute()
        place = next(path for path in (absolute, *absolute.parents) if path.exists())
        with tempfile.TemporaryFile(dir=place):
            pass


def _is_ours(page: Path) -> bool:
    return page.is_file() and MARK.encode() in page.read_bytes()[:_HEAD]


def write_files(folder: Path, texts: Mapping[str, str]) -> None:
    """Write files into a folder, each completely or not at all, the page first.

    Other files in it are left alone.

    Their checksums come last, in SHA256SUMS, by which `foucault verify` finds what was changed
    since.

    Args:
        folder: created if it does not exist.
        texts: content of each file, by name.

    Raises:
        InputError: the folder cannot be written to, or `check_folder` refuses it.
    """
    check_folder(folder, [*texts, SUMS])
    files = {name: _encoded(text) for name, text in texts.items()}
    with usable("--out", folder):
        folder.mkdir(parents=True, exist_ok=True)
        # a folder with a page of ours may be written again
        for name in sorted(files, key=lambda name: name != PAGE):
            _replace(folder / name, files[name])
        _replace(folder / SUMS, sums_text(files))


def write_file(path: Path, content: str | bytes, field: str) -> None:
    """Write a file that an option names, completely or not at all.

    Raises:
        InputError: it cannot be written; `field` is the option.
    """
    with usable(field, path, "a file that can be written"):
        _replace(path, content)


def _encoded(text: str) -> bytes:
    # a name on the command line may hold bytes that are not UTF-8; JSON too reads the escapes
    return text.encode(errors="backslashreplace")


def _replace(path: Path, content: str | bytes) -> None:
    data = _encoded(content) if isinstance(content, str) else content
    replace_file(path, lambda stream: stream.write(data))


def json_text(document: Any) -> str:
    """Return a document as JSON; NaN and infinity, which JSON does not have, become null."""
    return plain_json(document) + "\n"
