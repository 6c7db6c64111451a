"""The order of columns: the words of a header or of `--columns`, as programs use them; units in SI.

`pos_x`, `X (cm)`, `east`, `x/m` and `position x` are x; `time [ms]`, `t_s` and `seconds` are t;
`vx`, `xdot`, `dx/dt` and `v_x` are vx; `west`, `south` and `down` are x, y and z with the other
sign. A name may have a direction and a unit behind it, in any order: `x_east_m`, `x_m_east`,
`pos_x_m`.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from reference import InputError
from reference.errors import Described
from reference.numbers.precision import Array
from reference.system.documents import texts_of

from .candidate import COLUMNS, Deviation, multiplied

vocabulary = texts_of(__file__)
DIRECTIONS: dict[str, tuple[str, int]] = {
    word: (axis, sign) for word, (axis, sign) in vocabulary["directions"].items()
}
AXES = {"x": ("x", 1), "y": ("y", 1), "z": ("z", 1)} | DIRECTIONS
_AXIS = "|".join(sorted(AXES, key=len, reverse=True))
_PLACE = "position|pos|coordinate|coord|displacement|disp|location|loc"
_SPEED = "velocity|vel|speed"
POSITION = re.compile(rf"(?:{_PLACE}|bob|r)?([xyz])?({_AXIS})(?:{_PLACE}|axis)?")
VELOCITY = re.compile(
    rf"(?:{_SPEED}|v)([xyz])?({_AXIS})|([xyz])?({_AXIS})(?:{_SPEED}|dot|prime)|d()({_AXIS})dt"
)
TIME_WORDS: set[str] = set(vocabulary["time_words"])
# a column that is called so
TIME_UNITS = re.compile(r"sec|secs|seconds?|ms|msec|milliseconds?|minutes?|hours?|days?")
# characters of a word; the patterns' time grows with the square, and a line may have 64 KiB
LONGEST = 100
BRACKETS = re.compile(r"(.*?)\s*[(\[{<]\s*([^(\[{<]*?)\s*[)\]}>]")
# one piece or two
AFTER = re.compile(r"(.*?)(?:\s*/\s*|[\s_]in[\s_]|[\s_.]+)([^\s_/.]+(?:(?:/|_per_|_)[^\s_/]+)?)")
LAST = re.compile(r"(.*)[\s_.]+([^\s_.]+)")
LABEL = re.compile(
    r"(?:(?:latest|run\s*#?\d+|data\s*set(?:\s*\d+)?)\s*:\s*)?(.*?)(?:[\s,]+run\s*#?\d+)?",
    re.IGNORECASE,
)
TIMES: dict[str, Fraction] = {
    unit: Fraction(size) for unit, size in vocabulary["times"].items()
}  # in s
LENGTHS: dict[str, Fraction] = {
    unit: Fraction(size) for unit, size in vocabulary["lengths"].items()
}  # in m
LONG_NAMES: dict[str, str] = vocabulary["long_names"]
OTHER_WORDS: dict[str, str] = vocabulary["other_words"]
OTHER_UNITS: set[str] = set(vocabulary["other_units"])  # of columns that are not read
TYPES: set[str] = set(vocabulary["types"])  # words that a line of types below the header may hold
PER = re.compile(
    r"(\w+?)\s*(?:/|_per_|\s+per\s+|_)\s*(\w+)|(\w+)\s*[·*⋅ ]?\s*(\w+?)\s*(?:\^?\s*[-−]1|⁻¹)"
)
SHORT_SPEEDS: dict[str, str] = vocabulary["short_speeds"]
# columns of a trajectory, of which those of z and of velocities may be missing
NEEDED = ("t", "x", "y")
SKIPPED = ("-", "_", "")  # words for a column that is not read
# by their number; the paper's program foucPend prints ten: t x y z X Y Z φ λ speed
UNNAMED = {
    3: ("t", "x", "y"),
    4: ("t", "x", "y", "z"),
    7: ("t", *COLUMNS),
    10: ("t", "x", "y", "z"),
}


@dataclass(frozen=True)
class Meaning:
    """The column that a word of a header stands for, and its unit.

    Attributes:
        column: t, x, y, z, vx, vy or vz.
        factor: by which its numbers come to SI units and to the column's direction; None if the
            unit is not known.
        unit: as printed; empty if there is none.
        rank: 0 for the column's own name, 1 for it in capitals, 2 for another word.
    """

    column: str
    factor: Fraction | None
    unit: str
    rank: int


def meaning(word: str, units: dict[str, str]) -> Meaning | None:
    """Return the column and unit that a word of a header stands for; None for a column that is not read.

    Args:
        word: as printed.
        units: units that hold where the word names none, by column.

    Raises:
        InputError: its unit contradicts `units`.
    """
    text = _unquoted(word)
    # what ends with a separator is a part of a line
    if len(text) > LONGEST or text[-1:] in (",", ";", "|"):
        return None
    label = LABEL.fullmatch(text)
    text = label[1] if label else text
    for name, suffix, direction in _parts(text):
        named = _column(name)
        if named is None:
            continue
        column, sign, rank = named
        if suffix == text:
            rank = 2  # it is called by its unit
        if direction:
            if column == "t":
                continue
            axis, sign = DIRECTIONS[direction.lower()]
            column = f"{column[:-1]}{axis}"
            rank = 2
        is_function_of_time = suffix.lower() in ("t", "time") and column != "t"
        unit = "" if is_function_of_time else suffix
        default = units.get(column, "")
        size = size_of(unit or default, column) if unit or default else Fraction(1)
        if size is None:
            if BRACKETS.fullmatch(text):
                return Meaning(column, None, unit, rank)
            continue  # it may be no unit
        if unit and default and size not in (1, size_of(default, column)):
            expected = f"{unit}, the unit of {column} in the header, or no unit"
            raise InputError("--units", default, expected)
        return Meaning(column, size * sign, unit or default, rank)
    return None


def _unquoted(word: str) -> str:
    """Return a word without white space around it and without a pair of quotes."""
    text = word.strip()
    is_quoted = len(text) > 1 and text[0] == text[-1] and text[0] in "\"'`"
    return text[1:-1].strip() if is_quoted else text


def _parts(text: str) -> list[tuple[str, str, str]]:
    """Return the ways to take a word apart into a name, a unit and a direction, the most likely first."""
    ways = []
    for name, last in _with_unit(text):
        if last.lower() in DIRECTIONS:
            ways += [(before, unit, last) for before, unit in _with_unit(name)]
    return ways + [(name, unit, "") for name, unit in _with_unit(text)]


def _with_unit(text: str) -> list[tuple[str, str]]:
    """Return the ways to take a text apart into a name and a unit, which may be empty."""
    if brackets := BRACKETS.fullmatch(text):
        return [(brackets[1], brackets[2])]
    ways = [(text, "")]
    if TIME_UNITS.fullmatch(text.lower()):
        ways.append(("t", text))
    if after := AFTER.fullmatch(text):
        ways.append((after[1], after[2]))
    return ways + _last_apart(text)


def _last_apart(text: str) -> list[tuple[str, str]]:
    """Return a text without its last piece, and this piece."""
    last = LAST.fullmatch(text)
    return [(last[1], last[2])] if last else []


def _column(name: str) -> tuple[str, int, int] | None:
    """Return the column, sign and rank of a name without a unit."""
    if name.lower() in ("t", *COLUMNS):
        return name.lower(), 1, int(name != name.lower())
    plain = unicodedata.normalize("NFD", name.lower()).replace("\u0307", "dot")
    plain = re.sub(r"['’′]$", "prime", plain)
    plain = "".join(letter for letter in plain if letter.isalnum())
    if plain in TIME_WORDS:
        return "t", 1, 2
    for pattern, speed in ((POSITION, ""), (VELOCITY, "v")):
        if match := pattern.fullmatch(plain):
            *before, word = filter(None, match.groups())
            if not before or word in DIRECTIONS:
                axis, sign = AXES[word]
                return f"{speed}{axis}", sign, 2
    return None


def _plain_unit(word: str) -> str:
    """Return the usual word for a unit of time or length: `s` for seconds.

    Other words come back in lower case.
    """
    word = word.strip().lower().replace("µ", "u").replace("μ", "u").strip(".")
    return OTHER_WORDS.get(word, word)


def size_of(unit: str, column: str) -> Fraction | None:
    """Return the size in SI units of a unit of time (of t), length (of x, y, z) or speed.

    None for any other unit.

    In the column of a speed, `ms` means m/s.
    """
    if column == "t":
        return TIMES.get(_plain_unit(unit))
    if column in ("x", "y", "z"):
        return LENGTHS.get(_plain_unit(unit))
    word = unit.strip().lower()
    word = "m/s" if word == "ms" else SHORT_SPEEDS.get(word, word)
    parts = PER.fullmatch(word)
    if parts is None:
        return None
    length = LENGTHS.get(_plain_unit(parts[1] or parts[3]))
    time = TIMES.get(_plain_unit(parts[2] or parts[4]))
    return None if length is None or time is None else length / time


def defaults(words: tuple[str, ...]) -> dict[str, str]:
    """Return the unit of each column from the words of `--units`, such as ms and cm.

    A speed is a length per second.

    Raises:
        InputError: a word is no unit of time or length, or there are two of one kind.
    """
    units: dict[str, str] = {}
    for word in words:
        unit = _plain_unit(word)
        if unit not in TIMES and unit not in LENGTHS:
            expected = f"units of time or length: {', '.join([*TIMES, *LENGTHS])}"
            raise InputError("--units", word, expected, "Separate the two by a comma.")
        if ("t" if unit in TIMES else "x") in units:
            expected = "at most one unit of time and one of length"
            raise InputError("--units", ",".join(words), expected)
        if unit in TIMES:
            units["t"] = unit
        else:
            units |= dict.fromkeys(COLUMNS[:3], unit) | dict.fromkeys(COLUMNS[3:], f"{unit}/s")
    return units


@dataclass(frozen=True)
class Naming:
    """The names and units that a user gives for the columns of a file.

    Attributes:
        columns: their names in order, as in a header, `-` for one that is not read; empty if the
            file says it.
        units: of times and lengths where the names give none, such as ms or cm.
    """

    columns: tuple[str, ...] = ()
    units: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse units that are not known."""
        defaults(self.units)


