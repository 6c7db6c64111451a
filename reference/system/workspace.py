"""Write a file or a folder completely or not at all: into a hidden folder beside it, then renamed.

What killed processes left behind is removed later. A folder in use is locked by a file in it.
Process numbers would not do: they repeat in containers, and where several machines share a disk. On
a disk without locks nothing is removed.
"""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from .interruption import held

OLD = "old"  # what stood in the place of the target, while it is moved out of the way
_LOCK = "lock"
_LEFT_BEHIND = re.compile(r"\.(.+)\.partial-\w+", re.DOTALL)


@contextmanager
def workspace(parent: Path, name: str) -> Iterator[Path]:
    """Yield a new folder in `parent` in which to make `name`; remove it at the end.

    Folders that killed processes left behind for the same name are removed first. If `parent/name`
    is missing in the end and `OLD` is in the folder, that is put back.

    Raises:
        OSError: `parent` cannot be written.
    """
    # imported late: it takes longer than the rest of a short command
    from filelock import FileLock, Timeout

    clear(parent, name)
    while True:
        made: list[tuple[Path, FileLock]] = []
        try:
            with held():  # a signal comes before the folder is there, or when it is known
                folder = Path(tempfile.mkdtemp(prefix=f".{name}.partial-", dir=parent))
                lock = FileLock(folder / _LOCK, blocking=False)
                made.append((folder, lock))
            try:
                lock.acquire()
            except (Timeout, FileNotFoundError):  # another process is removing it as left behind
                continue
            except (OSError, NotImplementedError):  # this disk has no locks
                pass
            yield folder
            return
        finally:
            for folder, lock in made:
                try:
                    lock.release()
                    _remove(folder, parent / name)
                except BaseException:  # Ctrl-C, just now
                    _remove(folder, parent / name)
                    raise


def replace_file(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Let `write(stream)` write a file, which then replaces the old one in one step.

    Raises:
        OSError: the disk is full or cannot be written.
    """
    target = path.resolve()
    with workspace(target.parent, target.name) as work:
        with (work / "new").open("wb") as stream:
            write(stream)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(work / "new", target)


def clear(parent: Path, name: str | None = None) -> None:
    """Remove from a folder what killed processes left behind for a name, or for any name.

    What a living process has locked stays.
    """
    from filelock import FileLock

    for path in list(parent.iterdir()):
        match = _LEFT_BEHIND.fullmatch(path.name)
        if match and name in (None, match[1]):
            with suppress(OSError, NotImplementedError), FileLock(path / _LOCK, blocking=False):
                _remove(path, parent / match[1])


def _remove(folder: Path, target: Path) -> None:
    if (folder / OLD).exists() and not os.path.lexists(target):
        (folder / OLD).rename(target)
    shutil.rmtree(folder, ignore_errors=True)
