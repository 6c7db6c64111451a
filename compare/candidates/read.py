"""Read a candidate from a file or a stream: the first bytes tell text (CSV, foucPend's output) from a NumPy archive.

The number of bytes and rows and the length of a line are limited. Errors name the line.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import BinaryIO

from reference import InputError

from .archive import read_archive
from .candidate import Candidate
from .lines import MAX_BYTES
from .text import MAX_ROWS, Text
from .transit_times import checked_transits, read_transits

__all__ = ["MAX_BYTES", "MAX_ROWS", "checked_transits", "read", "read_stream", "read_transits"]


def read(source: str | Path) -> Candidate:
    """Read a candidate from a file, or from standard input if `source` is "-".

    Raises:
        InputError: the candidate cannot be read; the message names the line.
    """
    if str(source) == "-":
        return read_stream(sys.stdin.buffer, "standard input")
    try:
        with Path(source).open("rb") as stream:
            return read_stream(stream, str(source))
    except OSError as error:
        raise InputError(
            "CANDIDATE", str(source), "a readable file, or - for standard input", f"{error.strerror}."
        ) from None


def read_stream(stream: BinaryIO, name: str) -> Candidate:
    """Read a candidate from a stream of bytes in any of the formats."""
    head = stream.read(4)
    return read_archive(stream, head, name) if head.startswith(b"PK") else Text(name).read(stream, head)
