"""heyoka's log, which goes to the process's stdout: its only sign that an event may be lost."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any


@dataclass
class Watch:
    """What heyoka wrote to its log: its only sign that an event may be lost."""

    handle: Any
    seen: int = 0

    def fresh(self) -> bool:
        """True if a line came since the last look."""
        size = os.fstat(self.handle.fileno()).st_size
        changed, self.seen = size > self.seen, size
        return changed


@contextmanager
def watched_log() -> Iterator[Watch]:
    """Redirect the process's stdout, where heyoka logs, into a file; what others wrote is passed on."""
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
