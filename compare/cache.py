"""Where computed things are kept between runs: `$FOUCAULT_CACHE`, or the user's cache folder.

What is there is whole: it is written beside and renamed. What cannot be read is made again, and where nothing
can be written a temporary folder of this process serves.
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

KEEP = 40  # entries of one kind; the least recently used go first

T = TypeVar("T")


def root() -> Path:
    """The user's cache folder for this project, made or not."""
    named = os.environ.get("FOUCAULT_CACHE")
    if named:
        return Path(named)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "foucault" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "foucault"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "foucault"


@cache
def _spare() -> Path:
    made = Path(tempfile.mkdtemp(prefix="foucault-"))
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    return made


def is_lasting(folder: Path) -> bool:
    """True if a folder outlives this process."""
    return folder.is_relative_to(root())


def writable(kind: str) -> Path:
    """A folder for new entries of a kind: the user's, or a temporary one where that cannot be written."""
    for base in (root(), _spare):
        folder = (base if isinstance(base, Path) else base()) / kind
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except OSError:
            continue
    raise OSError(f"neither {root()} nor {tempfile.gettempdir()} can be written")


def found(kind: str, name: str) -> Path | None:
    """The entry of that name, where there is one; a cache that cannot be written is read all the same."""
    bases = [root(), *([_spare()] if _spare.cache_info().currsize else [])]
    paths = [base / kind / name for base in bases]
    return next((path for path in paths if path.exists()), None)


def kept(kind: str, name: str, make: Callable[[Path], None], read: Callable[[Path], T]) -> T:
    """What `read(path)` finds in the entry of that name, which `make(path)` writes where it is missing or damaged."""
    path = found(kind, name)
    if path is not None:
        with contextlib.suppress(Exception):  # whatever a damaged entry raises, it is made again
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
    ages = []
    for entry in folder.iterdir():
        with contextlib.suppress(OSError):  # another process prunes as well
            ages.append((entry.stat().st_mtime, entry))
    for _, old in sorted(ages, reverse=True)[KEEP:]:
        with contextlib.suppress(OSError):
            old.unlink()
