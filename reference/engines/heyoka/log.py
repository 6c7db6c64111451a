"""heyoka's log, captured from the process's stdout: the only sign that an event may be lost."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any


@dataclass
class Watch:
    """The captured log: heyoka writes a line where an event may be lost.

    Attributes:
        handle: the file that stdout is redirected to.
        size_before: its size at the last call of `fresh`, in bytes.
    """

    handle: Any
    size_before: int = 0

    def fresh(self) -> bool:
        """Return whether anything was written since the last call."""
        size = os.fstat(self.handle.fileno()).st_size
        changed, self.size_before = size > self.size_before, size
        return changed


@contextmanager
def watched_log() -> Iterator[Watch]:
    """Redirect the process's stdout, where heyoka logs, into a file; lines of others are passed on at the end."""
    saved = os.dup(1)
    with tempfile.TemporaryFile() as handle:
        os.dup2(handle.fileno(), 1)
        try:
            yield Watch(handle)
        finally:
            os.dup2(saved, 1)
            os.close(saved)
            handle.seek(0)
            for line in handle:
                if b"[heyoka-" not in line:
                    os.write(1, line)
