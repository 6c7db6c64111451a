"""Capture what compiled libraries write to stdout and stderr: the terminal stays clean, failures can be quoted."""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

LONGEST = 300  # characters of a message that a reason quotes


class Said:
    """The text that was written; complete when the capture has ended."""

    text = ""


@contextmanager
def listened() -> Iterator[Said]:
    """Redirect file descriptors 1 and 2 to a file while a library runs."""
    output, flush = Said(), ctypes.CDLL(None).fflush if os.name == "posix" else None
    sys.stdout.flush()
    sys.stderr.flush()
    originals = os.dup(1), os.dup(2)
    with tempfile.TemporaryFile() as handle:
        try:
            for descriptor in (1, 2):
                os.dup2(handle.fileno(), descriptor)
            yield output
        finally:
            if flush is not None:
                flush(None)  # empty the buffers of C's own streams
            for descriptor, copy in enumerate(originals, start=1):
                os.dup2(copy, descriptor)
                os.close(copy)
            handle.seek(0)
            output.text = " ".join(handle.read(10 * LONGEST).decode(errors="replace").split())[:LONGEST]
