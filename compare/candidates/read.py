"""Read a candidate or its transit times from a file or a stream; the first bytes tell text from NumPy's files.

- A line of text names the columns in any order: t, x, y and any of z, vx, vy, vz, in these words or
  others (`names.py`); a line of units may be below it. Without such a line three columns are t, x,
  y, four are t, x, y, z.
- Fields are separated by commas, semicolons, tabs, bars or white space, and may be in quotes.
  Decimals have a point or a comma. A line that begins with #, %, ! or // is a comment, and the
  header may be one. Columns of other names are not read. Times are numbers, or
  hours:minutes:seconds with a date or without. Rows without a number are left out.
- foucPend (Mathar, appendix B): no header; t x y z X Y Z φ λ speed separated by white space, of
  which the first four are read; `# P n t f` names a transit.

A text that can be read in two ways is refused, with what to write instead. The number of bytes and
rows and the length of a line are limited. Errors name the line.
"""

from __future__ import annotations

import codecs
import errno
import math
import os
import re
import sys
from array import array
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from decimal import Context, Decimal
from functools import partial
from pathlib import Path
from tempfile import SpooledTemporaryFile
from typing import IO

import numpy as np

from reference import InputError
from reference.errors import Described, checked_path, counted
from reference.numbers.precision import Array
from reference.plain_text import plain as printable
from reference.scenes.scene import MAX_ROWS
from reference.system.documents import open_at_once

from .arrays import read_archive, read_array
from .candidate import FEWER_ROWS, Candidate, Deviation, checked_transits
from .clock import HOW, counted_from, decimal, seconds_of
from .header import COMMAS, Header
from .names import NEEDED, Layout, Naming
from .text import (
    COMMENT,
    GROUPED,
    MARKS,
    MAX_BYTES,
    MAX_LINE,
    MAX_LINES,
    MOMENT,
    SEPARATORS,
    THOUSANDS,
    doubtful_number,
    is_clock,
    is_missing,
    is_number,
    padded,
    plain,
    possible_separators,
    says_nothing,
    split,
    without_end,
)

_TELLING = 6  # bytes that tell an archive from text
_CHUNK = 1 << 22
_SAMPLE = 50  # rows that are searched for numbers with more digits than a double's
DOUBLE_DIGITS = 17  # decimal digits that identify a double
# decimals of up to this many digits survive a double, so a precise program means the decimal itself
_SURE_DIGITS = 15
_EXACT = Context(prec=40)  # rounds a difference to 40 digits, far more than a low part holds
DECIMAL_COMMA = Deviation("decimal_comma", "numbers have a comma for the decimal point")


def read(
    source: str | Path, *, columns: Sequence[str] = (), units: Sequence[str] = ()
) -> Candidate:
    """Read a candidate from a file, or from standard input if `source` is "-".

    Args:
        source: the file's path.
        columns: names of its columns in order, `-` for a column to skip; not needed if a header
            names them.
        units: units of its times and lengths if no header names them, such as ms and cm; by default
            SI units.

    Raises:
        InputError: the candidate cannot be read; the message names the line.
    """
    with _opened(source, "CANDIDATE", "a readable file, or - for standard input") as (stream, name):
        return read_stream(stream, name, Naming(tuple(columns), tuple(units)))


@contextmanager
def named(field: str) -> Iterator[None]:
    """Name the right field in errors of a file or a command, such as a baseline, which is read like a candidate."""
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
    naming = naming or Naming()
    if head.startswith(b"PK"):
        return read_archive(stream, name, naming)
    if head.startswith(b"\x93NUMPY"):
        return read_array(stream, name, naming)
    return _read_text(stream, name, naming)


def read_transits(source: str | Path, units: Sequence[str] = ()) -> Array:
    """Read times of xdot = 0 in s from a CSV file with a column t, or from standard input if `source` is "-".

    Raises:
        InputError: the file cannot be read; the message names the line.
    """
    with _opened(source, "--transits", "a readable CSV file") as (stream, name):
        reader = _ColumnReader(name, ("t",), Naming((), tuple(units)))
        columns, _ = reader.columns(stream)
        return checked_transits(columns["t"], name)


