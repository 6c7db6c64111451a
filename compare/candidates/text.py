"""Text as lines and fields: limits, what separates fields, how numbers are spelled, the header."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from reference import InputError

from .names import Layout, Naming, advice, by_number, given, layout, meaning

MAX_BYTES = 1 << 30
MAX_LINE = 1 << 20
MAX_LINES = 4_000_000
MARKS = frozenset("#%!/")  # with which a comment begins
COMMENT = re.compile(r"(?:[#%!]|//)\s*(.*)")
FORTRAN = re.compile(r"(?<=[\d.])[dD](?=[+-]?\d)")
HEXFLOAT = re.compile(r"[+-]?0x[\da-f]+(\.[\da-f]*)?p[+-]?\d+", re.IGNORECASE)  # never read, but no word either
APART = re.compile(r"\s{2,}|\t")
MOST = 1000  # lines above the first row that are looked at
FEW = 2  # names of columns in a comment, and half of its words, from which on it is meant as the header
BEFORE_BRACKET = re.compile(r"(?<!\s)\s+(?=[(\[{])")


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
    """

    separator: str | None
    decimal_comma: bool = False
    fortran: bool = False
    quoted: bool = False

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
    best, most = None, 0.5  # of the fields
    fortran, quoted = FORTRAN.search(line) is not None, '"' in line
    for comma in (False, True) if "," in line else (False,):
        for separator in (",", ";", "\t", None):
            if (separator is not None and separator not in line) or (comma and separator == ","):
                continue
            tried = Spelling(separator, comma, fortran, quoted)
            fields = [text.strip() for text in tried.fields(line)]
            numbers = sum(is_number(text) or HEXFLOAT.fullmatch(text) is not None for text in fields)
            share = numbers / max(1, len(fields) - (fields[-1:] == [""]))
            if share > most:
                best, most = tried, share
    return best


def words(line: str) -> list[list[str]]:
    """Return the ways to take a header apart, the most likely first; a separator at its end adds no word."""
    ways = [line.split(separator) for separator in (",", ";", "\t") if separator in line]
    ways += [APART.split(line.strip()), BEFORE_BRACKET.sub("", line).split(), line.split()]
    return [way[:-1] if len(way) > 1 and not way[-1].strip() else way for way in ways]


@dataclass
class Header:
    """The lines above the first row; the header is the last of them that names the columns, a comment or not.

    Attributes:
        name: of the text, in messages.
        needed: columns that must be there, as in `layout`.
        naming: what the user says of the columns.
        lines: those seen, each with its number and whether it is a comment.
    """

    name: str
    needed: Sequence[str]
    naming: Naming
    lines: list[tuple[int, str, bool]] = field(default_factory=list)

    def add(self, number: int, text: str, comment: bool) -> None:
        """Take a line that is no row.

        Raises:
            InputError: there are too many before the first row.
        """
        self.lines.append((number, text, comment))
        if len(self.lines) > MOST:
            if not comment:
                where, expected = f"{self.name}: line {number}", "a row of numbers before it"
                raise InputError(where, text[:80], expected, advice(self.needed))
            del self.lines[0]

    def layout(self, row: str, spelled: Spelling, number: int) -> Layout:
        """Return which column stands where, from the first row and its line.

        Raises:
            InputError: no line names the columns, or one does but not all that are needed, and the first row does not
                tell either.
        """
        fields = spelled.fields(row)
        count = len(fields) - (len(fields) > 1 and not fields[-1].strip())
        if self.naming.columns:
            return given(count, self.naming)
        for above, text, is_comment in reversed(self.lines):
            header = self._named(text, count, is_comment)
            if header is not None:
                if len(header) != count:
                    got, expected = f"{count} fields", f"{len(header)} as in the header, line {above}"
                    raise InputError(f"{self.name}: line {number}", got, expected, "Is the line cut off?")
                return layout(header, self.needed, self.naming, f"{self.name}: header")
        made = by_number(count, self.needed, self.naming)
        if made is None or (len(self.needed) == 1 and self.lines):
            expected = "a header that names the columns"
            raise InputError(f"{self.name}: first line", row[:80], expected, advice(self.needed))
        return made

    def _named(self, text: str, count: int, is_comment: bool) -> list[str] | None:
        """Return the words of a line that names the columns, or is meant to; None for another."""
        ways = [(way, _columns(way)) for way in words(text)]
        fitting = [(way, named) for way, named in ways if len(way) == count]
        for way, named in fitting:
            if set(self.needed) <= named:
                return way
        for way, named in ways:  # of another number of columns
            if set(self.needed) <= named and (not is_comment or len(named) == len(way)):
                return way
        enough = max(min(FEW, len(self.needed)), count // 2) if is_comment else 0
        return next((way for way, named in fitting if len(named) >= enough), None)

    def refuse(self, expected: str) -> InputError:
        """Return the error for a text without rows."""
        for i, (_, text, _) in enumerate(self.lines):
            if any(set(self.needed) <= _columns(way) for way in words(text)):
                later = [(number, line) for number, line, is_comment in self.lines[i + 1 :] if not is_comment]
                if later:
                    return InputError(f"{self.name}: line {later[0][0]}", later[0][1][:80], "a row of numbers")
                why = "All lines are comments." if self.lines[i + 1 :] else "Is the output empty?"
                return InputError(self.name, "no rows", "at least one row", why)
        first = next((line for line in self.lines if not line[2]), None)
        if first is not None:
            return InputError(f"{self.name}: line {first[0]}", first[1][:80], expected, advice(self.needed))
        return InputError(self.name, "no header and no rows", expected, advice(self.needed))


def _columns(way: Sequence[str]) -> set[str]:
    return {read_as.column for word in way if (read_as := meaning(word, {})) is not None}
