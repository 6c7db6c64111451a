"""Read a candidate or its transit times from a file or a stream; the first bytes tell text from NumPy's files.

- A line of text names the columns in any order: t, x, y and any of z, vx, vy, vz, in these words or others
  (`names.py`); a line of units may be below it. Without such a line three columns are t, x, y, four are t, x, y, z.
- Fields are separated by commas, semicolons, tabs, bars or white space, and may be in quotes. Decimals have a point or
  a comma. A line that begins with #, %, ! or // is a comment, and the header may be one. Columns of other names are not
  read. Times are numbers, or hours:minutes:seconds with a date or without. Rows without a number are left out.
- foucPend (Mathar, appendix B): no header; t x y z X Y Z φ λ speed separated by white space, of which the first
  four are read; `# P n t f` names a transit.

A text that can be read in two ways is refused, with what to write instead. The number of bytes and rows and the length
of a line are limited. Errors name the line.
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
from reference.errors import checked_path, counted
from reference.numbers.precision import Array
from reference.plain_text import plain as printable
from reference.scenes.scene import MAX_ROWS
from reference.system.documents import open_at_once

from .arrays import read_archive, read_array
from .candidate import Candidate, Deviation, checked_transits
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
CHUNK = 1 << 22
SAMPLE = 50  # rows that are searched for numbers with more digits than a double's
DOUBLE_DIGITS = 17  # decimal digits that identify a double
# decimals of up to this many digits survive a double, so a precise program means the decimal itself
SURE_DIGITS = 15
_EXACT = Context(prec=40)  # rounds a difference to 40 digits, far more than a low part holds
DECIMAL_COMMA = Deviation("decimal_comma", "numbers have a comma for the decimal point")


def read(
    source: str | Path, *, columns: Sequence[str] = (), units: Sequence[str] = ()
) -> Candidate:
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
    reader = (
        read_archive
        if head.startswith(b"PK")
        else read_array
        if head.startswith(b"\x93NUMPY")
        else read_text
    )
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
                path, name = checked_path(field, source, expected), printable(str(source))
                stream = stack.enter_context(open_at_once(path))
                os.set_blocking(stream.fileno(), True)
            if not stream.seekable():
                pipe, stream = stream, stack.enter_context(SpooledTemporaryFile(CHUNK))
                while stream.tell() <= MAX_BYTES and (data := pipe.read(CHUNK)):
                    stream.write(data)
                if not stream.tell() and str(source) != "-":
                    advice = (
                        "Nobody writes to this pipe: start the program first, or let --run start it"
                    )
                    raise OSError(errno.EPIPE, advice)
                stream.seek(0)
            start = stream.tell()
            if stream.seek(0, os.SEEK_END) > MAX_BYTES:
                raise InputError(
                    name,
                    f"more than {MAX_BYTES} bytes",
                    f"at most {MAX_BYTES}",
                    "Thin the output out.",
                )
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
    return Candidate.of(
        name,
        columns.pop("t"),
        columns,
        low=low,
        transits=times,
        notes=tuple(reader.notes),
        conventions=tuple(reader.conventions),
        clock_s=reader.clock_s,
    )


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
    return (
        ("a zero byte", "Binary data is read from .npy and .npz only.") if b"\0" in data else None
    )


@dataclass(frozen=True)
class TextReading:
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
        time, *others = self.fields(row) or [""]
        readable = is_number(time) or is_clock(time) or is_missing(time)
        return (
            self.counts(row)
            and readable
            and all(is_number(field) or is_missing(field) for field in others)
        )


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
        self.rows: list[str] = []
        self.lines = array("l")  # the number of each row's line
        self.readings: list[TextReading] = []  # ways to read the first row
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
        places = reading.layout.places
        self.conventions = [*reading.layout.conventions]
        indices, separator = [*places.values()], reading.separator
        try:
            mark = self._sure_mark(reading)
            if mark is None:
                raise ValueError
            plain_rows = (self._counted(reading, i, mark) for i in range(len(self.rows)))
            table = np.loadtxt(
                plain_rows, delimiter=separator or None, usecols=indices, comments=None, ndmin=2
            )
            if mark == ",":
                self.conventions.append(DECIMAL_COMMA)
                self.rows = [row.replace(",", ".") for row in self.rows]
        except ValueError:
            self._spell_plainly(reading)
            indices, separator = [*range(len(indices))], ""
            table = np.loadtxt(self.rows, comments=None, ndmin=2)
        low = _low_parts(self.rows, separator or None, indices, table)
        columns, rest = (
            dict(zip(places, np.ascontiguousarray(part.T), strict=True)) for part in (table, low)
        )
        return reading.layout.converted(columns, rest if low.any() else {})

    def _take_lines(self, stream: IO[bytes]) -> None:
        """Take the rows, and from the first of them and the lines above it the ways to read them."""
        for line, data in enumerate(iter(partial(stream.readline, MAX_LINE + 1), b""), 1):
            if len(data) > MAX_LINE:
                got = f"a line of more than {MAX_LINE} bytes"
                raise InputError(self.name, got, "lines of numbers", "Is it text?")
            if line > MAX_LINES:
                got, most = (
                    f"more than {MAX_LINES} lines",
                    f"at most {MAX_LINES}, comments and empty ones included",
                )
                raise InputError(self.name, got, most, "Thin the output out.")
            if not self.rows and (binary := _binary(data)):
                got, advice = binary
                raise InputError(self.name, got, "text in UTF-8", advice)
            text = data.decode("utf-8", "replace").strip(" \r\n\v\f")
            text = text.removeprefix("\ufeff") if line == 1 else text
            if says_nothing(text):
                continue
            if "\r" in text:
                raise InputError(
                    self.name,
                    "lines that end with CR alone",
                    "LF or CR LF",
                    "Save it with other line ends.",
                )
            cut_off = data[-1:] != b"\n"
            begins = text.lstrip()
            if begins[0] in MARKS and (remark := COMMENT.match(begins)):
                if not self.rows:
                    self.header.add(line, remark[1], True)
                if remark[1].split()[:1] == ["P"] and not self.alone:
                    self._take_transit(remark[1], line)
            elif self.rows or self._begins(text, line):
                if len(self.rows) == MAX_ROWS:
                    most = f"at most {MAX_ROWS}"
                    raise InputError(
                        self.name, f"more than {MAX_ROWS} rows", most, "Thin the output out."
                    )
                self.rows.append(text)
                self.lines.append(line)
            if cut_off:
                self.notes.append("the last line does not end with a newline: it may be cut off")

    def _take_transit(self, remark: str, line: int) -> None:
        try:
            self.transits.append(float(remark.split()[2]))
        except (IndexError, ValueError):
            expected = "# P, a count, a time in s, a frequency"
            raise InputError(f"{self.name}: line {line}", f"# {remark[:80]}", expected) from None

    def _begins(self, text: str, line: int) -> bool:
        """Return True if a line is the first row, after taking from it and the lines above the ways to read it."""
        separators = possible_separators(text)
        if not separators:
            self.header.add(line, text, False)
            return False
        of_header = [
            (separator, 0.0) for separator in SEPARATORS if self.header.uses(separator, text)
        ]
        separators = of_header or separators
        refusals, readings = [], []
        for separator, share in separators:
            try:
                readings.append(TextReading(separator, *self.header.layout(text, separator, line)))
            except InputError as error:
                refusals.append((share, error))
        if not readings:
            raise refusals[0][1]
        if not self.header.decides and any(share == 1 for share, _ in refusals):
            got = f"{text[:40]}, which may be one number or two"
            raise InputError(
                f"{self.name}: line {line}",
                got,
                "a first line that names the columns",
                f"Write {','.join(self.header.needed)} above it.",
            )
        self.readings = [reading for reading in readings if reading.fits(text)] or readings[:1]
        return True

    def _only_reading(self) -> TextReading:
        """Return the one way to read all rows.

        Raises:
            InputError: there are two that give other numbers.
        """
        if len(self.readings) == 1:
            return self.readings[0]
        possible = [reading for reading in self.readings if all(map(reading.fits, self.rows))]
        for other in possible[1:]:
            same_columns = [*possible[0].layout.places] == [*other.layout.places]
            for row, line in zip(self.rows, self.lines, strict=True):
                first, second = ([*map(_value, way.fields(row))] for way in (possible[0], other))
                if not same_columns or first != second:
                    got, expected = (
                        f"{', '.join(first)} or {', '.join(second)} from {row!r}",
                        "one way to read it",
                    )
                    advice = "Name the columns in a first line, and separate them by semicolons."
                    raise InputError(f"{self.name}: line {line}", got[:80], expected, advice)
        return (possible or self.readings)[0]

    def _sure_mark(self, reading: TextReading) -> str | None:
        """Return the decimal mark of all numbers if a look at the rows shows it; None if each has to be looked at."""
        marks = [
            mark
            for mark in ',."'
            if mark != reading.separator and any(mark in row for row in self.rows)
        ]
        if len(marks) != 1 or marks == ['"']:
            return None
        mark = marks[0]
        some = [number for row in self.rows[:SAMPLE] for number in reading.fields(row)]
        proven = any(mark in number and not GROUPED.fullmatch(number) for number in some)
        return mark if proven else None

    def _counted(self, reading: TextReading, i: int, mark: str) -> str:
        """Return a row, with points for commas if the decimal mark is a comma.

        Raises:
            InputError: it has more or fewer fields than there are columns.
        """
        row, separator = self.rows[i], reading.separator
        count = row.count(separator) + 1 if separator else len(row.split())
        if count != reading.width and not reading.counts(row):
            self._refuse_count(reading, i)
        return row.replace(",", ".") if mark == "," else row

    def _refuse_count(self, reading: TextReading, i: int) -> None:
        count = len(without_end(split(self.rows[i], reading.separator)))
        expected = f"{reading.width} as in the first row"
        advice = "Is the line cut off?"
        if count > reading.width:
            advice = COMMAS if reading.separator == "," else "Are there two numbers in one field?"
        raise InputError(f"{self.name}: line {self.lines[i]}", f"{count} fields", expected, advice)

    def _spell_plainly(self, reading: TextReading) -> None:
        """Put the numbers of the columns that are read in place of the rows, with points and separated by blanks.

        Rows in which a position is missing are left out.

        Raises:
            InputError: a row or a number cannot be read, or in two ways.
        """
        names = [*reading.layout.places]
        columns: list[list[str]] = [[] for _ in names]
        lines, lost = array("l"), []
        for i, row in enumerate(self.rows):
            if not reading.counts(row):
                self._refuse_count(reading, i)
            fields = reading.fields(row)
            missing = [is_missing(field) for field in fields]
            if any(missing) and not self.alone and (all(missing) or not missing[0]):
                lost.append(fields[0])
                continue
            for name, field in zip(names, fields, strict=True):
                if not (is_number(field) or (name == "t" and is_clock(field))):
                    raise self._no_number(self.lines[i], name, field)
            for column, field in zip(columns, fields, strict=True):
                column.append(field)
            lines.append(self.lines[i])
        if not lines:
            raise InputError(
                self.name, f"no number of {' or '.join(names[1:])} in any row", "rows of numbers"
            )
        if lost:
            self.notes.append(
                f"{counted(len(lost), 'row')} without a position left out, the first at t = {lost[0] or '?'}"
            )
        self.lines = lines
        written = columns
        if is_clock(columns[0][0]):
            written = columns[1:]
            columns[0] = self._clock(columns[0], reading)
        elif any(is_clock(text) for text in columns[0]):
            i = next(i for i, text in enumerate(columns[0]) if is_clock(text))
            raise self._no_number(lines[i], "t", columns[0][i])
        self._check_marks(written, reading)
        if any("," in number for column in written for number in column):
            self.conventions.append(DECIMAL_COMMA)
        self.rows = [" ".join(map(plain, fields)) for fields in zip(*columns, strict=True)]

    def _no_number(self, line: int, name: str, field: str) -> InputError:
        advice = ""
        if THOUSANDS.fullmatch(field):
            advice = "Write numbers without marks between thousands."
        elif name == "t":
            advice = (
                HOW if re.search(r"\d[:/-]\d", field) else "Write # before lines that are no rows."
            )
        return InputError(f"{self.name}: line {line}: {name}", field[:40], "a number", advice)

    def _clock(self, texts: Sequence[str], reading: TextReading) -> list[str]:
        """Return in s what a clock shows: since the first row if it does not begin at 0, but of transits as it stands.

        Raises:
            InputError: a text is not a time of day, or its column has a unit that no time of day has.
        """
        if "t" in reading.layout.factors:
            raise InputError(
                f"{self.name}: t", texts[0], "a number, as its unit says", "Leave the unit out."
            )
        places = [f"{self.name}: line {line}: t" for line in self.lines]
        times = [seconds_of(text, place) for text, place in zip(texts, places, strict=True)]
        kind = (
            "dates with hours:minutes:seconds"
            if MOMENT.fullmatch(texts[0])
            else "hours:minutes:seconds"
        )
        self.conventions.append(Deviation("clock_text", f"times are {kind}, converted to seconds"))
        if self.alone or not times[0]:
            return [decimal(time) for time in times]
        self.clock_s = float(times[0])
        return counted_from(times[0], times)

    def _check_marks(self, columns: Sequence[Sequence[str]], reading: TextReading) -> None:
        """Refuse numbers whose marks may be decimal or not."""
        commas_separate = reading.separator == ","
        doubtful = doubtful_number(columns, commas_separate)
        if doubtful is not None:
            mark = "comma" if "," in doubtful else "point"
            got, expected = (
                doubtful,
                f"a {mark} that is decimal or one between thousands, and some number that shows which",
            )
            advice = f"Write {doubtful.replace(',', '.')}0 or {re.sub('[,.]', '', doubtful)}."
            raise InputError(self.name, got, expected, advice)
        fractions = any("." in number or "," in number for column in columns for number in column)
        needless = (
            None
            if fractions or not commas_separate
            else padded([number for column in columns for number in column])
        )
        if needless is not None:
            raise InputError(
                self.name,
                f"{needless} between commas",
                "whole numbers without needless zeros",
                COMMAS,
            )


def _value(field: str) -> str:
    """Return the number in a field in one form, whatever form it has; other fields as they are."""
    return repr(float(plain(field))) if is_number(field) else field


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
    # that are significant
    digits = sum(map(str.isdigit, text.lower().partition("e")[0].strip().lstrip("+-0.")))
    sure = of_time and digits <= SURE_DIGITS
    # a number that underflows to 0 is below every scale here
    if near == 0 or not math.isfinite(near) or (digits <= DOUBLE_DIGITS and not sure):
        return 0.0
    printed = Decimal(text.strip())
    difference = _EXACT.subtract(printed, Decimal(near))
    half_a_unit = Decimal((0, (5,), int(printed.as_tuple().exponent) - 1))
    return float(difference) if sure or abs(difference) > half_a_unit else 0.0
