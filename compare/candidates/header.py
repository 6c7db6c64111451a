"""The lines above the first row: the header, which names the columns, and a line of units below or above it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from reference import InputError

from .names import Layout, Naming, advice, by_number, given, layout, meaning, units_of
from .text import SEPARATORS, says_nothing, split, without_end, words

MOST = 1000  # lines above the first row that are looked at
# names of columns in a comment, and half of its words, from which on it is meant as the header
FEW = 2
# of a line that holds them
UNITS_LABEL = re.compile(r"(?:units?|einheit(?:en)?)\s*[:=]?[\s,;]+", re.IGNORECASE)
SI_UNITS = ("", "s", "m", "m/s")
COMMAS = "Numbers with a decimal comma cannot be told apart between commas: separate the columns by semicolons."


class HeaderLine(NamedTuple):
    """A line above the first row."""

    number: int
    text: str
    comment: bool


@dataclass
class Header:
    """The lines above the first row; the header is the last of them that names the columns, a comment or not.

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
        most = len(split(row, separator))
        least = len(without_end(split(row, separator)))
        ways = [
            without_end(split(line.text, separator))
            for line in self.lines
            if separator in line.text
        ]
        return any(least <= len(way) <= most and set(self.needed) <= _columns(way) for way in ways)

    def add(self, number: int, text: str, comment: bool) -> None:
        """Take a line that is no row.

        Raises:
            InputError: there are too many before the first row.
        """
        if says_nothing(text):
            return
        self.lines.append(HeaderLine(number, text, comment))
        if len(self.lines) > MOST:
            if not comment:
                where, expected = f"{self.name}: line {number}", "a row of numbers before it"
                raise InputError(where, text[:80], expected, advice(self.needed))
            del self.lines[0]

    def layout(self, row: str, separator: str, number: int) -> tuple[Layout, int]:
        """Return which column stands where, and how many columns there are, from the first row and its line.

        Raises:
            InputError: no line names the columns, or one does but not all that are needed, and the first row does not
                tell either.
        """
        fields = split(row, separator)
        least = len(without_end(fields))
        if self.naming.columns:
            count = len(self.naming.columns)
            fits = least <= count <= len(fields)
            return given(count if fits else least, self.naming), count
        found = self._header(least, len(fields))
        if found is not None:
            i, header = found
            if not least <= len(header) <= len(fields):
                raise self._unequal(number, least, self.lines[i], len(header), separator)
            if not set(self.needed) <= _columns(header):
                self._refuse_line_below_header(i, header)
            units = self._units_beside(i, len(header))
            return layout(header, self.needed, self.naming, f"{self.name}: header", units), len(
                header
            )
        made = by_number(least, self.needed, self.naming)
        if made is None or (len(self.needed) == 1 and self.lines):
            expected = "a header that names the columns"
            raise InputError(f"{self.name}: first line", row[:80], expected, advice(self.needed))
        self._refuse_other_comment([*made.places], least, number)
        return made, least

    def _refuse_other_comment(self, columns: Sequence[str], count: int, number: int) -> None:
        """Refuse a comment that names columns, but not as many as there are, or in another order or unit than taken."""
        for line in self.lines:
            for way in words(line.text):
                meanings = [
                    meant for meant in (meaning(word, {}) for word in way) if meant is not None
                ]
                named = [meant.column for meant in meanings]
                if not set(self.needed) <= {*named} or 2 * len(named) < len(way):
                    continue
                separated = any(
                    without_end(split(line.text, mark)) == way
                    for mark in SEPARATORS
                    if mark in line.text and mark
                )
                taken = meanings[: len(columns)]
                same = [meant.column for meant in taken] == [*columns] and all(
                    meant.factor == 1 for meant in taken
                )
                # as "columns: t x y …", with further columns behind
                labelled = way[0].endswith(":")
                same = same and (len(named) == len(columns) or (labelled and len(way) == count + 1))
                if separated or not same:
                    raise self._unequal(number, count, line, len(way), "")

    def _header(self, least: int, most: int) -> tuple[int, list[str]] | None:
        """Return the place and the words of the last line that names the columns, or is meant to; None if none does.

        It is no line of units that stands below a header.

        Args:
            least: the number of fields of the first row, empty ones at its end left out.
            most: the number with them.
        """
        lengths = [{len(way) for way in self._ways(line)} for line in self.lines]
        headers = {i: counts for i in range(len(self.lines)) if (counts := self._complete(i))}
        first = min(headers, default=len(self.lines))
        for i in reversed(range(len(self.lines))):
            fitting = sorted(count for count in lengths[i] | {least} if least <= count <= most)
            if i > first and any(
                self._units(i, count) is not None for count in fitting if count in headers[first]
            ):
                continue
            for count in reversed(fitting):
                if count in headers.get(i, ()):
                    header = self._named(self.lines[i], count)
                    assert header is not None
                    return i, header
            header = self._named(self.lines[i], least)
            if header is not None:
                return i, header
        return None

    def _refuse_line_below_header(self, i: int, words_of_line: Sequence[str]) -> None:
        """Refuse a line that names nothing, below a header that is no comment: it may hold units that nobody knows."""
        for line in self.lines[:i]:
            ways = [way for way in words(line.text) if len(way) == len(words_of_line)]
            if not line.comment and any(set(self.needed) <= _columns(way) for way in ways):
                where, got = (
                    f"{self.name}: line {self.lines[i].number}",
                    ", ".join(words_of_line)[:80],
                )
                expected = f"units below the header of line {line.number}, or a row of numbers"
                raise InputError(
                    where,
                    got,
                    expected,
                    "Units are s, ms, min, h, m, cm, mm, m/s … Write # before a remark.",
                )

    def _unequal(
        self, number: int, count: int, line: HeaderLine, named: int, separator: str
    ) -> InputError:
        """Return the error for a first row with another number of fields than the header."""
        expected = f"{named} as in the header, line {line.number}"
        what_to_do = (
            "Is the line cut off?" if count < named else "Name each column, or say --columns."
        )
        if separator == "," and named < count < 2 * named + 1:
            what_to_do = f"{what_to_do} {COMMAS}"
        return InputError(f"{self.name}: line {number}", f"{count} fields", expected, what_to_do)

    def _named(self, line: HeaderLine, count: int) -> list[str] | None:
        """Return the words of a line that names the columns, or is meant to; None for another."""
        ways = [(way, _columns(way)) for way in self._ways(line)]
        fitting = [(way, named) for way, named in ways if len(way) == count]
        for way, named in fitting:
            if set(self.needed) <= named:
                return way
        for way, named in ways:  # of another number of columns
            if set(self.needed) <= named and (not line.comment or len(named) == len(way)):
                return way
        enough = max(min(FEW, len(self.needed)), count // 2) if line.comment else 0
        return next((way for way, named in fitting if len(named) >= enough), None)

    def _complete(self, i: int) -> set[int]:
        """Return into how many words a line can be taken apart so that they name all columns that are needed."""
        return {len(way) for way in self._ways(self.lines[i]) if set(self.needed) <= _columns(way)}

    def _ways(self, line: HeaderLine) -> list[list[str]]:
        """Return the ways to take a line apart; where one names all columns that are needed, no less likely one."""
        ways = words(line.text)
        separators = [separator for separator in SEPARATORS if separator and separator in line.text]
        explicit = ways[: len(separators)]
        for likely in (explicit, *([way] for way in ways[len(separators) :])):
            if any(set(self.needed) <= _columns(way) for way in likely):
                return likely
        return ways

    def _units(self, i: int, count: int) -> list[str] | None:
        """Return the units in a line that holds nothing else, one for each column; None for another line."""
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
        beside = [self._units(k, count) for k in range(len(self.lines)) if k > i or k == i - 1]
        found = [units for units in beside if units is not None]
        for units in found[1:]:
            if units != found[0]:
                where, got = (
                    f"{self.name}: lines of units",
                    f"{', '.join(found[0])} and {', '.join(units)}",
                )
                raise InputError(where, got, "one of them", "Leave one out.")
        if not found and not self.naming.units:
            self._refuse_loose_units()
        return found[0] if found else []

    def _refuse_loose_units(self) -> None:
        """Refuse a line that says units but not of which column, unless it says SI units anyway."""
        for line in self.lines:
            label = UNITS_LABEL.match(line.text)
            rest = line.text[label.end() :] if label else line.text
            found = re.split(r"[\s,;|]+", rest.strip(" \t,;|"))
            units = units_of(found) if label or not line.comment or len(found) > 1 else None
            if units and not {*units} <= {*SI_UNITS}:
                where, expected = f"{self.name}: line {line.number}", "a unit for each column"
                raise InputError(
                    where,
                    line.text[:80],
                    expected,
                    "Write units into the header, or say --units ms,cm.",
                )

    def refuse(self, expected: str) -> InputError:
        """Return the error for a text without rows."""
        for i, line in enumerate(self.lines):
            if any(set(self.needed) <= _columns(way) for way in words(line.text)):
                later = [below for below in self.lines[i + 1 :] if not below.comment]
                if later:
                    return InputError(
                        f"{self.name}: line {later[0].number}",
                        later[0].text[:80],
                        "a row of numbers",
                    )
                why = "All lines are comments." if self.lines[i + 1 :] else "Is the output empty?"
                return InputError(self.name, "no rows", "at least one row", why)
        first = next((line for line in self.lines if not line.comment), None)
        if first is not None:
            return InputError(
                f"{self.name}: line {first.number}", first.text[:80], expected, advice(self.needed)
            )
        return InputError(self.name, "no header and no rows", expected, advice(self.needed))


def _columns(way: Sequence[str]) -> set[str]:
    meanings = [meaning(word, {}) for word in way]
    return {meant.column for meant in meanings if meant is not None}
