"""Capture what compiled libraries write to this process's stdout and stderr, below Python's own streams."""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from typing import BinaryIO


class Capture:
    """The output of a library, as it is written; `data` is complete when the capture has ended."""

    def __init__(self, handle: BinaryIO) -> None:
        self._handle, self._seen = handle, 0
        self.data = b""

    @property
    def size(self) -> int:
        """Bytes written so far; only while the capture lasts."""
        return os.fstat(self._handle.fileno()).st_size

    def fresh(self) -> bool:
        """Return whether anything was written since the last call; only while the capture lasts."""
        size = self.size
        changed, self._seen = size > self._seen, size
        return changed

    def words(self, longest: int = 300) -> str:
        """Return the output on one line, cut to `longest` characters, to be quoted in a message."""
        return " ".join(self.data.decode(errors="replace").split())[:longest]


@contextmanager
def captured(*descriptors: int) -> Iterator[Capture]:
    """Redirect file descriptors (1 for stdout, 2 for stderr) to a file while a library runs."""
    flush = ctypes.CDLL(None).fflush if os.name == "posix" else None
    sys.stdout.flush()
    sys.stderr.flush()
    originals = [os.dup(descriptor) for descriptor in descriptors]
    with tempfile.TemporaryFile() as handle:
        capture = Capture(handle)
        try:
            for descriptor in descriptors:
                os.dup2(handle.fileno(), descriptor)
            yield capture
        finally:
            if flush is not None:
                flush(None)  # empty the buffers of C's own streams
            for descriptor, original in zip(descriptors, originals, strict=True):
                os.dup2(original, descriptor)
                os.close(original)
            handle.seek(0)
            capture.data = handle.read()
