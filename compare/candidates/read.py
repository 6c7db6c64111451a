"""Read a candidate or its transit times from a file or a stream; the first bytes tell text from a NumPy archive.

The number of bytes and rows and the length of a line are limited. Errors name the line.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from reference import InputError
from reference.opening import open_at_once
from reference.plain_text import plain
from reference.precision import Array

from .archive import read_archive
from .candidate import Candidate, checked_transits
from .columns import ColumnReader
from .text import read_text

_TELLING = 4  # bytes that tell an archive from text


def read(source: str | Path) -> Candidate:
    """Read a candidate from a file, or from standard input if `source` is "-".

    Raises:
        InputError: the candidate cannot be read; the message names the line.
    """
    with _opened(source, "CANDIDATE", "a readable file, or - for standard input") as (stream, head, name):
        return read_stream(stream, name, head)


def read_stream(stream: BinaryIO, name: str, head: bytes = b"") -> Candidate:
    """Read a candidate in any of the formats from a stream of bytes, of which `head` has been read already."""
    head += stream.read(_TELLING - len(head))
    return (read_archive if head.startswith(b"PK") else read_text)(stream, head, name)


def read_transits(source: str | Path) -> Array:
    """Read times of xdot = 0 in s from a CSV file with a column t, or from standard input if `source` is "-".

    Raises:
        InputError: the file cannot be read; the message names the line.
    """
    with _opened(source, "--transits", "a readable CSV file") as (stream, head, name):
        columns, _ = ColumnReader(name, ("t",)).columns(stream, head)
        return checked_transits(columns["t"], name)


@contextmanager
def _opened(source: str | Path, field: str, expected: str) -> Iterator[tuple[BinaryIO, bytes, str]]:
    """Yield a file, or standard input if `source` is "-": stream, bytes read from it already, name for messages."""
    try:
        if str(source) == "-":
            if sys.stdin is None:
                raise OSError(errno.EBADF, "Standard input is closed")
            yield sys.stdin.buffer, b"", "standard input"
            return
        with open_at_once(Path(source)) as stream:
            head = _first_of_pipe(stream) if stat.S_ISFIFO(os.fstat(stream.fileno()).st_mode) else b""
            os.set_blocking(stream.fileno(), True)
            yield stream, head, plain(str(source))
    except OSError as error:
        raise InputError(field, str(source), expected, f"{error.strerror}.") from None


def _first_of_pipe(stream: BinaryIO) -> bytes:
    """Return the first bytes of a pipe, none if its writer has not written yet; refuse one without a writer."""
    try:
        head = os.read(stream.fileno(), _TELLING)
    except BlockingIOError:
        return b""
    if not head:
        raise OSError(errno.EPIPE, "Nobody writes to this pipe: start the program first, or let --run start it")
    return head
