"""Find the header of a text: the line above the first row that names the columns, a comment or not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from reference import InputError

from .layout import SKIPPED, Layout, Naming, advice, guessed, layout, unnamed
from .names import meaning
from .row_format import Spelling, words

MOST = 1000  # lines above the first row that are looked at
FEW = 2  # names of columns in a comment, and half of its words, from which on it is meant as the header


@dataclass
class Header:
    """The lines above the first row.

    Attributes:
        name: of the text, in messages.
        needed, optional: columns, as in `ColumnReader`.
        naming: what the user says of the columns.
        lines: those seen, each with its number and whether it is a comment.
    """

    name: str
    needed: Sequence[str]
    optional: Sequence[str]
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
                raise InputError(f"{self.name}: line {number}", text[:80], "a row of numbers before it", self._advice)
            del self.lines[0]

    @property
    def _advice(self) -> str:
        return advice(self.needed, self.optional)

    def layout(self, row: str, spelled: Spelling, number: int) -> tuple[Layout, int]:
        """Return which column stands where, and the number of fields in a row, from the first one and its line.

        Raises:
            InputError: no line names the columns, or one does but not all that are needed, and the first row does not
                tell either.
        """
        fields = spelled.fields(row)
        count = len(fields) - (len(fields) > 1 and not fields[-1].strip())
        if self.naming.columns:
            return self._given(count), len(fields)
        for above, text, is_comment in reversed(self.lines):
            found = self._named(text, count, is_comment)
            if found is not None:
                if len(found) != count:
                    got, expected = f"{count} fields", f"{len(found)} as in the header, line {above}"
                    raise InputError(f"{self.name}: line {number}", got, expected, "Is the line cut off?")
                return self._resolved(found, f"{self.name}: header"), len(fields)
        names = unnamed(count, self.needed)
        if names is None or (len(self.needed) == 1 and self.lines):
            raise InputError(f"{self.name}: first line", row[:80], "a header that names the columns", self._advice)
        made = self._resolved([name or "-" for name in names], self.name)
        said = () if len(self.needed) == 1 else (guessed(names),)
        return replace(made, conventions=(*said, *made.conventions)), len(fields)

    def _given(self, count: int) -> Layout:
        """Return the layout of `--columns`."""
        names = self.naming.columns
        if len(names) != count:
            expected = f"a name for each of the {count} columns, - for one that is not read"
            raise InputError("--columns", ",".join(names), expected)
        unknown = [name for name in names if name.strip() not in SKIPPED and meaning(name, {}) is None]
        if unknown:
            expected = f"names of {', '.join([*self.needed, *self.optional])}"
            raise InputError("--columns", ", ".join(unknown), expected, "Write - for a column that is not read.")
        missing = [name for name in self.needed if name not in self._columns(names)]
        if missing:
            raise InputError("--columns", ",".join(names), f"a column {missing[0]} among them")
        return self._resolved(names, "--columns")

    def _named(self, text: str, count: int, is_comment: bool) -> list[str] | None:
        """Return the words of a line that names the columns, or is meant to; None for another."""
        ways = [(way, self._columns(way)) for way in words(text)]
        fitting = [(way, named) for way, named in ways if len(way) == count]
        for way, named in fitting:
            if set(self.needed) <= named:
                return way
        for way, named in ways:  # of another number of columns
            if set(self.needed) <= named and (not is_comment or len(named) == len(way)):
                return way
        few = max(min(FEW, len(self.needed)), count // 2) if is_comment else 0
        return next((way for way, named in fitting if len(named) >= few), None)

    @staticmethod
    def _columns(way: Sequence[str]) -> set[str]:
        return {one.column for word in way if (one := meaning(word, {})) is not None}

    def _resolved(self, way: Sequence[str], where: str) -> Layout:
        return layout(way, self.needed, self.optional, self.naming.units, where)

    def refuse(self, expected: str) -> InputError:
        """Return the error for a text without rows."""
        for i, (_, text, _) in enumerate(self.lines):
            if any(set(self.needed) <= self._columns(way) for way in words(text)):
                later = [(number, line) for number, line, is_comment in self.lines[i + 1 :] if not is_comment]
                if later:
                    return InputError(f"{self.name}: line {later[0][0]}", later[0][1][:80], "a row of numbers")
                return InputError(self.name, "no rows", "at least one row", "Is the output empty?")
        first = next((line for line in self.lines if not line[2]), None)
        if first is not None:
            return InputError(f"{self.name}: line {first[0]}", first[1][:80], expected, self._advice)
        return InputError(self.name, "no header and no rows", expected, self._advice)
