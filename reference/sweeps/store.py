"""A sweep on disk: a folder with its plan and its parts, each sealed.

`plan.json` has all that decides a number; `rows/part-00000000.parquet` … hold the rows,
`transits/part-…` their transits if these are wanted; `summary.json` is written last.
Each file is written whole or not at all. The seal of a
part covers the plan and the part's number: parts with a right seal are not computed again.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
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

PLAN = "plan.json"
SUMMARY = "summary.json"
_ROWS = "rows"
TRANSITS = "transits"
_PARQUET = ("pyarrow", "sweep", "--out", "a folder of Parquet files")  # arguments of `needed`
_MOST_BYTES = 1 << 40  # of a part: the limit is that of a disk


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
        """Create the folder of a sweep, or open it to resume the same sweep.

        Raises:
            InputError: it holds another sweep, or something else, or other versions would write
                other bytes, or it cannot be written.
        """
        if (folder / PLAN).exists():
            store = cls.opened(folder)
            store._check_same(request)
        else:
            needed(*_PARQUET)
            _check_empty(folder)
            store = cls(folder, request, version("pyarrow"))
        with usable("--out", folder):
            for kind in store._kinds:
                (folder / kind).mkdir(parents=True, exist_ok=True)
                # a part that is there is not written again, which would clear it
                clear(folder / kind)
            clear(folder)
        if not (folder / PLAN).exists():
            plan = {"hash": request.hash, "pyarrow": store.pyarrow, **request.document()}
            _write_json(folder / PLAN, plan)
        return store

    @classmethod
    def opened(cls, folder: Path) -> Store:
        """Open the folder of a sweep that was begun.

        Raises:
            InputError: there is none, or its plan is damaged.
        """
        needed(*_PARQUET)
        try:
            document = json_document(folder / PLAN, "--out")
            request = Request.of(document)
            unchanged = request.hash == document["hash"]
        except FileNotFoundError:
            expected = f"the folder of a sweep, with {PLAN}"
            advice = "To begin a sweep, give a scene and --over."
            raise InputError("--out", str(folder), expected, advice) from None
        except (ValueError, KeyError, TypeError, AttributeError, InputError):
            unchanged = False
        if not unchanged:
            expected = f"a {PLAN} written by this version and not changed"
            raise InputError(
                "--out", str(folder), expected, "Begin the sweep again in another folder."
            )
        return cls(folder, request, str(document.get("pyarrow")))

    def _check_same(self, request: Request) -> None:
        """Refuse to go on with another sweep, or with versions that would write other bytes.

        Raises:
            InputError: it differs from the plan.
        """
        stored = self.request.document()
        requested = request.document()
        keys = sorted(requested.keys() - {"identity"})  # the identity has versions, compared below
        differing = [
            key for key in keys if json.dumps(stored.get(key)) != json.dumps(requested[key])
        ]
        if differing:
            expected = (
                f"the same sweep as the one in the folder, which differs in {', '.join(differing)}"
            )
            raise InputError("--out", str(self.folder), expected, "Choose another folder.")
        versions = {
            request.identity: self.request.identity,
            f"pyarrow {version('pyarrow')}": f"pyarrow {self.pyarrow}",
        }
        for got, expected in versions.items():
            if got != expected:
                advice = "Install the versions with which the sweep began, or begin it again in another folder."
                raise InputError("--out", got, f"{expected}, as in {self.folder / PLAN}", advice)

    @property
    def _kinds(self) -> tuple[str, ...]:
        """The kinds of files that each part has."""
        return (_ROWS, TRANSITS) if self.request.run_options.times else (_ROWS,)

    def path(self, part: int, kind: str = _ROWS) -> Path:
        """Return the file of a part."""
        return self.folder / kind / f"part-{part:08d}.parquet"

    def missing(self) -> list[int]:
        """Return the parts that are missing or damaged, or have the seal of another part."""
        return [part for part in range(self.request.parts) if not self._is_complete(part)]

    def _is_complete(self, part: int) -> bool:
        """Return whether all files of a part exist with the right seal."""
        return all(self._is_sound(part, kind) for kind in self._kinds)

    def _is_sound(self, part: int, kind: str) -> bool:
        """Return whether the file of a part exists with the right seal."""
        path = self.path(part, kind)
        try:
            with regular(path, "--out", _MOST_BYTES, "a part") as stream:
                return is_sealed(stream.read(), self._named(part, kind))
        except (FileNotFoundError, InputError):
            return False

    def _named(self, part: int, kind: str) -> str:
        """Return the name of a part that its seal covers."""
        return f"{kind} {part} of {self.request.hash}"

    def save(self, part: int, solved: Part) -> None:
        """Write a part completely or not at all.

        Raises:
            InputError: it cannot be written.
        """
        tables = {
            _ROWS: (self.request.columns, solved.columns),
            TRANSITS: (TRANSIT_COLUMNS, solved.transits),
        }
        for kind in self._kinds:
            described, columns = tables[kind]
            _write(self.path(part, kind), parquet(described, columns, self._named(part, kind)))

    def finish(self, summary: dict[str, Any]) -> None:
        """Write the summary, and the checksums of the files that have no seal of their own.

        Raises:
            InputError: they cannot be written.
        """
        _write_json(self.folder / SUMMARY, summary)
        files = {name: (self.folder / name).read_bytes() for name in (PLAN, SUMMARY)}
        _write(self.folder / SUMS, sums_text(files).encode())

    def foreign(self) -> list[str]:
        """Return the files in the folder that do not belong to the sweep, by their paths in it.

        Names that begin with a dot are left out, as programs that read Parquet do.
        """
        own = {self.path(part, kind) for kind in self._kinds for part in range(self.request.parts)}
        present: set[Path] = set()
        for kind in (_ROWS, TRANSITS):
            present.update((self.folder / kind).glob("[!.]*"))
        return sorted(str(path.relative_to(self.folder)) for path in present - own)

    def read(
        self, names: list[str] | None = None, kind: str = _ROWS, parts: Iterable[int] | None = None
    ) -> dict[str, Any]:
        """Return columns of the concatenated parts as arrays; all columns if none are named.

        Raises:
            InputError: a part was damaged or lost since its seal was checked.
        """
        chosen = range(self.request.parts) if parts is None else parts
        try:
            return arrays([self.path(part, kind) for part in chosen], names)
        except OSError as error:
            advice = f"{error.strerror or error}. Resume with `foucault sweep --out {self.folder}`."
            raise InputError("sweep", str(self.folder), "parts that can be read", advice) from None


def _check_empty(folder: Path) -> None:
    """Raise InputError unless a folder is new, empty, or that of a sweep killed as it began."""
    if not folder.exists():
        return
    if not folder.is_dir() or any(_is_foreign(path) for path in folder.iterdir()):
        raise InputError("--out", str(folder), "a new or empty folder, or the folder of this sweep")


def _is_foreign(path: Path) -> bool:
    """Return whether a sweep that was killed as it began cannot have left a file."""
    return path.name not in (_ROWS, TRANSITS, PLAN) and not path.name.startswith(f".{PLAN}.")


def _write_json(path: Path, document: dict[str, Any]) -> None:
    """Write a document of a sweep, whole or not at all."""
    _write(path, (plain_json(document) + "\n").encode())


def _write(path: Path, data: bytes) -> None:
    with usable("--out", path, "a file that can be written"):
        replace_file(path, lambda stream: stream.write(data))