@contextmanager
def _opened(source: str | Path, field: str, expected: str) -> Iterator[tuple[IO[bytes], str]]:
    """Yield a file, or standard input if `source` is "-", and its name for messages; of a pipe a copy."""
    with ExitStack() as stack:
        try:
            if str(source) == "-":
                name = "standard input"
                stream = _standard_input()
            else:
                name = printable(str(source))
                stream = stack.enter_context(open_at_once(checked_path(field, source, expected)))
                os.set_blocking(stream.fileno(), True)
            if not stream.seekable():
                copy = stack.enter_context(SpooledTemporaryFile(_CHUNK))
                _copy_pipe(stream, copy)
                if not copy.tell() and str(source) != "-":
                    advice = (
                        "No program writes to this pipe: start one first, or let --run start it"
                    )
                    raise OSError(errno.EPIPE, advice)
                copy.seek(0)
                stream = copy
            _check_size(stream, name)
            yield stream, name
        except OSError as error:
            raise InputError(field, str(source), expected, f"{error.strerror}.") from None


def _standard_input() -> IO[bytes]:
    if sys.stdin is None:
        raise OSError(errno.EBADF, "Standard input is closed")
    return sys.stdin.buffer


def _copy_pipe(pipe: IO[bytes], copy: IO[bytes]) -> None:
    """Copy what a pipe holds, up to a little more than is allowed."""
    while copy.tell() <= MAX_BYTES:
        data = pipe.read(_CHUNK)
        if not data:
            return
        copy.write(data)


def _check_size(stream: IO[bytes], name: str) -> None:
    """Refuse a stream that is too long; its position stays."""
    start = stream.tell()
    if stream.seek(0, os.SEEK_END) > MAX_BYTES:
        got = Described(f"more than {MAX_BYTES} bytes")
        raise InputError(name, got, f"at most {MAX_BYTES}", FEWER_ROWS)
    stream.seek(start)


def _read_text(stream: IO[bytes], name: str, naming: Naming) -> Candidate:
    """Read a candidate from a stream of bytes.

    Raises:
        InputError: the text cannot be read; the message names the line.
    """
    reader = _ColumnReader(name, NEEDED, naming)
    columns, low = reader.columns(stream)
    transits = None
    if reader.transits:
        transits = checked_transits(np.array(reader.transits), f"{name}: # P")
    return Candidate.of(
        name,
        columns.pop("t"),
        columns,
        low=low,
        transits=transits,
        notes=tuple(reader.notes),
        conventions=tuple(reader.conventions),
        clock_s=reader.clock_s,
    )


_UNPACK = "Unpack it first."
_RECODE = "Write it in UTF-8; PowerShell does by `| Out-File -Encoding utf8`."
# how files begin that are no text in UTF-8, what they are, and what to do; the mark of UTF-32
# begins as that of UTF-16
_BINARY_MARKS = (
    (b"\x1f\x8b", "gzip", _UNPACK),
    (b"\xfd7zXZ", "xz", _UNPACK),
    (b"BZh", "bzip2", _UNPACK),
    (codecs.BOM_UTF32_LE, "UTF-32", _RECODE),
    (codecs.BOM_UTF32_BE, "UTF-32", _RECODE),
    (codecs.BOM_UTF16_LE, "UTF-16", _RECODE),
    (codecs.BOM_UTF16_BE, "UTF-16", _RECODE),
)


def _binary(data: bytes) -> tuple[str, str] | None:
    """Return what the first bytes of a file are, and what to do.

    None if they may be text in UTF-8.
    """
    for mark, kind, advice in _BINARY_MARKS:
        if data.startswith(mark):
            return kind, advice
    if b"\0" in data:
        return "a zero byte", "Binary data is read from .npy and .npz only."
    return None


