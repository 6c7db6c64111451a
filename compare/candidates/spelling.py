"""Text as lines and fields: bytes split into lines within limits, what separates fields, how numbers are spelled."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

from reference import InputError

MAX_BYTES = 1 << 30
MAX_LINE = 1 << 16
MAX_LINES = 4_000_000  # comments and empty lines included
CHUNK = 1 << 22
_BINARY = "Binary data is read from .npz only."
COMMENTS = ("#", "%", "!", "//")  # a line that begins with one of these is a comment
MARKS = {mark[0] for mark in COMMENTS}
FORTRAN = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")
HEXFLOAT = re.compile(r"[+-]?0x[\da-f]+(\.[\da-f]*)?p[+-]?\d+", re.IGNORECASE)  # never read, but no word either
APART = re.compile(r"\s{2,}|\t")
BEFORE_BRACKET = re.compile(r"(?<!\s)\s+(?=[(\[{])")


def chunks(stream: BinaryIO, name: str, head: bytes = b"") -> Iterator[tuple[list[str], bool]]:
    """Yield lists of complete lines, each with a flag: whether the last line ended with a newline.

    Args:
        stream: bytes in UTF-8.
        name: the stream's name in messages.
        head: bytes that have been read from it already.

    Raises:
        InputError: there are too many bytes or lines, a line is too long, or the bytes are not text.
    """
    remainder, total, count = head, len(head), 0
    while data := stream.read(CHUNK):
        total += len(data)
        if total > MAX_BYTES:
            raise InputError(name, f"more than {MAX_BYTES} bytes", f"at most {MAX_BYTES}", "Thin the output out.")
        count += data.count(b"\n")
        if count > MAX_LINES:
            raise InputError(name, f"more than {MAX_LINES} lines", f"at most {MAX_LINES}", "Thin the output out.")
        remainder += data
        complete, newline, remainder = remainder.rpartition(b"\n")
        if newline:
            yield _decoded(complete, name), True
        if len(remainder) > MAX_LINE:
            raise InputError(name, f"a line of more than {MAX_LINE} bytes", "lines of numbers", "Is it text?")
    if remainder.strip():
        yield _decoded(remainder, name), False


def _decoded(data: bytes, name: str) -> list[str]:
    if b"\0" in data:
        raise InputError(name, "a zero byte", "text", _BINARY)
    try:
        return data.decode().split("\n")
    except UnicodeDecodeError:
        raise InputError(name, "bytes that are not UTF-8", "text", _BINARY) from None


def is_number(text: str) -> bool:
    """Return True for a number as C and Fortran print it (NaN and inf too), not for forms that only Python reads."""
    if "_" in text or not text.isascii():
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True


@dataclass(frozen=True)
class Spelling:
    """How the rows of a text are written.

    Attributes:
        separator: between fields; None is white space.
        decimal_comma: whether numbers have a comma for a point.
        fortran: whether some exponent is written with a D.
        quoted: whether some number stands in quotes.
        share: part of the fields of the row looked at that are numbers, from 0 to 1.
    """

    separator: str | None
    decimal_comma: bool = False
    fortran: bool = False
    quoted: bool = False
    share: float = 0.0

    @property
    def is_plain(self) -> bool:
        """True if rows are as `plain` returns them already."""
        return not (self.decimal_comma or self.fortran or self.quoted)

    def plain(self, line: str) -> str:
        """Return a row with a point, an E and no quotes."""
        if self.decimal_comma:
            line = line.replace(",", ".")
        if self.quoted:
            line = line.replace('"', "")
        return FORTRAN.sub("e", line) if self.fortran else line

    def fields(self, line: str) -> list[str]:
        """Return the fields of a row."""
        return self.plain(line).split(self.separator)


def spelling(line: str) -> Spelling | None:
    """Return how a line is written if it is a row, that is if most of its fields are numbers; else None."""
    best = Spelling(None)
    fortran, quoted = FORTRAN.search(line) is not None, '"' in line
    for comma in (False, True) if "," in line else (False,):
        for separator in (",", ";", "\t", None):
            if (separator is not None and separator not in line) or (comma and separator == ","):
                continue
            tried = Spelling(separator, comma, fortran, quoted)
            fields = [text.strip() for text in tried.fields(line)]
            numbers = sum(is_number(text) or HEXFLOAT.fullmatch(text) is not None for text in fields)
            share = numbers / max(1, len(fields) - (fields[-1:] == [""]))
            if share > best.share:
                best = Spelling(separator, comma, fortran, quoted, share)
    return best if best.share > 0.5 else None


def words(line: str) -> list[list[str]]:
    """Return the ways to take a header apart, the most likely first; a separator at its end adds no word."""
    ways = [line.split(separator) for separator in (",", ";", "\t") if separator in line]
    ways += [APART.split(line.strip()), BEFORE_BRACKET.sub("", line).split(), line.split()]
    return [way[:-1] if len(way) > 1 and not way[-1].strip() else way for way in ways]


def comment(line: str) -> str | None:
    """Return a comment without its mark; None if the line is none."""
    mark = next((mark for mark in COMMENTS if line.startswith(mark)), None)
    return None if mark is None else line[len(mark) :].strip()