@dataclass(frozen=True)
class Layout:
    """The position of each column.

    Attributes:
        places: index of each column that is read, in the order t, x, y, z, vx, vy, vz.
        factors: by which a column's numbers come to SI units, east, north and up; only where it is
            not 1.
        conventions: what is not plain about it.
    """

    places: dict[str, int]
    factors: dict[str, Fraction]
    conventions: tuple[Deviation, ...]

    def converted(
        self, columns: dict[str, Array], low: dict[str, Array]
    ) -> tuple[dict[str, Array], dict[str, Array]]:
        """Return columns and their low parts in SI units."""
        columns = dict(columns)
        low = dict(low)
        for name, factor in self.factors.items():
            if name in low:
                columns[name], low[name] = multiplied(columns[name], low[name], factor)
            else:
                columns[name] = columns[name] * float(factor.numerator) / float(factor.denominator)
        return columns, low


def layout(
    words: Sequence[str],
    needed: Sequence[str],
    naming: Naming,
    where: str,
    units: Sequence[str] = (),
) -> Layout:
    """Resolve the words of a header.

    Args:
        words: one for each column of the file.
        needed: columns that must be among them: `NEEDED`, beside which others are read, or t alone.
        naming: what the user says of the columns, of which the units count here.
        where: the header's name in messages.
        units: those of a line below or above the header, one for each column, empty for a column
            without a unit.

    Raises:
        InputError: a column is missing or there twice, or its unit is not known.
    """
    default_units = defaults(naming.units)
    meanings = [meaning(word, default_units) for word in words]
    if units:
        meanings = [
            _with_line_of_units(meant, word, unit, default_units, where)
            for meant, word, unit in zip(meanings, words, units, strict=True)
        ]
    places: dict[str, int] = {}
    factors: dict[str, Fraction] = {}
    renamed = []
    converted = []
    for name in ("t", *COLUMNS) if len(needed) > 1 else needed:
        place = _place_of(name, meanings, words, needed, where)
        if place is None:
            continue
        meant = meanings[place]
        assert meant is not None
        word = words[place]
        if meant.factor is None:
            expected = f"a known unit of {name}"
            raise InputError(f"{where}: {word.strip()}", meant.unit, expected, "Write s, m or m/s.")
        places[name] = place
        if meant.factor != 1:
            factors[name] = meant.factor
        if meant.rank == 2:
            renamed.append(f"{_unquoted(word)} as {'-' if meant.factor < 0 else ''}{name}")
        if abs(meant.factor) != 1:
            converted.append(f"{name} from {meant.unit}")

    conventions = []
    if renamed:
        unread = [_unquoted(word) for i, word in enumerate(words) if i not in places.values()]
        unread = [word for word in unread if word not in SKIPPED]
        remark = f"; not read: {', '.join(unread)}" if unread else ""
        conventions.append(Deviation("columns", f"{', '.join(renamed)}{remark}"))
    if converted:
        text = f"{', '.join(converted)}, converted to SI units"
        conventions.append(Deviation("units", text))
    return Layout(places, factors, tuple(conventions))


