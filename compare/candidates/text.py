"""Read a candidate from text: CSV with named columns, or the output of the paper's program foucPend.

- CSV: one header line with t, x, y and any of z, vx, vy, vz in any order (other columns are ignored); comma
  separated; lines that start with # are comments, and the header may be one.
- foucPend (Mathar, appendix B): no header; t x y z X Y Z φ λ speed separated by white space, of which the first
  four are read; `# P n t f` names a transit.
"""

from __future__ import annotations

import math
from typing import BinaryIO

import numpy as np

from reference import InputError
from reference.precision import Array

from .candidate import COLUMNS, HEADER_ADVICE, Candidate
from .decimals import low_part, low_part_of_time
from .lines import chunks, is_number
from .transit_times import checked_transits

MAX_ROWS = 2_000_000
SAMPLE = 50  # rows of a chunk that are searched for numbers with more digits than a double's
_NEEDED = ("t", "x", "y")


class Text:
    """A reader of one candidate; `name` is its name in messages."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.header: list[str] | None = None  # names of all columns, once known
        self.comma = True
        self.blocks: list[Array] = []
        self.low_blocks: list[Array] = []
        self.rows = self.line = 0
        self.transits: list[float] = []
        self.has_transits = False
        self.notes: list[str] = []

    def read(self, stream: BinaryIO, head: bytes) -> Candidate:
        """Read the candidate from a stream of bytes, of which `head` has been read already.

        Raises:
            InputError: the text cannot be read; the message names the line.
        """
        for lines, complete in chunks(stream, self.name, head):
            if not complete:
                self.notes.append("the last line does not end with a newline: it may be cut off")
            self._read_lines(lines)
        if self.header is None:
            raise InputError(
                self.name, "no header and no rows", "a CSV file, foucPend's output, or .npz", HEADER_ADVICE
            )
        columns = self._columns(self.blocks)
        low = self._columns(self.low_blocks) if any(block.any() for block in self.low_blocks) else {}
        times = checked_transits(np.array(self.transits), f"{self.name}: # P") if self.has_transits else None
        t = columns.pop("t")
        return Candidate.of(self.name, t, columns, low=low, transits=times, notes=tuple(self.notes))

    @property
    def names(self) -> list[str]:
        """Names of the columns that are read, t first."""
        assert self.header is not None
        return ["t", *(name for name in COLUMNS if name in self.header)]

    def _columns(self, blocks: list[Array]) -> dict[str, Array]:
        table = np.concatenate(blocks) if blocks else np.empty((0, len(self.names)))
        return {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(self.names)}

    def _read_lines(self, lines: list[str]) -> None:
        rows: list[str] = []
        numbers: list[int] = []
        for number, line in enumerate(lines, self.line + 1):
            text = line.strip().removeprefix("\ufeff")
            if not text:
                continue
            if text[0] == "#":
                self._comment(text[1:].strip(), number)
            elif self.header is not None or self._read_header(text):
                rows.append(text)
                numbers.append(number)
        self.line += len(lines)
        self.rows += len(rows)
        if self.rows > MAX_ROWS:
            raise InputError(self.name, f"more than {MAX_ROWS} rows", f"at most {MAX_ROWS}", "Thin the output out.")
        if rows:
            self._parse(rows, numbers)

    def _comment(self, text: str, line: int) -> None:
        words = text.split()
        if self.header is None and set(_NEEDED) <= set(_names(text)):
            self._read_header(text)  # numpy.savetxt writes the header as a comment
        if words and words[0] == "P":
            self.has_transits = True
            try:
                self.transits.append(float(words[2]))
            except (IndexError, ValueError):
                expected = "# P, a count, a time in s, a frequency"
                raise InputError(f"{self.name}: line {line}", f"# {text[:80]}", expected) from None

    def _read_header(self, text: str) -> bool:
        """Read the columns' names from the first line; return True if that line is a row already."""
        if "," not in text:
            fields = text.split()
            if len(fields) >= 4 and all(map(is_number, fields)):
                self.comma, self.header = False, ["t", "x", "y", "z"] + [""] * (len(fields) - 4)
                return True
        names = _names(text)
        if any(map(is_number, names)):
            raise InputError(f"{self.name}: first line", text[:80], "a header that names the columns", HEADER_ADVICE)
        for name in _NEEDED:
            if names.count(name) != 1:
                got = "none" if name not in names else f"{names.count(name)} of them"
                raise InputError(f"{self.name}: header", f"{got} in {text[:80]!r}", f"one column {name}", HEADER_ADVICE)
        for name in COLUMNS:
            if names.count(name) > 1:
                raise InputError(f"{self.name}: header", text[:80], f"one column {name} at most")
        self.header = names
        return False

    def _parse(self, lines: list[str], numbers: list[int]) -> None:
        assert self.header is not None
        width, separator = len(self.header), "," if self.comma else None
        indices = [self.header.index(name) for name in self.names]
        try:
            uniform = {line.count(",") if self.comma else len(line.split()) - 1 for line in lines} == {width - 1}
            block = np.loadtxt(lines, delimiter=separator, usecols=indices, comments=None, ndmin=2) if uniform else None
        except ValueError:
            block = None
        if block is None:
            self._refuse_bad_line(lines, numbers)
            raise InputError(self.name, "a number that cannot be read", "decimal numbers")
        if self.blocks:
            self._check_order(self.blocks[-1][-1, 0], block[0, 0], numbers[0])
        self.blocks.append(block)
        self.low_blocks.append(_low_parts(lines, separator, indices, block))

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
            fields = line.split("," if self.comma else None)
            if len(fields) != len(self.header):
                got, expected = f"{len(fields)} fields", f"{len(self.header)} as in the first line"
                raise InputError(f"{self.name}: line {number}", got, expected, "Is the line cut off?")
            for name, text in zip(self.header, fields, strict=True):
                if name in ("t", *COLUMNS) and not is_number(text.strip()):
                    raise InputError(f"{self.name}: line {number}: {name}", text.strip()[:40], "a number")


def _names(text: str) -> list[str]:
    return [word.strip().strip('"').lower() for word in text.split(",")]


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
