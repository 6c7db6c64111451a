"""Capture what compiled libraries write to this process's stdout and stderr, below Python's own streams.

Descriptors belong to the whole process: only one that was started to run methods is captured. In a user's process
libraries print where they like.
"""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_turn = threading.RLock()  # descriptors are the process's: of two threads the last to leave would restore the other's


own_process = False  # set in a process that was started to run methods


class Capture:
    """The output of a library; `data` is complete when the capture has ended."""

    def __init__(self) -> None:
        self.data = b""

    def words(self, longest: int = 300) -> str:
        """Return the output on one line, cut to `longest` characters, to be quoted in a message."""
        return " ".join(self.data.decode(errors="replace").split())[:longest]


@contextmanager
def captured(*descriptors: int) -> Iterator[Capture]:
    """Redirect file descriptors (1 for stdout, 2 for stderr) to a file while a library runs, in one thread at a time.

    What other threads print meanwhile is captured too. In a user's process nothing is.
    """
    if not own_process:
        yield Capture()
        return
    with _turn, tempfile.TemporaryFile() as handle:
        sys.stdout.flush()
        sys.stderr.flush()
        originals = [os.dup(descriptor) for descriptor in descriptors]
        capture = Capture()
        try:
            for descriptor in descriptors:
                os.dup2(handle.fileno(), descriptor)
            yield capture
        finally:
            ctypes.CDLL(None).fflush(None)  # empties the buffers of C's own streams
            for descriptor, original in zip(descriptors, originals, strict=True):
                os.dup2(original, descriptor)
                os.close(original)
            handle.seek(0)
            capture.data = handle.read()
