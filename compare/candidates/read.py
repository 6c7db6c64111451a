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

import errno
import math
import os
import stat
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from decimal import Context, Decimal
from pathlib import Path
from typing import BinaryIO

import numpy as np

from reference import InputError
from reference.errors import plain
from reference.numbers.precision import Array
from reference.system.documents import open_at_once

from .arrays import read_archive, read_array
from .candidate import Candidate, Deviation, checked_transits
from .names import NEEDED, Layout, Naming
from .text import COMMENT, Header, Spelling, chunks, is_number, spelling

_TELLING = 6  # bytes that tell an archive from text
MAX_ROWS = 2_000_000
SAMPLE = 50  # rows of a chunk that are searched for numbers with more digits than a double's
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
    with _opened(source, "CANDIDATE", "a readable file, or - for standard input") as (stream, head, name):
        return read_stream(stream, name, head, Naming(tuple(columns), tuple(units)))


def read_stream(stream: BinaryIO, name: str, head: bytes = b"", naming: Naming | None = None) -> Candidate:
    """Read a candidate in any of the formats from a stream of bytes, of which `head` has been read already."""
    head += stream.read(_TELLING - len(head))
    reader = read_archive if head.startswith(b"PK") else read_array if head.startswith(b"\x93NUMPY") else read_text
    return reader(stream, head, name, naming or Naming())


def read_transits(source: str | Path, units: Sequence[str] = ()) -> Array:
    """Read times of xdot = 0 in s from a CSV file with a column t, or from standard input if `source` is "-".

    Raises:
        InputError: the file cannot be read; the message names the line.
    """
    with _opened(source, "--transits", "a readable CSV file") as (stream, head, name):
        columns, _ = ColumnReader(name, ("t",), Naming((), tuple(units))).columns(stream, head)
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