def _place_of(
    name: str,
    meanings: Sequence[Meaning | None],
    words: Sequence[str],
    needed: Sequence[str],
    where: str,
) -> int | None:
    """Return the index of the word that names a column; None if an optional column has no word.

    Raises:
        InputError: two words mean it equally well, or it is missing.
    """
    ranks = {i: meant.rank for i, meant in enumerate(meanings) if meant and meant.column == name}
    best = [i for i, rank in ranks.items() if rank == min(ranks.values())]
    if len(best) > 1:
        same = ", ".join(words[i].strip() for i in best)
        raise InputError(where, same, f"one column {name}", "Say which one by --columns.")
    if not best and name in needed:
        got = Described(f"no {name} in {', '.join(word.strip() for word in words)[:80]}")
        what_to_do = "" if where == "--columns" else advice(needed)
        raise InputError(where, got, f"one column {name}", what_to_do)
    return best[0] if best else None


def _with_line_of_units(
    meant: Meaning | None, word: str, printed: str, of_units: dict[str, str], where: str
) -> Meaning | None:
    """Return what a word means if a line of units names a unit for it.

    Raises:
        InputError: the header or --units says another one.
    """
    unit = _bare_unit(printed)
    if meant is None or not unit:
        return meant
    by_header = meaning(word, {})
    assert by_header is not None
    size = size_of(unit, meant.column)
    if size is None:
        return replace(meant, factor=None, unit=unit)

    if by_header.unit and by_header.factor is not None and abs(by_header.factor) != size:
        expected = f"{by_header.unit}, the unit in the header"
        raise InputError(f"{where}: {word.strip()}", unit, expected, "Leave one of them out.")
    default = of_units.get(meant.column)
    if default and size != size_of(default, meant.column):
        expected = f"{unit}, the unit of {meant.column} in the line of units, or no unit"
        raise InputError("--units", default, expected)
    sign = 1 if meant.factor is None or meant.factor > 0 else -1
    return replace(meant, factor=size * sign, unit=unit)


