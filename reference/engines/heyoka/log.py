"""heyoka's log, captured from the process's stdout: the only sign that an event may be lost."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from ...system.capture import Capture, captured


@contextmanager
def watched_log() -> Iterator[Capture]:
    """Capture the process's stdout, where heyoka logs; lines of others are passed on at the end."""
    capture = None
    try:
        with captured(1) as capture:
            yield capture
    finally:
        for line in capture.data.splitlines(keepends=True) if capture else ():
            if b"[heyoka-" not in line:
                os.write(1, line)
