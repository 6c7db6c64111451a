"""Which column stands where: the words of a header, or of `--columns`, resolved to columns with their units.

In a text the header is the line above the first row that names the columns, a comment or not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from reference import InputError
from reference.numbers.precision import Array

from .candidate import COLUMNS, Deviation
from .names import Meaning, defaults, meaning, multiplied, unquoted
from .spelling import Spelling, words

SKIPPED = ("-", "_", "")  # words for a column that is not read
FOUCPEND = 10  # columns of the paper's program: t x y z X Y Z φ λ speed
UNNAMED = {3: ("t", "x", "y"), 4: ("t", "x", "y", "z"), 7: ("t", *COLUMNS), FOUCPEND: ("t", "x", "y", "z")}
MOST = 1000  # lines above the first row that are looked at
FEW = 2  # names of columns in a comment, and half of its words, from which on it is meant as the header


@dataclass(frozen=True)
class Naming:
    """Hold the names and units that a user gives to the columns of a file.

    Attributes:
        columns: their names in order, as in a header, `-` for one that is not read; empty if the file says it.
        units: of times and lengths where the names give none, such as ms or cm.
    """

    columns: tuple[str, ...] = ()
    units: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse units that are not known."""
        defaults(self.units)


@dataclass(frozen=True)
class Layout:
    """Where each column stands.

    Attributes:
        places: index of each column that is read, in the order t, x, y, z, vx, vy, vz.
        factors: by which a column's numbers come to SI units, east, north and up; only where it is not 1.
        conventions: what is not plain about it.
    """

    places: dict[str, int]
    factors: dict[str, Fraction] = field(default_factory=dict)
    conventions: tuple[Deviation, ...] = ()

    def converted(self, columns: dict[str, Array], low: dict[str, Array]) -> tuple[dict[str, Array], dict[str, Array]]:
        """Return columns and their low parts in SI units."""
        columns, low = dict(columns), dict(low)
        for name, factor in self.factors.items():
            if name in low:
                columns[name], low[name] = multiplied(columns[name], low[name], factor)
            elif name in columns:
                columns[name] = columns[name] * float(factor.numerator) / float(factor.denominator)
        return columns, low


def layout(
    words: Sequence[str], needed: Sequence[str], optional: Sequence[str], units: tuple[str, ...], where: str
) -> Layout:
    """Resolve the words of a header.

    Args:
        words: one for each column of the file.
        needed: columns that must be among them.
        optional: columns that are read if they are there.
        units: as in `Naming`.
        where: the header's name in messages.

    Raises:
        InputError: a column is missing or there twice, or its unit is not known.
    """
    of_units = defaults(units)
    columns = [*needed, *optional]
    meanings = [meaning(word, of_units) for word in words]
    places: dict[str, int] = {}
    for name in columns:
        ranked = [(word.rank, i) for i, word in enumerate(meanings) if word is not None and word.column == name]
        best = [i for rank, i in ranked if rank == min(ranked)[0]]
        if len(best) > 1:
            same = ", ".join(words[i].strip() for i in best)
            raise InputError(where, same, f"one column {name}", "Say with --columns which one it is.")
        if best:
            places[name] = best[0]
        elif name in needed:
            got = f"no {name} in {', '.join(word.strip() for word in words)[:80]}"
            raise InputError(where, got, f"one column {name}", advice(needed, optional))
    chosen = {name: word for name, i in places.items() if (word := meanings[i]) is not None}
    for name, read_as in chosen.items():
        if read_as.factor is None:
            field = f"{where}: {words[places[name]].strip()}"
            raise InputError(field, read_as.unit, f"a unit of {name} that is known", "Write s, m or m/s.")
    factors = {name: word.factor for name, word in chosen.items() if word.factor is not None and word.factor != 1}
    return Layout(places, factors, tuple(_conventions(words, places, chosen)))


def unnamed(count: int, needed: Sequence[str]) -> tuple[str, ...] | None:
    """Return the names of the columns of a file without a header, by their number; None if it does not tell them."""
    if count == len(needed) == 1:
        return tuple(needed)
    names = UNNAMED.get(count)
    return None if names is None or len(needed) == 1 else (*names, *[""] * (count - len(names)))


def guessed(names: Sequence[str]) -> Deviation:
    """Return what is said where names were taken from the number of columns."""
    read = ", ".join(name for name in names if name)
    return Deviation("no_header", f"no header: the columns are taken as {read} (--columns names others)")


def advice(needed: Sequence[str], optional: Sequence[str]) -> str:
    """Return what a header has to name."""
    more = f" and, if there, {', '.join(optional)}" if optional else ""
    return f"The first line names the columns: {', '.join(needed)}{more}; or --columns does."


def _conventions(words: Sequence[str], places: dict[str, int], chosen: dict[str, Meaning]) -> list[Deviation]:
    said = []
    renamed = [
        f"{unquoted(words[i])} as {_signed(chosen[name])}" for name, i in places.items() if chosen[name].rank == 2
    ]
    if renamed:
        others = [unquoted(word) for i, word in enumerate(words) if i not in places.values()]
        others = [word for word in others if word not in SKIPPED]
        unread = f"; not read: {', '.join(others)}" if others else ""
        said.append(Deviation("columns", f"{', '.join(renamed)}{unread}"))
    units = [f"{name} from {word.unit}" for name, word in chosen.items() if abs(word.factor or 1) != 1]
    if units:
        said.append(Deviation("units", f"{', '.join(units)}, converted to SI units"))
    return said


def _signed(word: Meaning) -> str:
    return f"-{word.column}" if word.factor is not None and word.factor < 0 else word.column


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
            header = self._named(text, count, is_comment)
            if header is not None:
                if len(header) != count:
                    got, expected = f"{count} fields", f"{len(header)} as in the header, line {above}"
                    raise InputError(f"{self.name}: line {number}", got, expected, "Is the line cut off?")
                return self._resolved(header, f"{self.name}: header"), len(fields)
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
        return {read_as.column for word in way if (read_as := meaning(word, {})) is not None}

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
