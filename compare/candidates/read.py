"""Read a candidate or its transit times from a file or a stream; the first bytes tell text from a NumPy archive.

The number of bytes and rows and the length of a line are limited. Errors name the line.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from reference import InputError
from reference.errors import plain
from reference.numbers.precision import Array
from reference.system.documents import open_at_once

from .archive import read_archive, read_array
from .candidate import Candidate, checked_transits
from .layout import Naming
from .text import ColumnReader, read_text

_TELLING = 6  # bytes that tell an archive from text
_READERS = {b"PK": read_archive, b"\x93NUMPY": read_array}


def read(source: str | Path, *, columns: Sequence[str] = (), units: Sequence[str] = ()) -> Candidate:
    """Read a candidate from a file, or from standard input if `source` is "-".

    Args:
        source: the file's path.
        columns: names of its columns in order, `-` for one that is not read; none if a header names them.
        units: of its times and lengths where no header names them, such as ms and cm; SI units if none.

    Raises:
        InputError: the candidate cannot be read; the message names the line.
    """
    with _opened(source, "CANDIDATE", "a readable file, or - for standard input") as (stream, head, name):
        return read_stream(stream, name, head, Naming(tuple(columns), tuple(units)))


def read_stream(stream: BinaryIO, name: str, head: bytes = b"", naming: Naming | None = None) -> Candidate:
    """Read a candidate in any of the formats from a stream of bytes, of which `head` has been read already."""
    head += stream.read(_TELLING - len(head))
    reader = next((one for start, one in _READERS.items() if head.startswith(start)), read_text)
    return reader(stream, head, name, naming or Naming())


def read_transits(source: str | Path, units: Sequence[str] = ()) -> Array:
    """Read times of xdot = 0 in s from a CSV file with a column t, or from standard input if `source` is "-".

    Raises:
        InputError: the file cannot be read; the message names the line.
    """
    with _opened(source, "--transits", "a readable CSV file") as (stream, head, name):
        columns, _ = ColumnReader(name, ("t",), naming=Naming((), tuple(units)), repeats=True).columns(stream, head)
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
