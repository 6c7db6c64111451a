"""Cache results between runs in `$FOUCAULT_CACHE` or the user's cache folder.

An entry is put in place at once, so that it is never incomplete; a damaged one is made again. A
cache that cannot be used costs time only, and one line says so.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import numpy as np
from platformdirs import user_cache_path

from ..errors import InputError
from ..numbers.precision import Array
from .workspace import replace_file, workspace

KEEP = 40  # entries of one kind at most; the least recently used are deleted first
_ROOM = bytes(1 << 18)  # a disk without room for this much is full
_PRINTED = "FOUCAULT_CACHE_SAID"  # tells child processes, too, that the line was printed


def root() -> Path:
    """Return the user's cache folder for this project, whether it exists or not.

    Raises:
        RuntimeError: this user has no home folder.
    """
    path = os.environ.get("FOUCAULT_CACHE") or user_cache_path("foucault", appauthor=False)
    return Path(path).expanduser()


def entry(kind: str, name: str) -> Path | None:
    """Return the path of an entry, which may be damaged; None if there is no entry or it is not trusted.

    Args:
        kind: the folder of the entry.
        name: its name there.
    """
    folder = _folder(kind)
    return folder / name if folder is not None and os.path.lexists(folder / name) else None


def store(kind: str, name: str, put: Callable[[Path], object]) -> Path | None:
    """Let `put(path)` write an entry, completely or not at all; return its path.

    Return None if the cache cannot be used.
    """
    folder = _folder(kind)
    if folder is None:
        return None
    try:
        put(folder / name)
    except (OSError, InputError) as error:
        reason = error.advice.rstrip(".") if isinstance(error, InputError) else error.strerror
        _say(f"{folder} cannot be written ({reason})")
        return None
    return folder / name


def kept(kind: str, name: str, put: Callable[[Path], object]) -> Path:
    """Return the path of an entry; `put(path)` writes it if it is missing.

    Without a cache it lasts as long as this process.
    """
    path = entry(kind, name) or store(kind, name, put)
    if path is None:
        path = temporary() / name
        if not path.exists():
            put(path)
    return path


def check() -> None:
    """Check that the cache can be used before child processes use it; otherwise give them a temporary one.

    Then only one line says so, they compile once for all, and leave nothing behind if they are
    killed.
    """
    path = store("generated", ".room", _write_room)
    if path is not None:
        discard(path)
    else:
        os.environ["FOUCAULT_CACHE"] = str(temporary())


def _write_room(path: Path) -> None:
    replace_file(path, lambda stream: stream.write(_ROOM))


def _folder(kind: str) -> Path | None:
    """Return the folder of the entries of one kind, made if need be; None if it cannot be used."""
    try:
        base = root()
        folder = base / kind
        base.mkdir(mode=0o700, parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
        doubt = _distrust(base) or _distrust(folder)
    except RuntimeError:
        doubt = "this user has no home folder (FOUCAULT_CACHE names another)"
    except OSError as error:
        doubt = f"{folder} cannot be written ({error.strerror})"
    if doubt:
        _say(doubt)
        return None
    return folder


def _distrust(folder: Path) -> str:
    """Return why the contents of the cache, code among them, are not trusted; empty if they are."""
    status = folder.stat()
    if status.st_uid != os.getuid():
        return f"{folder} belongs to another user"
    if status.st_mode & 0o022:
        return f"others can write into {folder} (chmod 700 {folder} ends that)"
    return ""


def _say(why: str) -> None:
    """Say once, in this process and its children, why the cache cannot be used."""
    if not os.environ.get(_PRINTED):
        os.environ[_PRINTED] = "1"
        print(
            f"foucault: running without the cache, which only takes longer: {why}.", file=sys.stderr
        )


@functools.cache
def temporary() -> Path:
    """Return a temporary folder that is removed when this process ends, for use without a cache."""
    stack = contextlib.ExitStack()
    atexit.register(stack.close)
    return stack.enter_context(workspace(Path(tempfile.gettempdir()), "foucault"))


def discard(path: Path) -> None:
    """Remove an entry (a file or folder) that is damaged or in the way, if permissions allow it."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with contextlib.suppress(OSError):
            path.unlink()


def arrays(kind: str, name: str, make: Callable[[], dict[str, Array]]) -> dict[str, Array]:
    """Return the arrays of an entry; `make()` computes them if the entry is missing or damaged."""
    path = entry(kind, name)
    if path is not None:
        with contextlib.suppress(Exception):  # a damaged entry may raise anything; it is made again
            with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
                stored = dict(archive)
            with contextlib.suppress(OSError):
                path.touch()
            return stored
        discard(path)
    computed = make()

    def write(stream: BinaryIO) -> None:
        np.savez(stream, allow_pickle=False, **computed)

    path = store(kind, name, lambda path: replace_file(path, write))
    if path is not None:
        with contextlib.suppress(OSError):  # another process may be deleting as well
            entries = sorted(path.parent.glob("[!.]*"), key=lambda entry: entry.stat().st_mtime)
            for old in entries[:-KEEP]:
                old.unlink()
    return computed
