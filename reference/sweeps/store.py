"""A sweep on disk: a folder with its plan and its parts in Parquet.

`plan.json` says all that decides a number, `rows/part-00000000.parquet` … hold the rows, `transits/part-…` their
transits where these are wanted, `summary.json` comes last. A part appears whole or not at all, and carries the hash of
the plan: those that are there are not computed again.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..system.documents import json_document
from ..system.workspace import replace_file
from .parquet import PYARROW, arrays, footer, parquet
from .part import Part
from .request import Request
from .row import Column

PLAN, SUMMARY, ROWS, TRANSITS = "plan.json", "summary.json", "rows", "transits"
_TRANSIT_COLUMNS = (
    Column("row", "int64", "number of the row"),
    Column("t_s", "float64", "time of the transit"),
    Column("direction", "int8", "+1 where xdot goes from - to +"),
)


class Store:
    """The folder of a sweep.

    Args:
        folder: where it is.
        request: the sweep.
    """

    def __init__(self, folder: Path, request: Request) -> None:
        self.folder, self.request = folder, request

    @classmethod
    def begun(cls, folder: Path, request: Request) -> Store:
        """Begin a folder, or go on with that of the same sweep.

        Raises:
            InputError: it holds another sweep, or something else.
            OSError: it cannot be written.
        """
        if (folder / PLAN).exists():
            store = cls.opened(folder)
            if store.request.hash != request.hash:
                names = _differences(store.request.document(), request.document())
                raise InputError(
                    "--out", str(folder), f"the sweep that is there, which differs in {names}", "Take another folder."
                )
            return store
        if folder.exists() and (not folder.is_dir() or any(map(_foreign, folder.iterdir()))):
            raise InputError("--out", str(folder), "a new or empty folder, or that of this sweep")
        folder.mkdir(parents=True, exist_ok=True)
        store = cls(folder, request)
        store._make_folders()
        _write_json(folder / PLAN, {"hash": request.hash, "pyarrow": PYARROW, **request.document()})
        return store

    @classmethod
    def opened(cls, folder: Path) -> Store:
        """Open the folder of a sweep that was begun.

        Raises:
            InputError: there is none, or its plan is damaged.
        """
        try:
            document = json_document(folder / PLAN, "--out")
            store = cls(folder, Request.of(document))
        except FileNotFoundError:
            raise InputError("--out", str(folder), f"a folder of a sweep, with {PLAN}") from None
        except (ValueError, KeyError, TypeError, AttributeError, InputError):
            document, store = {}, None
        if store is None or store.request.hash != document.get("hash"):
            raise InputError("--out", str(folder), f"a {PLAN} as it was written", "It was changed: sweep anew.")
        store._made_with = str(document.get("pyarrow"))
        return store

    _made_with = PYARROW

    def check_versions(self) -> None:
        """Refuse to go on with versions that would write other bytes.

        Raises:
            InputError: they differ from the plan's.
        """
        from ..engines.registry import batches

        here = batches()[self.request.engine].identity
        for got, expected in (
            (here, self.request.identity),
            (f"pyarrow {PYARROW}", f"pyarrow {self._made_with}"),
        ):
            if got != expected:
                advice = "Install the versions that the sweep was begun with, or begin it anew in another folder."
                raise InputError("--out", got, f"{expected}, as in {self.folder / PLAN}", advice)

    def _make_folders(self) -> None:
        for name in self._folders:
            (self.folder / name).mkdir(exist_ok=True)

    @property
    def _folders(self) -> tuple[str, ...]:
        return (ROWS, TRANSITS) if self.request.wanted.times else (ROWS,)

    def path(self, part: int, kind: str = ROWS) -> Path:
        """Return the file of a part."""
        return self.folder / kind / f"part-{part:08d}.parquet"

    def missing(self) -> list[int]:
        """Return the parts that are not there yet, or not whole, or of another plan."""
        self._make_folders()
        return [
            part for part in range(self.request.parts) if not all(self._sound(part, kind) for kind in self._folders)
        ]

    def _sound(self, part: int, kind: str) -> bool:
        path = self.path(part, kind)
        if not path.exists():
            return False
        rows, plan = footer(path)
        return plan == self.request.hash and (kind == TRANSITS or rows == len(self.request.rows_of(part)))

    def save(self, part: int, solved: Part) -> None:
        """Write a part, whole or not at all.

        Raises:
            OSError: it cannot be written.
        """
        if solved.transits:
            self._write(self.path(part, TRANSITS), _TRANSIT_COLUMNS, solved.transits)
        self._write(self.path(part), self.request.columns, solved.columns)

    def _write(self, path: Path, columns: Iterable[Column], values: dict[str, Any]) -> None:
        data = parquet(columns, values, self.request.hash)
        replace_file(path, lambda stream: stream.write(data))

    def read(self, names: Iterable[str] | None = None, kind: str = ROWS) -> dict[str, Any]:
        """Return columns of the whole sweep as arrays, all if no names are given."""
        chosen = list(names) if names is not None else None
        return arrays([self.path(part, kind) for part in range(self.request.parts)], chosen)

    def read_part(self, part: int) -> dict[str, Any]:
        """Return the columns of one part as arrays."""
        return arrays([self.path(part)])

    def summarize(self, document: dict[str, Any]) -> None:
        """Write what became of the sweep."""
        _write_json(self.folder / SUMMARY, document)


def _foreign(path: Path) -> bool:
    """Return whether a file is none of those that a sweep leaves which was killed as it began."""
    return path.name not in (ROWS, TRANSITS, PLAN) and not path.name.startswith(f".{PLAN}.")


def _write_json(path: Path, document: dict[str, Any]) -> None:
    data = (json.dumps(document, indent=1, ensure_ascii=False) + "\n").encode()
    replace_file(path, lambda stream: stream.write(data))


def _differences(there: dict[str, Any], here: dict[str, Any]) -> str:
    return ", ".join(sorted(key for key in here if there.get(key) != here[key]))