def _bare_unit(printed: str) -> str:
    """Return a unit without brackets and quotes; nothing for a word that stands for none."""
    text = _unquoted(printed)
    if len(text) > 1 and text[0] in "([{<" and text[-1] in ")]}>":
        text = text[1:-1].strip()
    return "" if text in SKIPPED or text.lower() in TYPES else text


def units_of(words: Sequence[str]) -> list[str] | None:
    """Return the units of a line that holds nothing else, one for each word; None for another line.

    Names of types, such as double, stand for no unit, and so does an empty word.
    """
    units = [_bare_unit(word) for word in words]
    has_unit = any(_unquoted(word).lower() in TYPES for word in words)
    for unit in units:
        if any(size_of(unit, column) is not None for column in ("t", "x", "vx")):
            has_unit = True
        elif unit and _plain_unit(unit) not in OTHER_UNITS:
            return None
    return units if has_unit else None


def given(count: int, naming: Naming) -> Layout:
    """Return the layout of a file whose columns the user has named.

    Raises:
        InputError: there are more or fewer names, one is not known, or one that is needed is
            missing.
    """
    names = naming.columns
    option = "--columns"
    if len(names) != count:
        expected = f"a name for each of the {count} columns, or - for a column to skip"
        raise InputError(option, ",".join(names), expected)
    unknown = [name for name in names if name.strip() not in SKIPPED and meaning(name, {}) is None]
    if unknown:
        expected = f"names among {', '.join(['t', *COLUMNS])}"
        what_to_do = "Write - for a column to skip."
        raise InputError(option, ", ".join(unknown), expected, what_to_do)
    return layout(names, NEEDED, naming, option)


def by_number(count: int, needed: Sequence[str], naming: Naming) -> Layout | None:
    """Return the layout of a file without a header, by the number of its columns.

    None if that does not tell it.
    """
    if len(needed) == 1:
        return layout(["t"], needed, naming, "--columns") if count == 1 else None
    names = UNNAMED.get(count)
    if names is None:
        return None
    unread = ["-"] * (count - len(names))
    by_names = layout([*names, *unread], needed, naming, "--columns")
    text = f"no header: the columns are taken as {', '.join(names)} (--columns names others)"
    no_header = Deviation("no_header", text)
    return replace(by_names, conventions=(no_header, *by_names.conventions))


def advice(needed: Sequence[str]) -> str:
    """Return the advice which columns a header has to name."""
    more = f" and optionally {', '.join(COLUMNS[2:])}" if len(needed) > 1 else ""
    return f"Columns are {', '.join(needed)}{more}, named in the first line or by --columns."
