"""Read a candidate or its transit times from a file or a stream; the first bytes tell text from NumPy's files.

- A line of text names the columns in any order: t, x, y and any of z, vx, vy, vz, in these words or others
  (`names.py`). Without such a line three columns are t, x, y, four are t, x, y, z.
- Fields are separated by commas, semicolons, tabs or white space. A line that begins with #, %, ! or // is a comment,
  and the header may be one. Columns of other names are not read.
- foucPend (Mathar, appendix B): no header; t x y z X Y Z φ λ speed separated by white space, of which the first
  four are read; `# P n t f` names a transit.

The number of bytes and rows and the length of a line are limited. Errors name the line.
"""

from __future__ import annotations

import codecs
import errno
import math
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from decimal import Context, Decimal
from functools import partial
from itertools import chain
from pathlib import Path
from tempfile import SpooledTemporaryFile
from typing import IO

import numpy as np

from reference import InputError
from reference.errors import checked_path, plain
from reference.numbers.precision import Array
from reference.scenes.scene import MAX_ROWS
from reference.system.documents import open_at_once

from .arrays import AS_NAMED, read_archive, read_array
from .candidate import Candidate, Deviation, checked_transits
from .names import NEEDED, Naming
from .text import COMMENT, MARKS, MAX_BYTES, MAX_LINE, MAX_LINES, Header, Spelling, is_number, spelling

_TELLING = 6  # bytes that tell an archive from text
CHUNK = 1 << 22
SAMPLE = 50  # rows that are searched for numbers with more digits than a double's
DOUBLE_DIGITS = 17  # decimal digits that identify a double
SURE_DIGITS = 15  # decimals of up to this many digits survive a double, so a precise program means the decimal itself
_EXACT = Context(prec=40)  # rounds a difference to 40 digits, far more than a low part holds
DECIMAL_COMMA = Deviation("decimal_comma", "numbers have a comma for the decimal point")


def read(source: str | Path, *, columns: Sequence[str] = (), units: Sequence[str] = ()) -> Candidate:
    """Read a candidate from a file, or from standard input if `source` is "-".

    Args:
        source: the file's path.
        columns: names of its columns in order, `-` for one that is not read; none if a header names them.
        units: of its times and lengths where no header names them, such as ms and cm; SI units if none.

    Raises:
        InputError: the candidate cannot be read; the message names the line.
    """
    with _opened(source, "CANDIDATE", "a readable file, or - for standard input") as (stream, name):
        return read_stream(stream, name, Naming(tuple(columns), tuple(units)))


@contextmanager
def named(field: str) -> Iterator[None]:
    """Name a field in what is wrong with its file or its command: a baseline is read, and run, as a candidate is."""
    try:
        yield
    except InputError as error:
        if error.field not in ("CANDIDATE", "--run", "baseline"):
            raise
        raise InputError(field, error.got, error.expected, error.advice) from None


def read_stream(stream: IO[bytes], name: str, naming: Naming | None = None) -> Candidate:
    """Read a candidate in any of the formats from a stream of bytes that can be read twice, as no pipe can."""
    head = stream.read(_TELLING)
    stream.seek(-len(head), os.SEEK_CUR)
    reader = read_archive if head.startswith(b"PK") else read_array if head.startswith(b"\x93NUMPY") else read_text
    return reader(stream, name, naming or Naming())


def read_transits(source: str | Path, units: Sequence[str] = ()) -> Array:
    """Read times of xdot = 0 in s from a CSV file with a column t, or from standard input if `source` is "-".

    Raises:
        InputError: the file cannot be read; the message names the line.
    """
    with _opened(source, "--transits", "a readable CSV file") as (stream, name):
        columns, _ = ColumnReader(name, ("t",), Naming((), tuple(units))).columns(stream)
        return checked_transits(columns["t"], name)