@dataclass(frozen=True)
class _TextReading:
    """A way to read the rows of a text.

    Attributes:
        separator: between fields; white space if empty.
        layout: which column stands where.
        width: the number of columns; further fields are empty.
    """

    separator: str
    layout: Layout
    width: int

    def fields(self, row: str) -> list[str]:
        """Return the fields of the columns that are read; fewer if the row is cut off."""
        fields = split(row, self.separator)
        return [fields[place] for place in self.layout.places.values() if place < len(fields)]

    def counts(self, row: str) -> bool:
        """Return whether a row has as many fields as there are columns."""
        fields = split(row, self.separator)
        return len(fields) >= self.width and not any(fields[self.width :])

    def fits(self, row: str) -> bool:
        """Return whether every field that is read is a number, or a mark for a missing one."""
        if not self.counts(row):
            return False
        time, *others = self.fields(row) or [""]
        if not (is_number(time) or is_clock(time) or is_missing(time)):
            return False
        return all(is_number(field) or is_missing(field) for field in others)


class _ColumnReader:
    """A reader of one text; `columns` reads it.

    Args:
        name: its name in messages.
        needed: columns that must be there: `NEEDED`, or t alone for transits, of which some may be
            equal.
        naming: what the user says of the columns.
    """

    def __init__(self, name: str, needed: tuple[str, ...], naming: Naming) -> None:
        self.name = name
        self.alone = len(needed) == 1
        self.header = Header(name, needed, naming)
        self.rows: list[str] = []
        self.lines = array("l")  # the number of each row's line
        self.readings: list[_TextReading] = []  # ways to read the first row
        self.conventions: list[Deviation] = []
        self.notes: list[str] = []
        self.transits: list[float] = []  # that comments of foucPend name
        # what a clock showed in the first row, from which t is counted
        self.clock_s: float | None = None

    def columns(self, stream: IO[bytes]) -> tuple[dict[str, Array], dict[str, Array]]:
        """Return the columns by name in SI units, and their low parts if some number is finer than a double.

        Args:
            stream: bytes in UTF-8.

        Raises:
            InputError: the text cannot be read; the message names the line.
        """
        self._take_lines(stream)
        if not self.rows:
            formats = " with a column t" if self.alone else ", foucPend's output, .npy or .npz"
            raise self.header.refuse(f"a CSV file{formats}")
        reading = self._only_reading()
        self.conventions = [*reading.layout.conventions]
        table, low = self._numbers(reading)
        names = reading.layout.places
        columns = dict(zip(names, np.ascontiguousarray(table.T), strict=True))
        low_columns: dict[str, Array] = {}
        if low.any():
            low_columns = dict(zip(names, np.ascontiguousarray(low.T), strict=True))
        return reading.layout.converted(columns, low_columns)

    def _numbers(self, reading: _TextReading) -> tuple[Array, Array]:
        """Return the numbers of the columns that are read, shape (rows, columns), and their low parts."""
        places = [*reading.layout.places.values()]
        mark = self._sure_mark(reading)
        if mark is not None:
            try:
                table = self._loaded(reading, mark, places)
            except ValueError:
                pass  # some row takes a closer look
            else:
                return table, _low_parts(self.rows, reading.separator or None, places, table)

        self._spell_plainly(reading)
        table = np.loadtxt(self.rows, comments=None, ndmin=2)
        return table, _low_parts(self.rows, None, range(len(places)), table)

    def _loaded(self, reading: _TextReading, mark: str, places: Sequence[int]) -> Array:
        """Return the numbers of rows that need no closer look: all have one decimal mark.

        Raises:
            ValueError: they do need one.
            InputError: a row has more or fewer fields than there are columns.
        """
        rows = (self._counted(reading, i, mark) for i in range(len(self.rows)))
        separator = reading.separator or None
        table = np.loadtxt(rows, delimiter=separator, usecols=places, comments=None, ndmin=2)
        if mark == ",":
            self.conventions.append(DECIMAL_COMMA)
            self.rows = [row.replace(",", ".") for row in self.rows]
        return table

    def _take_lines(self, stream: IO[bytes]) -> None:
        """Take the rows, and from the first of them and the lines above it the ways to read them."""
        for line, data in enumerate(iter(partial(stream.readline, MAX_LINE + 1), b""), 1):
            text = self._decoded(data, line)
            if says_nothing(text):
                continue
            if "\r" in text:
                got = Described("lines that end with CR alone")
                advice = "Save the file with line ends LF."
                raise InputError(self.name, got, "lines that end with LF or CR LF", advice)

            begins = text.lstrip()
            remark = COMMENT.match(begins) if begins[0] in MARKS else None
            if remark is not None:
                if not self.rows:
                    self.header.add(line, remark[1], True)
                if remark[1].split()[:1] == ["P"] and not self.alone:
                    self._take_transit(remark[1], line)
            elif self.rows or self._begins(text, line):
                self._take_row(text, line)
            if data[-1:] != b"\n":
                self.notes.append("the last line does not end with a newline: it may be cut off")

    def _decoded(self, data: bytes, line: int) -> str:
        """Return a line as text without blanks at its ends.

        Raises:
            InputError: it is too long, or one too many, or the file is binary.
        """
        if len(data) > MAX_LINE:
            got = Described(f"a line of more than {MAX_LINE} bytes")
            raise InputError(self.name, got, "lines of numbers", "Is this a text file?")
        if line > MAX_LINES:
            got = Described(f"more than {MAX_LINES} lines")
            expected = f"at most {MAX_LINES}, comments and empty lines included"
            raise InputError(self.name, got, expected, FEWER_ROWS)
        binary = None if self.rows else _binary(data)
        if binary is not None:
            kind, advice = binary
            raise InputError(self.name, Described(kind), "text in UTF-8", advice)
        text = data.decode("utf-8", "replace").strip(" \r\n\v\f")
        return text.removeprefix("\ufeff") if line == 1 else text

    def _take_row(self, text: str, line: int) -> None:
        if len(self.rows) == MAX_ROWS:
            got = Described(f"more than {MAX_ROWS} rows")
            raise InputError(self.name, got, f"at most {MAX_ROWS}", FEWER_ROWS)
        self.rows.append(text)
        self.lines.append(line)

    def _take_transit(self, remark: str, line: int) -> None:
        try:
            self.transits.append(float(remark.split()[2]))
        except (IndexError, ValueError):
            expected = "# P followed by a count, a time in s and a frequency"
            raise InputError(f"{self.name}: line {line}", f"# {remark[:80]}", expected) from None

    def _begins(self, text: str, line: int) -> bool:
        """Return True if a line is the first row, after taking from it and the lines above the ways to read it."""
        separators = possible_separators(text)
        if not separators:
            self.header.add(line, text, False)
            return False
        # of a header without doubt, the separators that it uses
        by_header = [(mark, 0.0) for mark in SEPARATORS if self.header.uses(mark, text)]
        refusals = []
        readings = []
        for separator, share in by_header or separators:
            try:
                layout, width = self.header.layout(text, separator, line)
            except InputError as error:
                refusals.append((share, error))
            else:
                readings.append(_TextReading(separator, layout, width))
        if not readings:
            raise refusals[0][1]
        if not self.header.decides and any(share == 1 for share, _ in refusals):
            got = Described(f"{text[:40]}, which may be one number or two")
            expected = "a first line that names the columns"
            advice = f"Write {','.join(self.header.needed)} above it."
            raise InputError(f"{self.name}: line {line}", got, expected, advice)
        self.readings = [reading for reading in readings if reading.fits(text)] or readings[:1]
        return True

    def _only_reading(self) -> _TextReading:
        """Return the one way to read all rows.

        Raises:
            InputError: there are two that give other numbers.
        """
        if len(self.readings) == 1:
            return self.readings[0]
        possible = [reading for reading in self.readings if all(map(reading.fits, self.rows))]
        if not possible:
            return self.readings[0]
        for other in possible[1:]:
            self._check_equal(possible[0], other)
        return possible[0]

    def _check_equal(self, reading: _TextReading, other: _TextReading) -> None:
        """Refuse rows of which two ways to read them give other numbers."""
        same_columns = [*reading.layout.places] == [*other.layout.places]
        for row, line in zip(self.rows, self.lines, strict=True):
            first = [_value(field) for field in reading.fields(row)]
            second = [_value(field) for field in other.fields(row)]
            if not same_columns or first != second:
                got = Described(f"{', '.join(first)} or {', '.join(second)} from {row!r}"[:80])
                advice = "Name the columns in the first line, and separate them by semicolons."
                where = f"{self.name}: line {line}"
                raise InputError(where, got, "a row that can be read in one way only", advice)

    def _sure_mark(self, reading: _TextReading) -> str | None:
        """Return the decimal mark of all numbers if a look at the rows shows it.

        None if each has to be looked at.
        """
        possible = [mark for mark in ',."' if mark != reading.separator]
        marks = [mark for mark in possible if any(mark in row for row in self.rows)]
        if marks not in ([","], ["."]):
            return None
        mark = marks[0]
        for row in self.rows[:_SAMPLE]:
            for number in reading.fields(row):
                if mark in number and not GROUPED.fullmatch(number):
                    return mark
        return None

    def _counted(self, reading: _TextReading, i: int, mark: str) -> str:
        """Return a row, with points for commas if the decimal mark is a comma.

        Raises:
            InputError: it has more or fewer fields than there are columns.
        """
        row = self.rows[i]
        separator = reading.separator
        count = row.count(separator) + 1 if separator else len(row.split())
        if count != reading.width and not reading.counts(row):
            self._refuse_count(reading, i)
        return row.replace(",", ".") if mark == "," else row

    def _refuse_count(self, reading: _TextReading, i: int) -> None:
        count = len(without_end(split(self.rows[i], reading.separator)))
        expected = f"{reading.width}, as in the first row"
        advice = "Is the line cut off?"
        if count > reading.width:
            advice = COMMAS if reading.separator == "," else "Are there two numbers in one field?"
        got = Described(counted(count, "field"))
        raise InputError(f"{self.name}: line {self.lines[i]}", got, expected, advice)

    def _spell_plainly(self, reading: _TextReading) -> None:
        """Put the numbers of the columns that are read in place of the rows, with points and separated by blanks.

        Rows in which a position is missing are left out.

        Raises:
            InputError: a row or a number cannot be read, or in two ways.
        """
        columns = self._fields_without_lost_rows(reading)
        times = columns[0]
        clocks = [is_clock(text) for text in times]
        numbers = columns
        if clocks[0]:
            numbers = columns[1:]
            columns[0] = self._clock(times, reading)
        elif any(clocks):
            i = clocks.index(True)
            raise self._no_number(self.lines[i], "t", times[i])
        self._check_marks(numbers, reading)
        if any("," in number for column in numbers for number in column):
            self.conventions.append(DECIMAL_COMMA)
        self.rows = [" ".join(map(plain, fields)) for fields in zip(*columns, strict=True)]

    def _fields_without_lost_rows(self, reading: _TextReading) -> list[list[str]]:
        """Return the fields by column.

        Rows without a position are left out, and their lines with them.

        Raises:
            InputError: a field is no number, or no row has a position.
        """
        names = [*reading.layout.places]
        columns: list[list[str]] = [[] for _ in names]
        lines = array("l")
        lost_times = []
        for i, row in enumerate(self.rows):
            if not reading.counts(row):
                self._refuse_count(reading, i)
            fields = reading.fields(row)
            missing = [is_missing(field) for field in fields]
            if any(missing) and not self.alone and (all(missing) or not missing[0]):
                lost_times.append(fields[0])
                continue
            for name, column, field in zip(names, columns, fields, strict=True):
                if not (is_number(field) or (name == "t" and is_clock(field))):
                    raise self._no_number(self.lines[i], name, field)
                column.append(field)
            lines.append(self.lines[i])

        if not lines:
            got = Described(f"no number of {' or '.join(names[1:])} in any row")
            raise InputError(self.name, got, "rows of numbers")
        if lost_times:
            rows = counted(len(lost_times), "row")
            first = lost_times[0] or "?"
            self.notes.append(f"{rows} without a position left out, the first at t = {first}")
        self.lines = lines
        return columns

    def _no_number(self, line: int, name: str, field: str) -> InputError:
        advice = ""
        if THOUSANDS.fullmatch(field):
            advice = "Write numbers without separators between thousands."
        elif name == "t" and re.search(r"\d[:/-]\d", field):
            advice = HOW
        elif name == "t":
            advice = "Begin lines that are not rows with #."
        return InputError(f"{self.name}: line {line}: {name}", field[:40], "a number", advice)

    def _clock(self, texts: Sequence[str], reading: _TextReading) -> list[str]:
        """Return in s what a clock shows: since the first row if it does not begin at 0, but of transits as it stands.

        Raises:
            InputError: a text is not a time of day, or its column has a unit that no time of day
                has.
        """
        if "t" in reading.layout.factors:
            expected = "a number, since the column has a unit"
            raise InputError(f"{self.name}: t", texts[0], expected, "Leave the unit out.")
        times = []
        for text, line in zip(texts, self.lines, strict=True):
            times.append(seconds_of(text, f"{self.name}: line {line}: t"))
        kind = "hours:minutes:seconds"
        if MOMENT.fullmatch(texts[0]):
            kind = f"dates with {kind}"
        self.conventions.append(Deviation("clock_text", f"times are {kind}, converted to seconds"))
        if self.alone or not times[0]:
            return [decimal(time) for time in times]
        self.clock_s = float(times[0])
        return counted_from(times[0], times)

    def _check_marks(self, columns: Sequence[Sequence[str]], reading: _TextReading) -> None:
        """Refuse numbers whose marks may be decimal or not."""
        commas_separate = reading.separator == ","
        doubtful = doubtful_number(columns, commas_separate)
        if doubtful is not None:
            mark = "comma" if "," in doubtful else "point"
            expected = f"a number whose {mark} is clearly decimal, or clearly separates thousands"
            advice = f"Write {doubtful.replace(',', '.')}0 or {re.sub('[,.]', '', doubtful)}."
            raise InputError(self.name, doubtful, expected, advice)

        if not commas_separate:
            return
        numbers = [number for column in columns for number in column]
        if any("." in number or "," in number for number in numbers):
            return
        needless = padded(numbers)
        if needless is not None:
            got = Described(f"{needless} between commas")
            raise InputError(self.name, got, "whole numbers without leading zeros", COMMAS)


