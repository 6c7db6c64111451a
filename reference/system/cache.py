"""Cache results between runs in `$FOUCAULT_CACHE` or the user's cache folder.

An entry is put in place at once, so that it is never incomplete; a damaged one is made again. A cache that cannot be
used costs time only: a temporary folder of this process and its children takes its place, and one line says so.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np

from ..errors import InputError
from ..numbers.precision import Array
from .workspace import replace_file, workspace

KEEP = 40  # entries of one kind at most; the least recently used are deleted first
_ROOM = bytes(1 << 18)  # a disk without room for this much is full
_SPARE = "FOUCAULT_SPARE_CACHE"  # tells child processes of the temporary folder
_NAME = "entry"  # array of an entry that holds its name


def root() -> Path:
    """Return the user's cache folder for this project, whether it exists or not; a temporary one without a home."""
    folder = os.environ.get("FOUCAULT_CACHE")
    if folder:
        return Path(folder)
    try:
        if sys.platform == "win32":
            return Path(os.environ.get("LOCALAPPDATA") or Path.home()) / "foucault" / "cache"
        if sys.platform == "darwin":
            return Path.home() / "Library" / "Caches" / "foucault"
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "foucault"
    except RuntimeError:
        return _spare("this user has no home folder for a cache (FOUCAULT_CACHE names another)") or Path(os.devnull)


def entry(kind: str, name: str, *, executed: bool = False) -> Path | None:
    """Return the path of an entry, or None if there is none; a cache that cannot be written is read all the same.

    Args:
        kind: the folder of the entry.
        name: its name there.
        executed: whether it is code: then only a folder into which nobody else can write counts.
    """
    spare = os.environ.get(_SPARE)
    bases = [root(), *([Path(spare)] if spare else [])]
    places = [base / kind / name for base in bases if not (executed and _distrust(base, kind))]
    return next((place for place in places if os.path.lexists(place)), None)


def store(kind: str, name: str, put: Callable[[Path], object], *, executed: bool = False) -> Path | None:
    """Have `put(path)` write an entry, all or nothing; return its path, or None if it can be kept nowhere.

    It goes into the cache, or into the temporary folder if that cannot be written. What is in its way is removed.
    """
    for folder in _folders(kind, executed):
        path = folder / name
        if path.is_symlink():  # no entry is one; what is written to it would land elsewhere
            discard(path)
        try:
            try:
                put(path)
            except (OSError, InputError):
                if not os.path.lexists(path):
                    raise
                discard(path)
                put(path)
        except (OSError, InputError) as error:
            _spare(_unwritable(error))
        else:
            return path
    return None


def prepare() -> None:
    """Choose the place for new entries before child processes do, so that they share it, and only one line says so."""
    next(_folders("generated", executed=True), None)


def _folders(kind: str, executed: bool) -> Iterator[Path]:
    """Yield the folders into which an entry may go, best first."""
    base = root()
    try:
        base.mkdir(mode=0o700, parents=True, exist_ok=True)
        (base / kind).mkdir(exist_ok=True)
        with tempfile.TemporaryFile(dir=base / kind, buffering=0) as probe:
            probe.write(_ROOM)
    except OSError as error:
        doubt = _unwritable(error)
    else:
        doubt = _distrust(base, kind) if executed else ""
    if not doubt:
        yield base / kind
    with contextlib.suppress(OSError):
        spare = _spare(doubt)
        if spare is not None:
            (spare / kind).mkdir(exist_ok=True)
            yield spare / kind


def _unwritable(error: Exception) -> str:
    reason = error.strerror if isinstance(error, OSError) else getattr(error, "advice", "").rstrip(".")
    return f"the cache {root()} cannot be written ({reason or error})"


def _distrust(base: Path, kind: str) -> str:
    """Return why code must not be executed from a folder of a cache, or nothing."""
    if not hasattr(os, "getuid"):
        return ""
    for place in (base, base / kind, base / kind / "__pycache__"):
        try:
            status = place.stat()
        except OSError:
            continue
        if status.st_uid != os.getuid():
            return f"code is not taken from {place}, which belongs to another user"
        if status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
            return f"code is not taken from {place}, into which others can write (chmod 700 {base} ends that)"
        if place == base and not status.st_mode & (stat.S_IXGRP | stat.S_IXOTH):
            break  # nobody else gets any further
    return ""


def _spare(why: str) -> Path | None:
    """Return the temporary folder of this process and its children; None if there can be none. Its maker says why."""
    known = os.environ.get(_SPARE)
    if known == os.devnull:
        return None
    if known and Path(known).is_dir():
        return Path(known)
    print(f"foucault: {why}; results are kept for this run only.", file=sys.stderr)
    folder = None
    with contextlib.suppress(OSError):
        work = workspace(Path(tempfile.gettempdir()), "foucault")
        folder = work.__enter__()
        atexit.register(work.__exit__, None, None, None)
    os.environ[_SPARE] = os.devnull if folder is None else str(folder)
    return folder


def discard(path: Path) -> None:
    """Remove an entry, file or folder, that is damaged or in the way, if that is allowed."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            path.unlink()


def arrays(kind: str, name: str, make: Callable[[], dict[str, Array]]) -> dict[str, Array]:
    """Return the arrays of an entry; `make()` computes them if it is missing, damaged, or another's under its name."""
    path = entry(kind, name)
    if path is not None:
        with contextlib.suppress(Exception):  # a damaged entry may raise anything; it is made again
            found = _read(path)
            if found.pop(_NAME) == name:
                with contextlib.suppress(OSError):
                    path.touch()
                return found
    made = make()

    def write(stream: BinaryIO) -> None:
        np.savez(stream, allow_pickle=False, **{_NAME: np.array(name)}, **made)

    path = store(kind, name, lambda path: replace_file(path, write))
    if path is not None:
        _prune(path.parent)
    return made


def _read(path: Path) -> dict[str, Array]:
    with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
        if archive.zip.testzip() is not None:
            raise OSError("damaged")
        return {key: archive[key] for key in archive.files}


def _prune(folder: Path) -> None:
    """Delete the entries that were used least recently."""
    ages = []
    for path in folder.glob("[!.]*"):
        with contextlib.suppress(OSError):  # another process may be deleting as well
            ages.append((path.stat().st_mtime, path))
    for _, old in sorted(ages, reverse=True)[KEEP:]:
        with contextlib.suppress(OSError):
            old.unlink()
