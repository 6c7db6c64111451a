"""Open a file that a user names: without waiting for a writer, as the opening of a named pipe would."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import BinaryIO


def open_at_once(path: Path) -> BinaryIO:
    """Open a file for reading; a pipe is returned unblocked, so that a read tells whether anybody writes to it.

    Raises:
        OSError: it cannot be opened; also for a path that no file can have, such as one with a zero byte.
    """
    try:
        return open(path, "rb", opener=_unblocked)
    except ValueError as error:
        raise OSError(errno.EINVAL, f"No file has this path, {error}") from None


def _unblocked(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_NONBLOCK)
