"""The lines above the first row: the header, which names the columns, and a line of units below or above it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from reference import InputError
from reference.errors import Described, counted

from .candidate import NO_ROWS
from .names import Layout, Naming, advice, by_number, given, layout, meaning, units_of
from .text import SEPARATORS, says_nothing, split, without_end, without_label, words

MOST = 1000  # lines above the first row that are looked at
# names of columns in a comment, and half of its words, from which on it is meant as the header
FEW = 2
# of a line that holds them
UNITS_LABEL = re.compile(r"(?:units?|einheit(?:en)?)\s*[:=]?[\s,;]+", re.IGNORECASE)
SI_UNITS = ("", "s", "m", "m/s")
COMMAS = "If the numbers have decimal commas, separate the columns by semicolons."


class HeaderLine(NamedTuple):
    """A line above the first row."""

    number: int
    text: str
    comment: bool


@dataclass
class Header:
    """The lines above the first row.

    The header is the last of them that names the columns, a comment or not.

    Attributes:
        name: of the text, in messages.
        needed: columns that must be there, as in `layout`.
        naming: what the user says of the columns.
        lines: those seen.
    """

    name: str
    needed: Sequence[str]
    naming: Naming
    lines: list[HeaderLine] = field(default_factory=list)

    @property
    def decides(self) -> bool:
        """True if a line or the user says how many columns there are."""
        return bool(self.naming.columns or self.lines)

    def uses(self, separator: str, row: str) -> bool:
        """Return whether a line names the columns between separators other than white space, as many as in a row."""
        if not separator or separator not in row:
            return False
        fields = split(row, separator)
        least = len(without_end(fields))
        for line in self.lines:
            if separator not in line.text:
                continue
            way = without_end(split(line.text, separator))
            if least <= len(way) <= len(fields) and self._is_complete(way):
                return True
        return False

    def add(self, number: int, text: str, comment: bool) -> None:
        """Add a line that is not a row.

        Raises:
            InputError: there are too many before the first row.
        """
        if says_nothing(text):
            return
        self.lines.append(HeaderLine(number, text, comment))
        if len(self.lines) > MOST:
            if not comment:
                where = f"{self.name}: line {number}"
                expected = "a row of numbers on an earlier line"
                raise InputError(where, text[:80], expected, advice(self.needed))
            del self.lines[0]

    def layout(self, row: str, separator: str, number: int) -> tuple[Layout, int]:
        """Return the layout of the columns and their number, from the first row and its line number.

        Raises:
            InputError: no line names the columns, or one does but not all that are needed, and the
                first row does not tell either.
        """
        fields = split(row, separator)
        least = len(without_end(fields))
        if self.naming.columns:
            count = len(self.naming.columns)
            fits = least <= count <= len(fields)
            return given(count if fits else least, self.naming), count
        place = self._header(least, len(fields))
        if place is not None:
            i, header = place
            header = without_label(header)
            if not least <= len(header) <= len(fields):
                raise self._unequal(number, least, self.lines[i], len(header), separator)
            if not self._is_complete(header):
                self._refuse_line_below_header(i, header)
            units = self._units_beside(i, len(header))
            by_header = layout(header, self.needed, self.naming, f"{self.name}: header", units)
            return by_header, len(header)

        without_header = by_number(least, self.needed, self.naming)
        if without_header is None or (len(self.needed) == 1 and self.lines):
            expected = "a header that names the columns"
            raise InputError(f"{self.name}: first line", row[:80], expected, advice(self.needed))
        self._refuse_other_comment([*without_header.places], least, number)
        return without_header, least

    def _refuse_other_comment(self, columns: Sequence[str], count: int, number: int) -> None:
        """Refuse a comment that names columns, but not as many as there are, or in another order or unit than taken."""
        for line in self.lines:
            for way in words(line.text):
                names = without_label(way)
                meanings = [meant for word in names if (meant := meaning(word, {})) is not None]
                named = [meant.column for meant in meanings]
                if not set(self.needed) <= set(named) or 2 * len(named) < len(names):
                    continue
                is_separated = any(
                    mark and mark in line.text and without_end(split(line.text, mark)) == way
                    for mark in SEPARATORS
                )
                # as "columns: t x y …", with further columns behind
                is_labelled = len(names) < len(way) and len(names) == count
                has_all = len(named) == len(columns) or is_labelled
                taken = meanings[: len(columns)]
                is_same = (
                    has_all
                    and [meant.column for meant in taken] == [*columns]
                    and all(meant.factor == 1 for meant in taken)
                )
                if is_separated or not is_same:
                    raise self._unequal(number, count, line, len(names), "")

    def _header(self, least: int, most: int) -> tuple[int, list[str]] | None:
        """Return the place and the words of the last line that names the columns, or is meant to.

        None if none does.

        It is no line of units that stands below a header.

        Args:
            least: the number of fields of the first row, empty ones at its end left out.
            most: the number with them.
        """
        complete = [self._complete(line) for line in self.lines]
        first = next((i for i, counts in enumerate(complete) if counts), len(self.lines))
        for i in reversed(range(len(self.lines))):
            line = self.lines[i]
            counts = {len(way) for way in self._ways(line)} | {least}
            fitting = sorted((count for count in counts if least <= count <= most), reverse=True)
            if i > first and any(
                count in complete[first] and self._units(i, count) is not None for count in fitting
            ):
                continue
            for count in fitting:
                if count in complete[i]:
                    header = self._named(line, count)
                    assert header is not None
                    return i, header
            header = self._named(line, least)
            if header is not None:
                return i, header
        return None

    def _refuse_line_below_header(self, i: int, words_of_line: Sequence[str]) -> None:
        """Refuse a line that names nothing, below a header that is no comment: it may hold units that nobody knows."""
        for line in self.lines[:i]:
            ways = [way for way in words(line.text) if len(way) == len(words_of_line)]
            if not line.comment and any(map(self._is_complete, ways)):
                where = f"{self.name}: line {self.lines[i].number}"
                got = ", ".join(words_of_line)[:80]
                expected = f"units below the header of line {line.number}, or a row of numbers"
                what_to_do = "Units are s, ms, min, h, m, cm, mm, m/s … Begin a comment with #."
                raise InputError(where, got, expected, what_to_do)

    def _unequal(
        self, number: int, count: int, line: HeaderLine, named: int, separator: str
    ) -> InputError:
        """Return the error for a first row with another number of fields than the header."""
        expected = f"{named}, as in the header on line {line.number}"
        what_to_do = "Name every column in the header or by --columns."
        if count < named:
            what_to_do = "Is the line cut off?"
        if separator == "," and named < count < 2 * named + 1:
            what_to_do = f"{what_to_do} {COMMAS}"
        got = Described(counted(count, "field"))
        return InputError(f"{self.name}: line {number}", got, expected, what_to_do)

    def _named(self, line: HeaderLine, count: int) -> list[str] | None:
        """Return the words of a line that names the columns, or is meant to; None for another."""
        ways = self._ways(line)
        fitting = [way for way in ways if len(way) == count]
        for way in fitting:
            if self._is_complete(way):
                return way
        for way in ways:  # of another number of columns
            if self._is_complete(way) and (not line.comment or len(_columns(way)) == len(way)):
                return way
        enough = max(min(FEW, len(self.needed)), count // 2) if line.comment else 0
        for way in fitting:
            if len(_columns(way)) >= enough:
                return way
        return None

    def _is_complete(self, way: Sequence[str]) -> bool:
        """Return whether words name all columns that are needed."""
        return set(self.needed) <= _columns(way)

    def _complete(self, line: HeaderLine) -> set[int]:
        """Return into how many words a line can be taken apart so that they name all columns that are needed."""
        return {len(way) for way in self._ways(line) if self._is_complete(way)}

    def _ways(self, line: HeaderLine) -> list[list[str]]:
        """Return the ways to take a line apart.

        Where one names all columns that are needed, no less likely one.
        """
        ways = words(line.text)
        separators = [separator for separator in SEPARATORS if separator and separator in line.text]
        explicit = ways[: len(separators)]
        if any(map(self._is_complete, explicit)):
            return explicit
        for way in ways[len(separators) :]:
            if self._is_complete(way):
                return [way]
        return ways

    def _units(self, i: int, count: int) -> list[str] | None:
        """Return the units in a line that holds nothing else, one for each column.

        None for another line.
        """
        text = UNITS_LABEL.sub("", self.lines[i].text, count=1)
        for separator in SEPARATORS:
            fields = split(text, separator)
            if len(fields) >= count and not any(fields[count:]):
                units = units_of(fields[:count])
                if units is not None:
                    return units
        return None

    def _units_beside(self, i: int, count: int) -> list[str]:
        """Return the units in the line below the header in line `i`, or in that above it; none if neither has any.

        Raises:
            InputError: both have some, and they differ.
        """
        beside = [k for k in range(len(self.lines)) if k > i or k == i - 1]
        lines = [units for k in beside if (units := self._units(k, count)) is not None]
        if not lines:
            if not self.naming.units:
                self._refuse_loose_units()
            return []
        first = lines[0]
        for units in lines[1:]:
            if units != first:
                got = Described(f"both {', '.join(first)} and {', '.join(units)}")
                raise InputError(
                    f"{self.name}: lines of units", got, "one line of units", "Leave one out."
                )
        return first

    def _refuse_loose_units(self) -> None:
        """Refuse a line that says units but not of which column, unless it says SI units anyway."""
        for line in self.lines:
            label = UNITS_LABEL.match(line.text)
            text = line.text[label.end() :] if label else line.text
            fields = re.split(r"[\s,;|]+", text.strip(" \t,;|"))
            if line.comment and not label and len(fields) == 1:
                continue
            units = units_of(fields)
            if units and not set(units) <= set(SI_UNITS):
                where = f"{self.name}: line {line.number}"
                what_to_do = "Write the units into the header, or give them by --units ms,cm."
                raise InputError(where, line.text[:80], "a unit for each column", what_to_do)

    def refuse(self, expected: str) -> InputError:
        """Return the error for a text without rows."""
        for i, line in enumerate(self.lines):
            if any(map(self._is_complete, words(line.text))):
                return self._no_row_below(self.lines[i + 1 :])
        for line in self.lines:
            if not line.comment:
                where = f"{self.name}: line {line.number}"
                return InputError(where, line.text[:80], expected, advice(self.needed))
        got = Described("no header and no rows")
        return InputError(self.name, got, expected, advice(self.needed))

    def _no_row_below(self, lines: Sequence[HeaderLine]) -> InputError:
        """Return the error for a header below which no line is a row."""
        for line in lines:
            if not line.comment:
                where = f"{self.name}: line {line.number}"
                return InputError(where, line.text[:80], "a row of numbers")
        why = "All lines are comments." if lines else "Is the output empty?"
        return InputError(self.name, NO_ROWS, "at least one row", why)


def _columns(way: Sequence[str]) -> set[str]:
    """Return the columns that words name."""
    meanings = [meaning(word, {}) for word in way]
    return {meant.column for meant in meanings if meant is not None}
