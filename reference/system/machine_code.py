"""Machine code that numba keeps on disk, in a folder named by the sources that it is compiled from.

numba itself checks only the file of a function: after a change of what the function calls it would
use old machine code. If several processes need a function, one compiles it; the others wait and
load what it has kept.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from contextlib import ExitStack, suppress
from hashlib import sha256
from pathlib import Path
from threading import Lock
from typing import Any, TypeVar

from .channel import ACTIVITY, ANNOUNCEMENTS

Function = TypeVar("Function", bound=Callable[..., Any])
_HERE = Path(__file__).parent
_PATIENCE_S = 120.0  # the longest wait for another process that compiles the same function
_declaring = Lock()
_announced: set[str] = set()


def _announce(what: str, seconds: int) -> None:
    """Announce once in a process that `what` is compiled, and that this takes about `seconds`."""
    if what not in _announced and ANNOUNCEMENTS.heard:
        _announced.add(what)
        ANNOUNCEMENTS.send(
            f"First use on this machine: {what} are compiled, once, for about {seconds} seconds."
        )


def folder_of(sources: Iterable[Path]) -> Path | None:
    """Return the folder for machine code compiled from these files; None if it cannot be kept.

    It is in `$NUMBA_CACHE_DIR`; else in `__pycache__` here; else, if this package cannot be
    written, in the user's cache.
    """
    hashes = [sha256(path.read_bytes()).digest() for path in sorted(sources)]
    name = f"foucault-{sha256(b''.join(hashes)).hexdigest()[:32]}"
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        return Path(chosen, name)
    if os.access(_HERE, os.W_OK):
        return _HERE / "__pycache__" / name
    from .cache import store  # and NumPy, which `foucault --help` does not need

    return store("machine_code", name, lambda path: path.mkdir(exist_ok=True))


def kept_variants(name: str, folder: Path | str | None) -> int:
    """Return for how many types of arguments there is machine code of a function in a folder."""
    return 0 if folder is None else len([*Path(folder).rglob(f"*.{name}-*.nbc")])


def kept(*sources: Path, **options: Any) -> Callable[[Function], Function]:
    """Return a decorator that compiles with numba, and keeps the machine code on disk.

    Args:
        sources: all files that the function is made of; its own if none is named.
        options: numba's.
    """

    def declared(function: Any) -> Any:
        from numba import config, njit

        folder = folder_of(sources or [Path(function.__code__.co_filename)])
        if folder is not None:
            with _declaring, suppress(RuntimeError):  # numba finds no folder at all
                before = config.CACHE_DIR
                config.CACHE_DIR = str(folder)
                try:
                    compiled = njit(cache=True, **options)(function)
                finally:
                    config.CACHE_DIR = before
                # otherwise numba chose a folder of its own, which does not depend on the sources
                if Path(compiled.stats.cache_path).is_relative_to(folder):
                    return compiled
        return njit(**options)(function)

    return declared


def prepare(function: Any, what: str, seconds: int, *arguments: Any) -> None:
    """Compile a `kept` function for arguments like these, or load it, once per process.

    Args:
        function: what to compile.
        what: what it is, in the plural, for the line that announces a compilation.
        seconds: that it takes, about.
        arguments: as in a call.
    """
    from filelock import FileLock
    from numba import typeof

    types = tuple(map(typeof, arguments))
    folder = function.stats.cache_path
    if types in function.signatures:
        return
    if kept_variants(function.__name__, folder) <= len(function.signatures):
        _announce(what, seconds)
        ACTIVITY.send(f"compiling {what}, once")
    with ExitStack() as turn:
        if folder is not None:
            lock = FileLock(Path(folder, f"{function.__name__}.lock"), timeout=_PATIENCE_S)
            # after a long wait, or on a disk without locks, it is compiled a second time
            with suppress(OSError):
                turn.enter_context(lock)
        with suppress(OSError):  # the disk is full: it is compiled, and not kept
            function.compile(types)
