"""A sweep on disk: a folder with its plan and its parts in Parquet, each sealed, and written whole or not at all.

`plan.json` says all that decides a number, `rows/part-00000000.parquet` … hold the rows, `transits/part-…` their
transits where these are wanted, `summary.json` comes last. A part appears whole or not at all, and is sealed with the
plan and its number: those whose seals are right are not computed again.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ..errors import InputError, usable
from ..plain_text import plain_json
from ..system.checksums import SUMS, sums_text
from ..system.documents import json_document, regular
from ..system.imports import needed
from ..system.workspace import clear, replace_file
from .parquet import TRANSIT_COLUMNS, arrays, is_sealed, parquet
from .part import Part
from .request import Request

PLAN, SUMMARY, ROWS, TRANSITS = "plan.json", "summary.json", "rows", "transits"
PARQUET = ("pyarrow", "sweep", "--out", "a folder of Parquet files")  # what is needed, and for what
MOST_BYTES = 1 << 40  # of a part: no limit but that of a disk


@dataclass(frozen=True)
class Store:
    """The folder of a sweep.

    Attributes:
        folder: where it is.
        request: the sweep.
        pyarrow: the version that it was begun with, which decides the bytes of a file.
    """

    folder: Path
    request: Request
    pyarrow: str = ""

    @classmethod
    def begun(cls, folder: Path, request: Request) -> Store:
        """Begin a folder, or go on with that of the same sweep.

        Raises:
            InputError: it holds another sweep, or something else, or other versions would write other bytes, or it
                cannot be written.
        """
        if (folder / PLAN).exists():
            store = cls.opened(folder)
            store._check_same(request)
        else:
            needed(*PARQUET)
            if folder.exists() and (not folder.is_dir() or any(map(_foreign, folder.iterdir()))):
                raise InputError(
                    "--out", str(folder), "a new or empty folder, or that of this sweep"
                )
            store = cls(folder, request, version("pyarrow"))
        with usable("--out", folder):
            for kind in store._kinds:
                (folder / kind).mkdir(parents=True, exist_ok=True)
                # a part that is there is not written again, which would clear it
                clear(folder / kind)
            clear(folder)
        if not (folder / PLAN).exists():
            write_json(
                folder / PLAN,
                {"hash": request.hash, "pyarrow": store.pyarrow, **request.document()},
            )
        return store

    @classmethod
    def opened(cls, folder: Path) -> Store:
        """Open the folder of a sweep that was begun.

        Raises:
            InputError: there is none, or its plan is damaged.
        """
        needed(*PARQUET)
        try:
            document = json_document(folder / PLAN, "--out")
            request = Request.of(document)
            unchanged = request.hash == document["hash"]
        except FileNotFoundError:
            advice = "Give a scene and --over to begin one."
            raise InputError(
                "--out", str(folder), f"a folder of a sweep, with {PLAN}", advice
            ) from None
        except (ValueError, KeyError, TypeError, AttributeError, InputError):
            unchanged = False
        if not unchanged:
            raise InputError(
                "--out", str(folder), f"a {PLAN} as this version writes it", "Sweep anew."
            )
        return cls(folder, request, str(document.get("pyarrow")))

    def _check_same(self, request: Request) -> None:
        """Refuse to go on with another sweep, or with versions that would write other bytes.

        Raises:
            InputError: it differs from the plan.
        """
        there, here = self.request.document(), request.document()
        keys = sorted(here.keys() - {"identity"})  # which tells of versions, below
        differing = [key for key in keys if json.dumps(there.get(key)) != json.dumps(here[key])]
        if differing:
            expected = f"the sweep that is there, which differs in {', '.join(differing)}"
            raise InputError("--out", str(self.folder), expected, "Take another folder.")
        versions = {
            request.identity: self.request.identity,
            f"pyarrow {version('pyarrow')}": f"pyarrow {self.pyarrow}",
        }
        for got, expected in versions.items():
            if got != expected:
                advice = "Install the versions that the sweep was begun with, or begin it anew in another folder."
                raise InputError("--out", got, f"{expected}, as in {self.folder / PLAN}", advice)

    @property
    def _kinds(self) -> tuple[str, ...]:
        return (ROWS, TRANSITS) if self.request.run_options.times else (ROWS,)

    def path(self, part: int, kind: str = ROWS) -> Path:
        """Return the file of a part."""
        return self.folder / kind / f"part-{part:08d}.parquet"

    def missing(self) -> list[int]:
        """Return the parts that are not there yet, were damaged, or are others of this plan or of another."""
        return [
            part
            for part in range(self.request.parts)
            if not all(self._sound(part, kind) for kind in self._kinds)
        ]

    def _sound(self, part: int, kind: str) -> bool:
        with (
            suppress(FileNotFoundError, InputError),
            regular(self.path(part, kind), "--out", MOST_BYTES, "a part") as stream,
        ):
            return is_sealed(stream.read(), self._named(part, kind))
        return False

    def _named(self, part: int, kind: str) -> str:
        """Return what a part is, for its seal."""
        return f"{kind} {part} of {self.request.hash}"

    def save(self, part: int, solved: Part) -> None:
        """Write a part, whole or not at all.

        Raises:
            InputError: it cannot be written.
        """
        tables = {
            ROWS: (self.request.columns, solved.columns),
            TRANSITS: (TRANSIT_COLUMNS, solved.transits),
        }
        for kind in self._kinds:
            _write(self.path(part, kind), parquet(*tables[kind], self._named(part, kind)))

    def finish(self, summary: dict[str, Any]) -> None:
        """Write what the sweep has found, and the checksums of the files that have no seal of their own.

        Raises:
            InputError: they cannot be written.
        """
        write_json(self.folder / SUMMARY, summary)
        files = {name: (self.folder / name).read_bytes() for name in (PLAN, SUMMARY)}
        _write(self.folder / SUMS, sums_text(files).encode())

    def foreign(self) -> list[str]:
        """Return the files beside the parts that are none of the sweep's, by their paths in its folder.

        Those whose names begin with a dot are left out, as they are by programs that read Parquet.
        """
        parts = {
            self.path(part, kind) for kind in self._kinds for part in range(self.request.parts)
        }
        found = {path for kind in (ROWS, TRANSITS) for path in (self.folder / kind).glob("[!.]*")}
        return sorted(str(path.relative_to(self.folder)) for path in found - parts)

    def read(
        self, names: list[str] | None = None, kind: str = ROWS, parts: Iterable[int] | None = None
    ) -> dict[str, Any]:
        """Return columns of some parts as arrays, one below the other: all columns and parts if none are named.

        Raises:
            InputError: a part was damaged or lost since its seal was checked.
        """
        chosen = range(self.request.parts) if parts is None else parts
        try:
            return arrays([self.path(part, kind) for part in chosen], names)
        except OSError as error:
            advice = f"{error.strerror or error}. Go on with `foucault sweep --out {self.folder}`."
            raise InputError(
                "sweep", str(self.folder), "parts as they were written", advice
            ) from None


def _foreign(path: Path) -> bool:
    """Return whether a file is none of those that a sweep leaves which was killed as it began."""
    return path.name not in (ROWS, TRANSITS, PLAN) and not path.name.startswith(f".{PLAN}.")


def write_json(path: Path, document: dict[str, Any]) -> None:
    """Write a document of a sweep, whole or not at all."""
    _write(path, (plain_json(document) + "\n").encode())


def _write(path: Path, data: bytes) -> None:
    with usable("--out", path, "a file that can be written"):
        replace_file(path, lambda stream: stream.write(data))