def read_text(stream: BinaryIO, head: bytes, name: str, naming: Naming) -> Candidate:
    """Read a candidate from a stream of bytes, of which `head` has been read already.

    Raises:
        InputError: the text cannot be read; the message names the line.
    """
    reader = ColumnReader(name, NEEDED, naming)
    columns, low = reader.columns(stream, head)
    times = checked_transits(np.array(reader.transits), f"{name}: # P") if reader.transits else None
    notes = ("the last line does not end with a newline: it may be cut off",) if reader.cut_off else ()
    conventions = reader.conventions
    return Candidate.of(name, columns.pop("t"), columns, low=low, transits=times, notes=notes, conventions=conventions)


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
        self.spelled = Spelling(None)
        self.layout: Layout | None = None  # once a row has been seen
        self.places: dict[str, int] = {}  # of the layout
        self.fields = 0  # of a row
        self.blocks: list[Array] = []
        self.low_blocks: list[Array] = []
        self.transits: list[float] = []  # that comments of foucPend name
        self.rows = self.line = 0
        self.cut_off = False  # the last line does not end with a newline

    def columns(self, stream: BinaryIO, head: bytes = b"") -> tuple[dict[str, Array], dict[str, Array]]:
        """Return the columns by name in SI units, and their low parts if some number is finer than a double.

        Args:
            stream: bytes in UTF-8.
            head: bytes that have been read from it already.

        Raises:
            InputError: the text cannot be read; the message names the line.
        """
        for lines, complete in chunks(stream, self.name, head):
            self.cut_off = not complete
            self._read_lines(lines)
        if self.layout is None:
            formats = " with a column t" if self.alone else ", foucPend's output, .npy or .npz"
            raise self.header.refuse(f"a CSV file{formats}")
        finer = any(block.any() for block in self.low_blocks)
        return self.layout.converted(self._joined(self.blocks), self._joined(self.low_blocks) if finer else {})

    @property
    def conventions(self) -> tuple[Deviation, ...]:
        """Return what is to be said of the way in which it was read."""
        said = () if self.layout is None else self.layout.conventions
        return (*said, DECIMAL_COMMA) if self.spelled.decimal_comma else said

    def _joined(self, blocks: list[Array]) -> dict[str, Array]:
        table = np.concatenate(blocks)
        return {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(self.places)}

    def _read_lines(self, lines: list[str]) -> None:
        rows: list[str] = []
        numbers: list[int] = []
        for number, line in enumerate(lines, self.line + 1):
            text = line.strip().removeprefix("\ufeff")
            if not text:
                continue
            if remark := COMMENT.match(text):
                if self.layout is None:
                    self.header.add(number, remark[1], True)
                if remark[1].split()[:1] == ["P"] and not self.alone:
                    self._take_transit(remark[1], number)
            elif self.layout is not None or self._begins(text, number):
                rows.append(text)
                numbers.append(number)
        self.line += len(lines)
        self.rows += len(rows)
        if self.rows > MAX_ROWS:
            raise InputError(self.name, f"more than {MAX_ROWS} rows", f"at most {MAX_ROWS}", "Thin the output out.")
        if rows:
            self._parse(rows, numbers)

    def _take_transit(self, remark: str, line: int) -> None:
        try:
            self.transits.append(float(remark.split()[2]))
        except (IndexError, ValueError):
            expected = "# P, a count, a time in s, a frequency"
            raise InputError(f"{self.name}: line {line}", f"# {remark[:80]}", expected) from None

    def _begins(self, text: str, number: int) -> bool:
        """Return True if a line is the first row, after taking from it and the lines above which column is where."""
        spelled = spelling(text)
        if spelled is None:
            self.header.add(number, text, False)
            return False
        self.spelled = spelled
        self.layout, self.fields = self.header.layout(text, spelled, number)
        self.places = self.layout.places
        return True

    def _parse(self, lines: list[str], numbers: list[int]) -> None:
        separator, indices = self.spelled.separator, [*self.places.values()]
        lines = [self.spelled.plain(line) for line in lines]
        try:
            uniform = {line.count(separator) if separator else len(line.split()) - 1 for line in lines}
            if uniform != {self.fields - 1}:
                raise ValueError
            block = np.loadtxt(lines, delimiter=separator, usecols=indices, comments=None, ndmin=2)
        except ValueError:
            self._refuse_bad_line(lines, numbers)
            raise InputError(self.name, "a number that cannot be read", "decimal numbers") from None
        if self.blocks:
            self._check_order(self.blocks[-1][-1, 0], block[0, 0], numbers[0])
        self.blocks.append(block)
        self.low_blocks.append(_low_parts(lines, separator, indices, block))

    def _check_order(self, before: float, after: float, line: int) -> None:
        """Refuse a stream whose times do not increase from chunk to chunk at once, not after a gigabyte."""
        unordered = after < before if self.alone else after <= before
        if math.isfinite(before) and math.isfinite(after) and unordered:
            raise InputError(
                f"{self.name}: line {line}", f"t = {after:.17g} after {before:.17g}", "strictly increasing times"
            )

    def _refuse_bad_line(self, lines: list[str], numbers: list[int]) -> None:
        """Raise an error for the first line that has another number of fields than the first, or no number in one."""
        for line, number in zip(lines, numbers, strict=True):
            fields = line.split(self.spelled.separator)
            if len(fields) != self.fields:
                got, expected = f"{len(fields)} fields", f"{self.fields} as in the first row"
                raise InputError(f"{self.name}: line {number}", got, expected, "Is the line cut off?")
            for name, i in self.places.items():
                if not is_number(fields[i].strip()):
                    raise InputError(f"{self.name}: line {number}: {name}", fields[i].strip()[:40], "a number")


def _low_parts(lines: list[str], separator: str | None, indices: list[int], block: Array) -> Array:
    """Return the printed numbers minus their doubles; zeros if a sample of rows holds nothing but doubles."""

    def of_row(line: str, row: Array) -> list[float]:
        fields = line.split(separator)
        return [low_part(fields[k], float(row[i]), of_time=i == 0) for i, k in enumerate(indices)]

    sample = range(0, len(lines), 1 + len(lines) // SAMPLE)
    if not any(any(of_row(lines[i], block[i])[1:]) for i in sample):
        return np.broadcast_to(0.0, block.shape)
    return np.array([of_row(line, row) for line, row in zip(lines, block, strict=True)])


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
