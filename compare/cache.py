"""Where computed things are kept between runs: `$FOUCAULT_CACHE`, or the user's cache folder."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

KEEP = 40  # entries of one kind; the least recently used go first


def cache_folder(kind: str) -> Path:
    """The folder for one kind of entry, made if need be."""
    named = os.environ.get("FOUCAULT_CACHE")
    if named:
        root = Path(named)
    elif sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA", Path.home())) / "foucault" / "cache"
    elif sys.platform == "darwin":
        root = Path.home() / "Library" / "Caches" / "foucault"
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "foucault"
    folder = root / kind
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def kept(kind: str, name: str, make: Callable[[Path], None]) -> Path:
    """The file of that name, made by `make(path)` where it is missing: whole or not at all.

    Falls back to a temporary folder where the cache cannot be written.
    """
    try:
        folder = cache_folder(kind)
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="foucault-"))
    path = folder / name
    if path.exists():
        path.touch()
        return path
    handle, draft = tempfile.mkstemp(dir=folder, suffix=path.suffix)
    os.close(handle)
    try:
        make(Path(draft))
        os.replace(draft, path)
    finally:
        Path(draft).unlink(missing_ok=True)
    _prune(folder)
    return path


def _prune(folder: Path) -> None:
    for old in sorted(folder.iterdir(), key=lambda entry: entry.stat().st_mtime, reverse=True)[KEEP:]:
        if old.is_file():
            old.unlink(missing_ok=True)