def _value(field: str) -> str:
    """Return the number in a field in one form, whatever form it has; other fields as they are."""
    return repr(float(plain(field))) if is_number(field) else field


def _low_parts(
    rows: Sequence[str], separator: str | None, places: Sequence[int], table: Array
) -> Array:
    """Return the printed numbers minus their doubles.

    Zeros if a sample of rows holds nothing but doubles.
    """

    def of_row(row: str, numbers: Array) -> list[float]:
        fields = row.split(separator)
        low = []
        for column, place in enumerate(places):
            low.append(_low_part(fields[place], float(numbers[column]), of_time=column == 0))
        return low

    sample = range(0, len(rows), 1 + len(rows) // _SAMPLE)
    if not any(any(of_row(rows[i], table[i])[1:]) for i in sample):
        return np.broadcast_to(0.0, table.shape)
    return np.array([of_row(row, numbers) for row, numbers in zip(rows, table, strict=True)])


def _low_part(text: str, near: float, of_time: bool = False) -> float:
    """Return the printed number minus `near`, its nearest double.

    0 if it may be just that double, printed.

    A time beside numbers more precise than doubles is the decimal itself where it has few digits,
    as 0.1 has.
    """
    # a number that underflows to 0 is below every scale here
    if near == 0 or not math.isfinite(near):
        return 0.0
    mantissa = text.lower().partition("e")[0]
    significant_digits = sum(map(str.isdigit, mantissa.strip().lstrip("+-0.")))
    is_decimal = of_time and significant_digits <= _SURE_DIGITS
    if significant_digits <= DOUBLE_DIGITS and not is_decimal:
        return 0.0
    printed = Decimal(text.strip())
    difference = _EXACT.subtract(printed, Decimal(near))
    half_a_unit = Decimal((0, (5,), int(printed.as_tuple().exponent) - 1))
    return float(difference) if is_decimal or abs(difference) > half_a_unit else 0.0
