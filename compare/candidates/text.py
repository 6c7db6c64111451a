"""Reads a candidate from text, chunk by chunk, in CSV or in the format of the paper's program.

- CSV: one header line with t, x, y and any of z, vx, vy, vz in any order (other columns are passed over);
  comma separated; lines that start with # are comments, and the header may be one.
- foucPend (Mathar, appendix B): no header; white space between t x y z X Y Z φ λ speed, of which the first
  four are read; `# P n t f` names a transit.
"""

from __future__ import annotations

import math
from typing import BinaryIO

import numpy as np

from reference import InputError
from reference.precision import Array

from .candidate import COLUMNS, HEADER_ADVICE, Candidate
from .decimals import lacking, lacking_of_time
from .lines import chunks, is_number
from .transit_times import checked_transits

MAX_ROWS = 2_000_000
LOOKED_AT = 50  # rows of a chunk in which numbers with more to say than a double are looked for
_NEEDED = ("t", "x", "y")


class Text:
    """A reader of one candidate; `name` is what messages call it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.words: list[str] | None = None  # names of all columns, once known
        self.comma = True
        self.blocks: list[Array] = []
        self.rests: list[Array] = []
        self.rows = self.line = 0
        self.transits: list[float] = []
        self.marked = False
        self.notes: list[str] = []

    def read(self, stream: BinaryIO, head: bytes) -> Candidate:
        """The candidate in a stream of bytes, of which `head` was read before.

        Raises:
            InputError: what is wrong, and in which line.
        """
        for lines, whole in chunks(stream, self.name, head):
            if not whole:
                self.notes.append("the last line does not end with a newline: it may be cut off")
            self._take(lines)
        if self.words is None:
            raise InputError(
                self.name, "no header and no rows", "a CSV file, foucPend's output, or .npz", HEADER_ADVICE
            )
        columns = self._columns(self.blocks)
        low = self._columns(self.rests) if any(block.any() for block in self.rests) else {}
        zeros = checked_transits(np.array(self.transits), f"{self.name}: # P") if self.marked else None
        t = columns.pop("t")
        return Candidate.of(self.name, t, columns, low=low, transits=zeros, notes=tuple(self.notes))

    @property
    def kept(self) -> list[str]:
        """The columns that are read, t first."""
        assert self.words is not None
        return ["t", *(word for word in COLUMNS if word in self.words)]

    def _columns(self, blocks: list[Array]) -> dict[str, Array]:
        table = np.concatenate(blocks) if blocks else np.empty((0, len(self.kept)))
        return {word: np.ascontiguousarray(table[:, i]) for i, word in enumerate(self.kept)}

    def _take(self, lines: list[str]) -> None:
        kept: list[str] = []
        numbers: list[int] = []
        for number, line in enumerate(lines, self.line + 1):
            text = line.strip().removeprefix("\ufeff")
            if not text:
                continue
            if text[0] == "#":
                self._comment(text[1:].strip(), number)
            elif self.words is not None or self._header(text):
                kept.append(text)
                numbers.append(number)
        self.line += len(lines)
        self.rows += len(kept)
        if self.rows > MAX_ROWS:
            raise InputError(self.name, f"more than {MAX_ROWS} rows", f"at most {MAX_ROWS}", "Thin the output out.")
        if kept:
            self._parse(kept, numbers)

    def _comment(self, text: str, line: int) -> None:
        words = text.split()
        if self.words is None and set(_NEEDED) <= set(_names(text)):
            self._header(text)  # as numpy.savetxt writes it
        if words and words[0] == "P":
            self.marked = True
            try:
                self.transits.append(float(words[2]))
            except (IndexError, ValueError):
                expected = "# P, a count, a time in s, a frequency"
                raise InputError(f"{self.name}: line {line}", f"# {text[:80]}", expected) from None

    def _header(self, text: str) -> bool:
        """Learn the columns from the first line; True if that line is a row already."""
        if "," not in text:
            fields = text.split()
            if len(fields) >= 4 and all(map(is_number, fields)):
                self.comma, self.words = False, ["t", "x", "y", "z"] + [""] * (len(fields) - 4)
                return True
        words = _names(text)
        if any(map(is_number, words)):
            raise InputError(f"{self.name}: first line", text[:80], "a header that names the columns", HEADER_ADVICE)
        for word in _NEEDED:
            if words.count(word) != 1:
                got = "none" if word not in words else f"{words.count(word)} of them"
                raise InputError(f"{self.name}: header", f"{got} in {text[:80]!r}", f"one column {word}", HEADER_ADVICE)
        for word in COLUMNS:
            if words.count(word) > 1:
                raise InputError(f"{self.name}: header", text[:80], f"one column {word} at most")
        self.words = words
        return False

    def _parse(self, lines: list[str], numbers: list[int]) -> None:
        assert self.words is not None
        width, separator = len(self.words), "," if self.comma else None
        where = [self.words.index(word) for word in self.kept]
        try:
            even = {line.count(",") if self.comma else len(line.split()) - 1 for line in lines} == {width - 1}
            block = np.loadtxt(lines, delimiter=separator, usecols=where, comments=None, ndmin=2) if even else None
        except ValueError:
            block = None
        if block is None:
            self._blame(lines, numbers)
            raise InputError(self.name, "a number that cannot be read", "decimal numbers")
        if self.blocks:
            self._ordered(self.blocks[-1][-1, 0], block[0, 0], numbers[0])
        self.blocks.append(block)
        self.rests.append(_rests(lines, separator, where, block))

    def _ordered(self, before: float, after: float, line: int) -> None:
        """Refuse a stream whose times stand still as soon as that is seen, not after a gigabyte."""
        if math.isfinite(before) and math.isfinite(after) and after <= before:
            raise InputError(
                f"{self.name}: line {line}", f"t = {after:.17g} after {before:.17g}", "strictly increasing times"
            )

    def _blame(self, lines: list[str], numbers: list[int]) -> None:
        """Find the line that does not read as the others do."""
        assert self.words is not None
        for line, number in zip(lines, numbers, strict=True):
            fields = line.split("," if self.comma else None)
            if len(fields) != len(self.words):
                got, expected = f"{len(fields)} fields", f"{len(self.words)} as in the first line"
                raise InputError(f"{self.name}: line {number}", got, expected, "Is the line cut off?")
            for word, text in zip(self.words, fields, strict=True):
                if word in ("t", *COLUMNS) and not is_number(text.strip()):
                    raise InputError(f"{self.name}: line {number}: {word}", text.strip()[:40], "a number")


def _names(text: str) -> list[str]:
    return [word.strip().strip('"').lower() for word in text.split(",")]


def _rests(lines: list[str], separator: str | None, where: list[int], block: Array) -> Array:
    """What the doubles lack against the printed numbers; zeros if a sample of rows has nothing more to say."""
    sample = range(0, len(lines), 1 + len(lines) // LOOKED_AT)
    if not any(_rest(lines[i].split(separator), where, block[i])[1:].any() for i in sample):
        return np.broadcast_to(0.0, block.shape)
    return np.array([_rest(line.split(separator), where, row) for line, row in zip(lines, block, strict=True)])


def _rest(fields: list[str], where: list[int], row: Array) -> Array:
    t, *others = ((fields[k], float(value)) for k, value in zip(where, row, strict=True))
    return np.array([lacking_of_time(*t), *(lacking(*other) for other in others)])
