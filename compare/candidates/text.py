"""Read a candidate from text: rows of numbers under a header that names the columns, or the output of foucPend.

- A line names the columns in any order: t, x, y and any of z, vx, vy, vz, in these words or others; see `names.py`.
- Without such a line three columns are t, x, y, four are t, x, y, z.
- Fields are separated by commas, semicolons, tabs or white space. A line that begins with #, %, ! or // is a comment,
  and the header may be one. Columns of other names are not read.
- foucPend (Mathar, appendix B): no header; t x y z X Y Z φ λ speed separated by white space, of which the first
  four are read; `# P n t f` names a transit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from decimal import Context, Decimal
from typing import BinaryIO

import numpy as np

from reference import InputError
from reference.numbers.precision import Array

from .candidate import COLUMNS, Candidate, Deviation, checked_transits
from .layout import Header, Layout, Naming
from .spelling import MARKS, Spelling, chunks, comment, is_number, spelling

DOUBLE_DIGITS = 17  # decimal digits that identify a double
SURE_DIGITS = 15  # decimals of up to this many digits survive a double, so a precise program means the decimal itself
_EXACT = Context(prec=40)  # rounds a difference to 40 digits, far more than a low part holds


def significant_digits(text: str) -> int:
    """Count the significant digits of a printed number."""
    return sum(map(str.isdigit, text.lower().partition("e")[0].strip().lstrip("+-0.")))


def low_part(text: str, near: float) -> float:
    """Return the printed number minus `near`, its nearest double; 0 if it may be just that double, printed."""
    if significant_digits(text) <= DOUBLE_DIGITS:
        return 0.0
    printed, difference = _difference(text, near)
    half_a_unit = Decimal((0, (5,), int(printed.as_tuple().exponent) - 1))
    return 0.0 if abs(difference) <= half_a_unit else float(difference)


def low_part_of_time(text: str, near: float) -> float:
    """Return the same for a time beside numbers more precise than doubles: there 0.1 is the decimal itself."""
    if significant_digits(text) <= SURE_DIGITS:
        return float(_difference(text, near)[1])
    return low_part(text, near)


def _difference(text: str, near: float) -> tuple[Decimal, Decimal]:
    if near == 0 or not math.isfinite(near):  # a number that underflows to 0 is below every scale here
        return Decimal(0), Decimal(0)
    printed = Decimal(text.strip())
    return printed, _EXACT.subtract(printed, Decimal(near))


MAX_ROWS = 2_000_000
SAMPLE = 50  # rows of a chunk that are searched for numbers with more digits than a double's
DECIMAL_COMMA = Deviation("decimal_comma", "numbers have a comma for the decimal point")


def read_text(stream: BinaryIO, head: bytes, name: str, naming: Naming) -> Candidate:
    """Read a candidate from a stream of bytes, of which `head` has been read already.

    Raises:
        InputError: the text cannot be read; the message names the line.
    """
    transits: list[float] = []

    def read_transit(comment: str, line: int) -> None:
        words = comment.split()
        if words and words[0] == "P":
            try:
                transits.append(float(words[2]))
            except (IndexError, ValueError):
                expected = "# P, a count, a time in s, a frequency"
                raise InputError(f"{name}: line {line}", f"# {comment[:80]}", expected) from None

    expected = "a CSV file, foucPend's output, .npy or .npz"
    reader = ColumnReader(name, ("t", "x", "y"), COLUMNS[2:], naming, expected, read_transit)
    columns, low = reader.columns(stream, head)
    times = checked_transits(np.array(transits), f"{name}: # P") if transits else None
    notes = ("the last line does not end with a newline: it may be cut off",) if reader.cut_off else ()
    conventions = reader.conventions
    return Candidate.of(name, columns.pop("t"), columns, low=low, transits=times, notes=notes, conventions=conventions)


class ColumnReader:
    """A reader of one text; `columns` reads it.

    Args:
        name: its name in messages.
        needed: columns that must be there; times come first.
        optional: columns that are read if they are there.
        naming: what the user says of the columns.
        expected: what the text ought to be, for the message about an empty one.
        on_comment: called with each comment, without its mark, and the number of its line.
        repeats: whether times may be equal.
    """

    def __init__(
        self,
        name: str,
        needed: tuple[str, ...],
        optional: tuple[str, ...] = (),
        naming: Naming | None = None,
        expected: str = "a CSV file with a column t",
        on_comment: Callable[[str, int], None] = lambda text, line: None,
        repeats: bool = False,
    ) -> None:
        self.name, self.expected = name, expected
        self.on_comment, self.repeats = on_comment, repeats
        self.header = Header(name, needed, optional, naming or Naming())
        self.spelled = Spelling(None)
        self.layout: Layout | None = None  # once a row has been seen
        self.fields = 0  # of a row
        self.blocks: list[Array] = []
        self.low_blocks: list[Array] = []
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
            raise self.header.refuse(self.expected)
        finer = any(block.any() for block in self.low_blocks)
        return self.layout.converted(self._joined(self.blocks), self._joined(self.low_blocks) if finer else {})

    @property
    def conventions(self) -> tuple[Deviation, ...]:
        """Return what is to be said of the way in which it was read."""
        said = () if self.layout is None else self.layout.conventions
        return (*said, DECIMAL_COMMA) if self.spelled.decimal_comma else said

    def _joined(self, blocks: list[Array]) -> dict[str, Array]:
        table = np.concatenate(blocks)
        return {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(self._places)}

    @property
    def _places(self) -> dict[str, int]:
        return {} if self.layout is None else self.layout.places

    def _read_lines(self, lines: list[str]) -> None:
        rows: list[str] = []
        numbers: list[int] = []
        for number, line in enumerate(lines, self.line + 1):
            text = line.strip().removeprefix("\ufeff")
            if not text:
                continue
            remark = comment(text) if text[0] in MARKS else None
            if remark is not None:
                if self.layout is None:
                    self.header.add(number, remark, True)
                self.on_comment(remark, number)
            elif self.layout is not None or self._begins(text, number):
                rows.append(text)
                numbers.append(number)
        self.line += len(lines)
        self.rows += len(rows)
        if self.rows > MAX_ROWS:
            raise InputError(self.name, f"more than {MAX_ROWS} rows", f"at most {MAX_ROWS}", "Thin the output out.")
        if rows:
            self._parse(rows, numbers)

    def _begins(self, text: str, number: int) -> bool:
        """Return True if a line is the first row, after taking from it and the lines above which column is where."""
        spelled = spelling(text)
        if spelled is None:
            self.header.add(number, text, False)
            return False
        self.spelled = spelled
        self.layout, self.fields = self.header.layout(text, spelled, number)
        return True

    def _parse(self, lines: list[str], numbers: list[int]) -> None:
        separator, indices = self.spelled.separator, [*self._places.values()]
        lines = lines if self.spelled.is_plain else [self.spelled.plain(line) for line in lines]
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
        unordered = after < before if self.repeats else after <= before
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
            for name, i in self._places.items():
                if not is_number(fields[i].strip()):
                    raise InputError(f"{self.name}: line {number}: {name}", fields[i].strip()[:40], "a number")


def _low_parts(lines: list[str], separator: str | None, indices: list[int], block: Array) -> Array:
    """Return the printed numbers minus their doubles; zeros if a sample of rows holds nothing but doubles."""
    sample = range(0, len(lines), 1 + len(lines) // SAMPLE)
    if not any(_low_parts_of_row(lines[i].split(separator), indices, block[i])[1:].any() for i in sample):
        return np.broadcast_to(0.0, block.shape)
    return np.array(
        [_low_parts_of_row(line.split(separator), indices, row) for line, row in zip(lines, block, strict=True)]
    )


def _low_parts_of_row(fields: list[str], indices: list[int], row: Array) -> Array:
    t, *others = ((fields[k], float(value)) for k, value in zip(indices, row, strict=True))
    return np.array([low_part_of_time(*t), *(low_part(*other) for other in others)])
