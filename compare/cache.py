"""Cache results between runs in `$FOUCAULT_CACHE` or the user's cache folder.

An entry is written to a temporary file and renamed, so that it is never incomplete. A damaged entry is made again. If
the cache cannot be written, a temporary folder of this process takes its place.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TypeVar

KEEP = 40  # entries of one kind at most; the least recently used are deleted first

T = TypeVar("T")


def root() -> Path:
    """Return the user's cache folder for this project, whether it exists or not."""
    folder = os.environ.get("FOUCAULT_CACHE")
    if folder:
        return Path(folder)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "foucault" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "foucault"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "foucault"


@cache
def _temporary() -> Path:
    """Make the temporary folder that serves if the cache cannot be written; it is deleted when the process exits."""
    folder = Path(tempfile.mkdtemp(prefix="foucault-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def is_lasting(folder: Path) -> bool:
    """Return True if a folder outlives this process."""
    return folder.is_relative_to(root())


def writable(kind: str) -> Path:
    """Return a folder for new entries of a kind: in the cache, or a temporary one if that cannot be written."""
    for base in (root(), _temporary):
        folder = (base if isinstance(base, Path) else base()) / kind
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except OSError:
            continue
    raise OSError(f"neither {root()} nor {tempfile.gettempdir()} can be written")


def entry_path(kind: str, name: str) -> Path | None:
    """Return the path of an entry, or None if there is none; a cache that cannot be written is read all the same."""
    bases = [root(), *([_temporary()] if _temporary.cache_info().currsize else [])]
    paths = [base / kind / name for base in bases]
    return next((path for path in paths if path.exists()), None)


def load_or_make(kind: str, name: str, make: Callable[[Path], None], read: Callable[[Path], T]) -> T:
    """Return `read(path)` of the entry of that name; if it is missing or damaged, `make(path)` writes it first."""
    path = entry_path(kind, name)
    if path is not None:
        with contextlib.suppress(Exception):  # a damaged entry may raise anything; it is made again
            value = read(path)
            with contextlib.suppress(OSError):
                path.touch()
            return value
    folder = writable(kind)
    handle, draft = tempfile.mkstemp(dir=folder, suffix=Path(name).suffix)
    os.close(handle)
    try:
        make(Path(draft))
        os.replace(draft, folder / name)
    finally:
        Path(draft).unlink(missing_ok=True)
    _prune(folder)
    return read(folder / name)


def _prune(folder: Path) -> None:
    """Delete the entries that were used least recently."""
    ages = []
    for entry in folder.iterdir():
        with contextlib.suppress(OSError):  # another process may be deleting as well
            ages.append((entry.stat().st_mtime, entry))
    for _, old in sorted(ages, reverse=True)[KEEP:]:
        with contextlib.suppress(OSError):
            old.unlink()
