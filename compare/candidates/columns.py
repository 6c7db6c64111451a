"""Read columns of numbers from text: one header line that names them, and rows.

Fields are separated by commas, semicolons or white space. Lines that start with # are comments, and the header may be
one. Columns of other names are ignored.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import BinaryIO

import numpy as np

from reference import InputError
from reference.precision import Array

from .decimals import low_part, low_part_of_time
from .lines import chunks, is_number

MAX_ROWS = 2_000_000
SAMPLE = 50  # rows of a chunk that are searched for numbers with more digits than a double's


class ColumnReader:
    """A reader of one text; `columns` reads it.

    Args:
        name: its name in messages.
        needed: columns that must be there; times come first.
        optional: columns that are read if they are there.
        headless: first columns of a text without a header, separated by white space; empty if it needs a header.
        expected: what the text ought to be, for the message about an empty one.
        comment: called with each comment, without its #, and the number of its line.
    """

    def __init__(
        self,
        name: str,
        needed: tuple[str, ...],
        optional: tuple[str, ...] = (),
        headless: tuple[str, ...] = (),
        expected: str = "a CSV file with a column t",
        comment: Callable[[str, int], None] = lambda text, line: None,
    ) -> None:
        self.name, self.needed, self.headless = name, needed, headless
        self.expected, self.comment = expected, comment
        self.known = [*needed, *optional]
        more = f" and, if there, {', '.join(optional)}" if optional else ""
        self.advice = f"The first line names the columns: {', '.join(needed)}{more}."
        self.header: list[str] | None = None  # names of all columns, once known
        self.remark = ""  # the last comment before the first row that may be the header
        self.separator: str | None = None  # of the header, then of the rows; None is white space
        self.blocks: list[Array] = []
        self.low_blocks: list[Array] = []
        self.rows = self.line = 0
        self.cut_off = False  # the last line does not end with a newline

    def columns(self, stream: BinaryIO, head: bytes = b"") -> tuple[dict[str, Array], dict[str, Array]]:
        """Return the columns by name, and their low parts if some number has more digits than a double holds.

        Args:
            stream: bytes in UTF-8.
            head: bytes that have been read from it already.

        Raises:
            InputError: the text cannot be read; the message names the line.
        """
        for lines, complete in chunks(stream, self.name, head):
            self.cut_off = not complete
            self._read_lines(lines)
        if self.header is None and self.remark:
            self._take_header(self.remark)
        if self.header is None:
            raise InputError(self.name, "no header and no rows", self.expected, self.advice)
        low = any(block.any() for block in self.low_blocks)
        return self._joined(self.blocks), self._joined(self.low_blocks) if low else {}

    def _joined(self, blocks: list[Array]) -> dict[str, Array]:
        table = np.concatenate(blocks) if blocks else np.empty((0, len(self.names)))
        return {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(self.names)}

    @property
    def names(self) -> list[str]:
        """Names of the columns that are read."""
        assert self.header is not None
        return [name for name in self.known if name in self.header]

    def _read_lines(self, lines: list[str]) -> None:
        rows: list[str] = []
        numbers: list[int] = []
        for number, line in enumerate(lines, self.line + 1):
            text = line.strip().removeprefix("\ufeff")
            if not text:
                continue
            if text[0] == "#":
                comment = text[1:].strip()
                if self.header is None and set(self.known) & set(_names(comment)):
                    self.remark = comment  # numpy.savetxt writes the header as a comment
                self.comment(comment, number)
            elif self.header is not None or self._read_header(text):
                rows.append(text)
                numbers.append(number)
        self.line += len(lines)
        self.rows += len(rows)
        if self.rows > MAX_ROWS:
            raise InputError(self.name, f"more than {MAX_ROWS} rows", f"at most {MAX_ROWS}", "Thin the output out.")
        if rows:
            self._parse(rows, numbers)

    def _read_header(self, text: str) -> bool:
        """Read the columns' names from the first line that is no comment; return True if that line is a row already."""
        fields = _names(text)
        if not any(map(is_number, fields)):
            self._take_header(text)
            return False
        of_remark = _names(self.remark)
        if len(of_remark) == len(fields) or (_separator(self.remark) and set(self.needed) <= set(of_remark)):
            self._take_header(self.remark)
        elif self.headless and _separator(text) is None and len(fields) >= len(self.headless):
            self.header = [*self.headless, *[""] * (len(fields) - len(self.headless))]
        else:
            raise InputError(f"{self.name}: first line", text[:80], "a header that names the columns", self.advice)
        return True

    def _take_header(self, text: str) -> None:
        names = _names(text)
        for name in self.needed:
            if names.count(name) != 1:
                got = "none" if name not in names else f"{names.count(name)} of them"
                raise InputError(f"{self.name}: header", f"{got} in {text[:80]!r}", f"one column {name}", self.advice)
        for name in self.known:
            if names.count(name) > 1:
                raise InputError(f"{self.name}: header", text[:80], f"one column {name} at most")
        self.header, self.separator = names, _separator(text)

    def _parse(self, lines: list[str], numbers: list[int]) -> None:
        assert self.header is not None
        indices = [self.header.index(name) for name in self.names]
        if not self.blocks and (self.separator is None or self.separator not in lines[0]):
            self.separator = _separator(lines[0])
        try:
            uniform = {line.count(self.separator) if self.separator else len(line.split()) - 1 for line in lines}
            if uniform != {len(self.header) - 1}:
                raise ValueError
            block = np.loadtxt(lines, delimiter=self.separator, usecols=indices, comments=None, ndmin=2)
        except ValueError:
            self._refuse_bad_line(lines, numbers)
            raise InputError(self.name, "a number that cannot be read", "decimal numbers") from None
        if self.blocks:
            self._check_order(self.blocks[-1][-1, 0], block[0, 0], numbers[0])
        self.blocks.append(block)
        self.low_blocks.append(_low_parts(lines, self.separator, indices, block))

    def _check_order(self, before: float, after: float, line: int) -> None:
        """Refuse a stream whose times do not increase from chunk to chunk at once, not after a gigabyte."""
        if math.isfinite(before) and math.isfinite(after) and after <= before:
            raise InputError(
                f"{self.name}: line {line}", f"t = {after:.17g} after {before:.17g}", "strictly increasing times"
            )

    def _refuse_bad_line(self, lines: list[str], numbers: list[int]) -> None:
        """Raise an error for the first line that has another number of fields than the header, or no number in one."""
        assert self.header is not None
        for line, number in zip(lines, numbers, strict=True):
            fields = line.split(self.separator)
            if len(fields) != len(self.header):
                got, expected = f"{len(fields)} fields", f"{len(self.header)} as in the first line"
                raise InputError(f"{self.name}: line {number}", got, expected, "Is the line cut off?")
            for name, text in zip(self.header, fields, strict=True):
                if name in self.known and not is_number(text.strip()):
                    raise InputError(f"{self.name}: line {number}: {name}", text.strip()[:40], "a number")


def _separator(text: str) -> str | None:
    return "," if "," in text else ";" if ";" in text else None


def _names(text: str) -> list[str]:
    return [word.strip().strip('"').lower() for word in text.split(_separator(text))]


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
