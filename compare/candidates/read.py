"""Read a candidate or its transit times from a file or a stream; the first bytes tell text from NumPy's files.

NumPy's files hold arrays t, x, y and others by name (.npz), or one table of rows (.npy, .npz). The number of bytes and
rows and the length of a line are limited. Errors name the line.
"""

from __future__ import annotations

import errno
import os
import stat
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from reference import InputError
from reference.errors import plain
from reference.numbers.precision import Array
from reference.system.documents import open_at_once

from .candidate import COLUMNS, Candidate, candidate_of, checked_transits
from .layout import Layout, Naming, guessed, layout, unnamed
from .names import meaning
from .spelling import CHUNK, MAX_BYTES
from .text import ColumnReader, read_text

_TELLING = 6  # bytes that tell an archive from text
MAX_UNPACKED = 1 << 28  # bytes of the arrays that are read, unpacked: two million rows of long doubles
MOST_ARRAYS = 1000
NEEDED = ("t", "x", "y")
TRANSITS = "transits"
TABLE = "arr_0"  # the name that numpy.savez gives to an array without one
_EXPECTED = "arrays t, x, y and, if there, z, vx, vy, vz, transits"


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
    reader = _read_archive if head.startswith(b"PK") else _read_array if head.startswith(b"\x93NUMPY") else read_text
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


def _read_archive(stream: BinaryIO, head: bytes, name: str, naming: Naming) -> Candidate:
    """Read a candidate from the bytes of an .npz archive, of which `head` has been read already.

    Raises:
        InputError: the archive is too large or damaged, lacks t, x or y, or an array is not of real numbers.
    """
    with tempfile.TemporaryFile() as spool:
        _bounded(stream, head, spool, name)
        arrays = _arrays(spool, name)
    if not arrays:
        raise InputError(name, "none of them", _EXPECTED)
    if [*arrays] == [TABLE]:
        return _of_table(arrays[TABLE], name, naming)
    if naming.columns:
        raise InputError("--columns", ",".join(naming.columns), "no such option for arrays with names")
    times = arrays.pop(TRANSITS, None)
    transits = None
    if times is not None:
        field = f"{name}: {TRANSITS}"
        transits = checked_transits(np.asarray(_real(times, field), dtype=np.float64), field)
    made = layout([*arrays], NEEDED, COLUMNS[2:], naming.units, name)
    return _candidate(name, [*arrays.values()], made, transits)


def _read_array(stream: BinaryIO, head: bytes, name: str, naming: Naming) -> Candidate:
    """Read a candidate from the bytes of an .npy file: a table of rows, or an array of records with names.

    Raises:
        InputError: the file is too large or damaged, or its columns are not known.
    """
    with tempfile.TemporaryFile() as spool:
        _bounded(stream, head, spool, name, MAX_UNPACKED)
        try:
            array = np.load(spool, allow_pickle=False)
        except Exception as error:  # numpy raises several kinds of errors for a damaged file
            raise InputError(name, "a damaged .npy file", "a table of real numbers", f"{error}.") from None
    if array.dtype.names and array.ndim == 1 and not naming.columns:
        words = array.dtype.names
        return _candidate(name, [array[word] for word in words], layout(words, NEEDED, COLUMNS[2:], naming.units, name))
    return _of_table(array, name, naming)


def _of_table(array: object, name: str, naming: Naming) -> Candidate:
    """Make a candidate of a table, shape (rows, columns); the user names its columns, or their number does."""
    table = _real(array, name)
    count = table.shape[1] if table.ndim == 2 else 0
    words: Sequence[str] | None = naming.columns or (unnamed(count, NEEDED) if count else None)
    if words is None or len(words) != count:
        expected = f"a table of {len(words)} columns" if words else "a table of 3, 4 or 7 columns, t, x, y first"
        raise InputError(name, f"shape {table.shape}", expected, "One row for each time; --columns names the columns.")
    made = layout([word or "-" for word in words], NEEDED, COLUMNS[2:], naming.units, "--columns")
    if not naming.columns:
        made = replace(made, conventions=(guessed(words), *made.conventions))
    return _candidate(name, [table[:, i] for i in range(count)], made)


def _candidate(name: str, arrays: Sequence[object], made: Layout, transits: Array | None = None) -> Candidate:
    """Make a candidate of arrays of which each column is the one at its place, in SI units."""
    columns = {column: _real(arrays[i], f"{name}: {column}") for column, i in made.places.items()}
    candidate = candidate_of(name, columns, transits)
    scaled, low = made.converted({"t": candidate.t, **candidate.columns}, candidate.low)
    return replace(candidate, t=scaled.pop("t"), columns=scaled, low=low, conventions=made.conventions)


def _bounded(stream: BinaryIO, head: bytes, spool: BinaryIO, name: str, most: int = MAX_BYTES) -> None:
    """Copy the stream to a file, up to a limit: a zip archive is read from its end."""
    total, data = 0, head
    while data:
        total += len(data)
        if total > most:
            raise InputError(name, f"more than {most} bytes", f"at most {most} bytes", "Thin the output out.")
        spool.write(data)
        data = stream.read(CHUNK)
    spool.seek(0)


def _arrays(data: BinaryIO, name: str) -> dict[str, object]:
    """Return the arrays whose names mean something, or the only one if it has no name."""
    try:
        with zipfile.ZipFile(data) as archive:
            members = {member.filename.removesuffix(".npy"): member for member in archive.infolist()[:MOST_ARRAYS]}
        if any(word.startswith("xl/") for word in members):
            raise InputError(name, "an Excel workbook", "text with named columns", "Save the sheet as CSV.")
        chosen = [word for word in members if word == TRANSITS or meaning(word, {}) is not None]
        chosen = chosen or [word for word in members if word == TABLE]
        size = sum(members[word].file_size for word in chosen)
        if size <= MAX_UNPACKED:
            data.seek(0)
            with np.load(data, allow_pickle=False) as arrays:
                return {word: arrays[word] for word in chosen}
    except InputError:
        raise
    except Exception as error:  # zipfile and numpy raise half a dozen kinds of errors for a damaged archive
        raise InputError(name, "a damaged .npz archive", _EXPECTED, f"{error}.") from None
    raise InputError(name, f"{size} bytes unpacked", f"at most {MAX_UNPACKED}", "Thin the output out.")


def _real(array: object, name: str) -> Array:
    if not isinstance(array, np.ndarray) or array.dtype.kind not in "fiu":
        kind = f"dtype {array.dtype}" if isinstance(array, np.ndarray) else "no NumPy array"
        raise InputError(name, kind, "an array of real numbers")
    return array
