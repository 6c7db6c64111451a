"""What a compiled library writes to the process's stdout and stderr: kept from the user's, and read for reasons."""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

LONGEST = 300  # characters of what was written that a reason quotes


class Said:
    """What was written while it was listened to; complete after the end."""

    text = ""


@contextmanager
def listened() -> Iterator[Said]:
    """Redirect file descriptors 1 and 2 into a file while a library works."""
    said, flush = Said(), ctypes.CDLL(None).fflush if os.name == "posix" else None
    sys.stdout.flush()
    sys.stderr.flush()
    kept = os.dup(1), os.dup(2)
    with tempfile.TemporaryFile() as handle:
        try:
            for descriptor in (1, 2):
                os.dup2(handle.fileno(), descriptor)
            yield said
        finally:
            if flush is not None:
                flush(None)  # C's own buffers
            for descriptor, copy in enumerate(kept, start=1):
                os.dup2(copy, descriptor)
                os.close(copy)
            handle.seek(0)
            said.text = " ".join(handle.read(10 * LONGEST).decode(errors="replace").split())[:LONGEST]
