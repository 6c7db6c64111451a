"""Read a candidate or its transit times from a file or a stream; the first bytes tell text from a NumPy archive.

The number of bytes and rows and the length of a line are limited. Errors name the line.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from reference import InputError
from reference.precision import Array

from .archive import read_archive
from .candidate import Candidate, checked_transits
from .columns import ColumnReader
from .text import read_text


def read(source: str | Path) -> Candidate:
    """Read a candidate from a file, or from standard input if `source` is "-".

    Raises:
        InputError: the candidate cannot be read; the message names the line.
    """
    with _opened(source, "CANDIDATE", "a readable file, or - for standard input") as (stream, name):
        return read_stream(stream, name)


def read_stream(stream: BinaryIO, name: str) -> Candidate:
    """Read a candidate from a stream of bytes in any of the formats."""
    head = stream.read(4)
    return (read_archive if head.startswith(b"PK") else read_text)(stream, head, name)


def read_transits(source: str | Path) -> Array:
    """Read times of xdot = 0 in s from a CSV file with a column t, or from standard input if `source` is "-".

    Raises:
        InputError: the file cannot be read; the message names the line.
    """
    with _opened(source, "--transits", "a readable CSV file") as (stream, name):
        columns, _ = ColumnReader(name, ("t",)).columns(stream)
        return checked_transits(columns["t"], name)


@contextmanager
def _opened(source: str | Path, field: str, expected: str) -> Iterator[tuple[BinaryIO, str]]:
    """Yield the bytes of a file, or of standard input if `source` is "-", and the name for messages."""
    if str(source) == "-":
        yield sys.stdin.buffer, "standard input"
        return
    try:
        with Path(source).open("rb") as stream:
            yield stream, str(source)
    except OSError as error:
        raise InputError(field, str(source), expected, f"{error.strerror}.") from None
