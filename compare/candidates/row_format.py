"""How a row of numbers is written: what separates its fields, and how numbers are spelled."""

from __future__ import annotations

import re
from dataclasses import dataclass

from .lines import is_number

COMMENTS = ("#", "%", "!", "//")  # a line that begins with one of these is a comment
MARKS = {mark[0] for mark in COMMENTS}
_FORTRAN = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")
_HEXFLOAT = re.compile(r"[+-]?0x[\da-f]+(\.[\da-f]*)?p[+-]?\d+", re.IGNORECASE)  # never read, but no word either
_APART = re.compile(r"\s{2,}|\t")
_BEFORE_BRACKET = re.compile(r"\s+(?=[(\[{])")


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
        return _FORTRAN.sub("e", line) if self.fortran else line

    def fields(self, line: str) -> list[str]:
        """Return the fields of a row."""
        return self.plain(line).split(self.separator)


def spelling(line: str) -> Spelling | None:
    """Return how a line is written if it is a row, that is if most of its fields are numbers; else None."""
    best = Spelling(None)
    fortran, quoted = _FORTRAN.search(line) is not None, '"' in line
    for comma in (False, True) if "," in line else (False,):
        for separator in (",", ";", "\t", None):
            if (separator is not None and separator not in line) or (comma and separator == ","):
                continue
            one = Spelling(separator, comma, fortran, quoted)
            fields = [text.strip() for text in one.fields(line)]
            numbers = sum(is_number(text) or _HEXFLOAT.fullmatch(text) is not None for text in fields)
            share = numbers / max(1, len(fields) - (fields[-1:] == [""]))
            if share > best.share:
                best = Spelling(separator, comma, fortran, quoted, share)
    return best if best.share > 0.5 else None


def words(line: str) -> list[list[str]]:
    """Return the ways to take a header apart, the most likely first; a separator at its end adds no word."""
    ways = [line.split(separator) for separator in (",", ";", "\t") if separator in line]
    ways += [_APART.split(line.strip()), _BEFORE_BRACKET.sub("", line).split(), line.split()]
    return [way[:-1] if len(way) > 1 and not way[-1].strip() else way for way in ways]


def comment(line: str) -> str | None:
    """Return a comment without its mark; None if the line is none."""
    mark = next((mark for mark in COMMENTS if line.startswith(mark)), None)
    return None if mark is None else line[len(mark) :].strip()