@contextmanager
def _opened(source: str | Path, field: str, expected: str) -> Iterator[tuple[IO[bytes], str]]:
    """Yield a file, or standard input if `source` is "-", and its name for messages; of a pipe a copy."""
    stream: IO[bytes]
    with ExitStack() as stack:
        try:
            if str(source) == "-":
                if sys.stdin is None:
                    raise OSError(errno.EBADF, "Standard input is closed")
                stream, name = sys.stdin.buffer, "standard input"
            else:
                path, name = checked_path(field, source, expected), plain(str(source))
                stream = stack.enter_context(open_at_once(path))
                os.set_blocking(stream.fileno(), True)
            if not stream.seekable():
                pipe, stream = stream, stack.enter_context(SpooledTemporaryFile(CHUNK))
                while stream.tell() <= MAX_BYTES and (data := pipe.read(CHUNK)):
                    stream.write(data)
                if not stream.tell() and str(source) != "-":
                    advice = "Nobody writes to this pipe: start the program first, or let --run start it"
                    raise OSError(errno.EPIPE, advice)
                stream.seek(0)
            start = stream.tell()
            if stream.seek(0, os.SEEK_END) > MAX_BYTES:
                raise InputError(name, f"more than {MAX_BYTES} bytes", f"at most {MAX_BYTES}", "Thin the output out.")
            stream.seek(start)
            yield stream, name
        except OSError as error:
            raise InputError(field, str(source), expected, f"{error.strerror}.") from None


def read_text(stream: IO[bytes], name: str, naming: Naming) -> Candidate:
    """Read a candidate from a stream of bytes.

    Raises:
        InputError: the text cannot be read; the message names the line.
    """
    reader = ColumnReader(name, NEEDED, naming)
    columns, low = reader.columns(stream)
    times = checked_transits(np.array(reader.transits), f"{name}: # P") if reader.transits else None
    notes = ("the last line does not end with a newline: it may be cut off",) if reader.cut_off else ()
    conventions = reader.layout.conventions
    return Candidate.of(name, columns.pop("t"), columns, low=low, transits=times, notes=notes, conventions=conventions)


def _binary(data: bytes) -> tuple[str, str] | None:
    """Return what the first bytes of a file are, and what to do; None if they may be text in UTF-8."""
    packed = {b"\x1f\x8b": "gzip", b"\xfd7zXZ": "xz", b"BZh": "bzip2"}
    # the longer marks first: that of UTF-32 begins as that of UTF-16
    encodings = {codecs.BOM_UTF32_LE: "UTF-32", codecs.BOM_UTF32_BE: "UTF-32"}
    encodings |= {codecs.BOM_UTF16_LE: "UTF-16", codecs.BOM_UTF16_BE: "UTF-16"}
    for begins, kind in packed.items():
        if data.startswith(begins):
            return kind, "Unpack it first."
    for begins, kind in encodings.items():
        if data.startswith(begins):
            return kind, "Write it in UTF-8; PowerShell does by `| Out-File -Encoding utf8`."
    return ("a zero byte", "Binary data is read from .npy and .npz only.") if b"\0" in data else None


