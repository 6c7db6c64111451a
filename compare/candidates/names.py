"""The meaning of a word of a header: its column, unit and direction, in the words that programs use; units in SI.

`pos_x`, `X (cm)`, `east`, `x/m` and `position x` are x; `time [ms]`, `t_s` and `seconds` are t; `vx`, `xdot`, `dx/dt`
and `v_x` are vx; `west`, `south` and `down` are x, y and z with the other sign.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from reference import InputError
from reference.numbers.precision import Array
from reference.system.documents import texts_of

vocabulary = texts_of(__file__)
DIRECTIONS: dict[str, tuple[str, int]] = {word: (axis, sign) for word, (axis, sign) in vocabulary["directions"].items()}
AXES = {"x": ("x", 1), "y": ("y", 1), "z": ("z", 1)} | DIRECTIONS
_AXIS = "|".join(sorted(AXES, key=len, reverse=True))
_PLACE = "position|pos|coordinate|coord|displacement|disp|location|loc"
_SPEED = "velocity|vel|speed"
POSITION = re.compile(rf"(?:{_PLACE}|bob|r)?([xyz])?({_AXIS})(?:{_PLACE}|axis)?")
VELOCITY = re.compile(rf"(?:{_SPEED}|v)([xyz])?({_AXIS})|([xyz])?({_AXIS})(?:{_SPEED}|dot|prime)|d()({_AXIS})dt")
TIME_WORDS: set[str] = set(vocabulary["time_words"])
TIME_UNITS = re.compile(r"sec|secs|seconds?|ms|msec|milliseconds?|minutes?|hours?|days?")  # a column that is called so
LONGEST = 100  # characters of a word; the patterns' time grows with the square, and a line may have 64 KiB
BRACKETS = re.compile(r"(.*?)\s*[(\[{<]\s*(.*?)\s*[)\]}>]")
AFTER = re.compile(r"(.*?)(?:\s*/\s*|\s+in\s+|[\s_.]+)([^\s_/.]+(?:(?:/|_per_|_)[^\s_/]+)?)")
TIMES, LENGTHS = (
    {unit: Fraction(size) for unit, size in vocabulary[kind].items()} for kind in ("times", "lengths")
)  # in s and m
LONG_NAMES: dict[str, str] = vocabulary["long_names"]
OTHER_WORDS: dict[str, str] = vocabulary["other_words"]
PER = re.compile(r"(\w+?)\s*(?:/|_per_|\s+per\s+|_)\s*(\w+)|(\w+)\s*[·*⋅ ]?\s*(\w+?)\s*(?:\^?\s*[-−]1|⁻¹)")
SHORT_SPEEDS: dict[str, str] = vocabulary["short_speeds"]


@dataclass(frozen=True)
class Meaning:
    """Say which column a word of a header names, and in which unit.

    Attributes:
        column: t, x, y, z, vx, vy or vz.
        factor: by which its numbers come to SI units and to the column's direction; None if the unit is not known.
        unit: as printed; empty if there is none.
        rank: 0 for the column's own name, 1 for it in capitals, 2 for another word.
    """

    column: str
    factor: Fraction | None
    unit: str
    rank: int


def meaning(word: str, units: dict[str, str]) -> Meaning | None:
    """Return what a word of a header means; None for a column that is not read.

    Args:
        word: as printed.
        units: units that hold where the word names none, by column.

    Raises:
        InputError: its unit contradicts `units`.
    """
    text = unquoted(word)
    for name, said in _parts(text) if len(text) <= LONGEST else ():
        found = _column(name)
        if found is None:
            continue
        (column, sign, rank), unit = found, said
        rank = 2 if said == text else rank  # it is called by its unit
        if said.lower() in DIRECTIONS and column != "t":
            turned, sign = DIRECTIONS[said.lower()]
            column, unit, rank = f"{column[:-1]}{turned}", "", 2
        if said.lower() in ("t", "time") and column != "t":
            unit = ""  # x(t)
        size = size_of(unit, column) if unit else Fraction(1)
        if size is None:
            if BRACKETS.fullmatch(text):
                return Meaning(column, None, unit, rank)
            continue  # it may be no unit
        if not unit and column in units:
            unit = units[column]
            size = size_of(unit, column) or Fraction(1)
        elif unit and size != 1 and column in units and size_of(units[column], column) != size:
            raise InputError("--units", units[column], f"no other unit of {column} than {unit}, as its header says")
        return Meaning(column, size * sign, unit, rank)
    return None


def unquoted(word: str) -> str:
    """Return a word without white space around it and without a pair of quotes."""
    text = word.strip()
    return text[1:-1].strip() if len(text) > 1 and text[0] == text[-1] and text[0] in "\"'`" else text


def _parts(text: str) -> list[tuple[str, str]]:
    """Return the ways to take a word apart into a name and a unit, the most likely first."""
    brackets = BRACKETS.fullmatch(text)
    if brackets:
        return [(brackets[1], brackets[2])]
    ways = [(text, "")]
    if TIME_UNITS.fullmatch(text.lower()):
        ways.append(("t", text))
    after = AFTER.fullmatch(text)
    if after:
        ways.append((after[1], after[2]))
    return ways


def _column(name: str) -> tuple[str, int, int] | None:
    """Return the column, sign and rank of a name without a unit."""
    if name in ("t", "x", "y", "z", "vx", "vy", "vz"):
        return name, 1, 0
    if name.lower() in ("t", "x", "y", "z", "vx", "vy", "vz"):
        return name.lower(), 1, 1
    plain = unicodedata.normalize("NFD", name.lower()).replace("\u0307", "dot")
    plain = re.sub(r"['’′]$", "prime", plain)
    plain = "".join(letter for letter in plain if letter.isalnum())
    if plain in TIME_WORDS:
        return "t", 1, 2
    for pattern, speed in ((POSITION, ""), (VELOCITY, "v")):
        match = pattern.fullmatch(plain)
        if match:
            given = [group for group in match.groups() if group]
            axis, sign = AXES[given[-1]]
            if len(given) > 1 and given[-1] not in DIRECTIONS:
                return None
            return f"{speed}{axis}", sign, 2
    return None


def plain_unit(word: str) -> str:
    """Return the usual word for a unit of time or length: `s` for seconds; other words come back in lower case."""
    word = word.strip().lower().replace("µ", "u").replace("μ", "u").strip(".")
    return OTHER_WORDS.get(word, word)


def size_of(unit: str, column: str) -> Fraction | None:
    """Return the size in SI units of a unit of time (of t), length (of x, y, z) or speed; None if it is none of these.

    In the column of a speed, `ms` means m/s.
    """
    if column == "t":
        return TIMES.get(plain_unit(unit))
    if column in ("x", "y", "z"):
        return LENGTHS.get(plain_unit(unit))
    word = unit.strip().lower()
    word = "m/s" if word == "ms" else SHORT_SPEEDS.get(word, word)
    parts = PER.fullmatch(word)
    if parts is None:
        return None
    length, time = (parts[1], parts[2]) if parts[1] else (parts[3], parts[4])
    above, below = LENGTHS.get(plain_unit(length)), TIMES.get(plain_unit(time))
    return None if above is None or below is None else above / below


def defaults(words: tuple[str, ...]) -> dict[str, str]:
    """Return the unit of each column from the words of `--units`, such as ms and cm; a speed is a length per second.

    Raises:
        InputError: a word is no unit of time or length, or there are two of one kind.
    """
    units: dict[str, str] = {}
    for word in words:
        unit = plain_unit(word)
        columns = ("t",) if unit in TIMES else ("x", "y", "z", "vx", "vy", "vz") if unit in LENGTHS else ()
        if not columns:
            expected = f"units of time or length: {', '.join([*TIMES, *LENGTHS])}"
            raise InputError("--units", word, expected, "Separate two with a comma.")
        if columns[0] in units:
            raise InputError("--units", ",".join(words), "one unit of time and one of length at most")
        units |= {column: f"{unit}/s" if column.startswith("v") else unit for column in columns}
    return units


def multiplied(near: Array, low: Array, factor: Fraction) -> tuple[Array, Array]:
    """Multiply doubles with low parts; what is not finite, and will be refused, stays as it is."""
    scaled, rest = near.copy(), np.zeros_like(low)
    for i in np.flatnonzero(np.isfinite(near)).tolist():
        exact = (Fraction(float(near[i])) + Fraction(float(low[i]))) * factor
        scaled[i] = float(exact)
        rest[i] = float(exact - Fraction(float(scaled[i])))
    return scaled, rest
