"""Units of time, length and speed as headers and people write them, each with its size in SI units."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np

from reference import InputError
from reference.numbers.precision import Array

TIMES = {
    "s": Fraction(1), "ms": Fraction(1, 10**3), "us": Fraction(1, 10**6), "ns": Fraction(1, 10**9),
    "min": Fraction(60), "h": Fraction(3600), "d": Fraction(86400),
}  # fmt: skip
LENGTHS = {
    "m": Fraction(1), "dm": Fraction(1, 10), "cm": Fraction(1, 100), "mm": Fraction(1, 1000), "um": Fraction(1, 10**6),
    "km": Fraction(1000), "in": Fraction("0.0254"), "ft": Fraction("0.3048"),
}  # fmt: skip
OTHER_WORDS = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "msecs": "ms", "millisecond": "ms",
    "milliseconds": "ms", "usec": "us", "microsecond": "us", "microseconds": "us", "nanoseconds": "ns", "mins": "min",
    "minute": "min", "minutes": "min", "hr": "h", "hrs": "h", "hour": "h", "hours": "h", "day": "d", "days": "d",
    "meter": "m", "meters": "m", "metre": "m", "metres": "m", "centimeter": "cm", "centimeters": "cm",
    "centimetre": "cm", "centimetres": "cm", "millimeter": "mm", "millimeters": "mm", "millimetre": "mm",
    "millimetres": "mm", "kilometer": "km", "kilometers": "km", "kilometre": "km", "kilometres": "km", "inch": "in",
    "inches": "in", "foot": "ft", "feet": "ft",
}  # fmt: skip
_PER = re.compile(r"(\w+?)\s*(?:/|_per_|\s+per\s+|_)\s*(\w+)|(\w+)\s*[·*⋅ ]?\s*(\w+?)\s*(?:\^?\s*[-−]1|⁻¹)")
SHORT_SPEEDS = {"mps": "m/s", "cmps": "cm/s", "mmps": "mm/s", "kmh": "km/h", "kph": "km/h"}


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
    parts = _PER.fullmatch(word)
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
            known = ", ".join([*TIMES, *LENGTHS])
            raise InputError("--units", word, f"units of time or length: {known}", "Separate two with a comma.")
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