class ColumnReader:
    """A reader of one text; `columns` reads it.

    Args:
        name: its name in messages.
        needed: columns that must be there: `NEEDED`, or t alone for transits, of which some may be equal.
        naming: what the user says of the columns.
    """

    def __init__(self, name: str, needed: tuple[str, ...], naming: Naming) -> None:
        self.name, self.alone = name, len(needed) == 1
        self.header = Header(name, needed, naming)
        self.spelled, self.layout, self.fields = Spelling(None), AS_NAMED, 0  # of a row, once one has been seen
        self.respelled = False
        self.rows: list[str] = []
        self.transits: list[float] = []  # that comments of foucPend name
        self.line = 0
        self.cut_off = False  # the last line does not end with a newline

    def columns(self, stream: IO[bytes]) -> tuple[dict[str, Array], dict[str, Array]]:
        """Return the columns by name in SI units, and their low parts if some number is finer than a double.

        Args:
            stream: bytes in UTF-8.

        Raises:
            InputError: the text cannot be read; the message names the line.
        """
        rows = self._rows_of(stream)
        first = next(rows, None)
        if first is None:
            formats = " with a column t" if self.alone else ", foucPend's output, .npy or .npz"
            raise self.header.refuse(f"a CSV file{formats}")
        separator, places = self.spelled.separator, self.layout.places
        indices = [*places.values()]
        try:
            table = np.loadtxt(chain([first], rows), delimiter=separator, usecols=indices, comments=None, ndmin=2)
        except ValueError:
            where, row = f"{self.name}: line {self.line}", self.rows[-1]
            fields = {name: row.split(separator)[i].strip() for name, i in places.items()}
            bad = next(((f"{where}: {name}", text[:40]) for name, text in fields.items() if not is_number(text)), None)
            raise InputError(*(bad or (where, row[:80])), "a number") from None
        low = _low_parts(self.rows, separator, indices, table)
        columns, rest = (dict(zip(places, np.ascontiguousarray(part.T), strict=True)) for part in (table, low))
        return self.layout.converted(columns, rest if low.any() else {})

    def _rows_of(self, stream: IO[bytes]) -> Iterator[str]:
        """Yield the rows, of which the first and the lines above it tell which column is where."""
        for data in iter(partial(stream.readline, MAX_LINE + 1), b""):
            self.line += 1
            if len(data) > MAX_LINE:
                got = f"a line of more than {MAX_LINE} bytes"
                raise InputError(self.name, got, "lines of numbers", "Is it text?")
            if self.line > MAX_LINES:
                got, most = f"more than {MAX_LINES} lines", f"at most {MAX_LINES}, comments and empty ones included"
                raise InputError(self.name, got, most, "Thin the output out.")
            if not self.fields and (binary := _binary(data)):
                got, advice = binary
                raise InputError(self.name, got, "text in UTF-8", advice)
            text = data.decode("utf-8", "replace").strip()
            text = text if self.fields else text.removeprefix("\ufeff")
            if not text:
                continue
            self.cut_off = data[-1:] != b"\n"
            if text[0] in MARKS and (remark := COMMENT.match(text)):
                if not self.fields:
                    self.header.add(self.line, remark[1], True)
                if remark[1].split()[:1] == ["P"] and not self.alone:
                    self._take_transit(remark[1])
            elif self.fields or self._begins(text):
                if "D" in text and not self.spelled.fortran:
                    self.spelled, self.respelled = replace(self.spelled, fortran=True), True
                row, separator = self.spelled.plain(text) if self.respelled else text, self.spelled.separator
                count = row.count(separator) + 1 if separator else len(row.split())
                if count != self.fields:
                    got, expected = f"{count} fields", f"{self.fields} as in the first row"
                    raise InputError(f"{self.name}: line {self.line}", got, expected, "Is the line cut off?")
                if len(self.rows) == MAX_ROWS:
                    most = f"at most {MAX_ROWS}"
                    raise InputError(self.name, f"more than {MAX_ROWS} rows", most, "Thin the output out.")
                self.rows.append(row)
                yield row

    def _take_transit(self, remark: str) -> None:
        try:
            self.transits.append(float(remark.split()[2]))
        except (IndexError, ValueError):
            expected = "# P, a count, a time in s, a frequency"
            raise InputError(f"{self.name}: line {self.line}", f"# {remark[:80]}", expected) from None

    def _begins(self, text: str) -> bool:
        """Return True if a line is the first row, after taking from it and the lines above which column is where."""
        spelled = spelling(text)
        if spelled is None:
            self.header.add(self.line, text, False)
            return False
        made = self.header.layout(text, spelled, self.line)
        conventions = (*made.conventions, *([DECIMAL_COMMA] if spelled.decimal_comma else []))
        self.layout = replace(made, conventions=conventions)
        self.spelled, self.fields = spelled, len(spelled.fields(text))
        self.respelled = spelled != Spelling(spelled.separator)
        return True


def _low_parts(lines: list[str], separator: str | None, indices: list[int], table: Array) -> Array:
    """Return the printed numbers minus their doubles; zeros if a sample of rows holds nothing but doubles."""

    def of_row(line: str, row: Array) -> list[float]:
        fields = line.split(separator)
        return [low_part(fields[k], float(row[i]), of_time=i == 0) for i, k in enumerate(indices)]

    sample = range(0, len(lines), 1 + len(lines) // SAMPLE)
    if not any(any(of_row(lines[i], table[i])[1:]) for i in sample):
        return np.broadcast_to(0.0, table.shape)
    return np.array([of_row(line, row) for line, row in zip(lines, table, strict=True)])


def low_part(text: str, near: float, of_time: bool = False) -> float:
    """Return the printed number minus `near`, its nearest double; 0 if it may be just that double, printed.

    A time beside numbers more precise than doubles is the decimal itself where it has few digits, as 0.1 has.
    """
    digits = sum(map(str.isdigit, text.lower().partition("e")[0].strip().lstrip("+-0.")))  # that are significant
    sure = of_time and digits <= SURE_DIGITS
    # a number that underflows to 0 is below every scale here
    if near == 0 or not math.isfinite(near) or (digits <= DOUBLE_DIGITS and not sure):
        return 0.0
    printed = Decimal(text.strip())
    difference = _EXACT.subtract(printed, Decimal(near))
    half_a_unit = Decimal((0, (5,), int(printed.as_tuple().exponent) - 1))
    return float(difference) if sure or abs(difference) > half_a_unit else 0.0
