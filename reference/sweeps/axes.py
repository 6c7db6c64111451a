"""The axes of a sweep: `--over` words as exact values, all combinations of which are the rows."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from heapq import nsmallest
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..numbers.precision import with_decimal_point
from ..scenes.scene import Reading, checked_value
from .lists import column_of_csv
from .values import Table, check_key

MOST_ROWS = 10**8
MOST_VALUES = 10**7  # of a field: they are held as text
FORMS = "START:STOP:STEP, or values V1,V2,…, or @FILE.csv"


@dataclass(frozen=True)
class Grid(Table):
    """All combinations of the values of fields, the last one fastest; `typed` is what stood after their names."""

    typed: dict[str, str]

    @property
    def shape(self) -> tuple[int, ...]:
        """The numbers of values of the fields."""
        return tuple(map(len, self.values.values()))

    def places(self, rows: Any) -> tuple[Any, ...]:
        """Return, for each field, where among its values those of rows stand."""
        return np.unravel_index(np.asarray(rows, np.int64), self.shape)

    @property
    def listed(self) -> dict[str, tuple[str, ...]]:
        """The values of the fields that come from a file."""
        return {key: self.values[key] for key, word in self.typed.items() if word.startswith("@")}


def grid(words: Iterable[str], reading: Reading) -> Grid:
    """Read `--over` words, and check their values.

    Raises:
        InputError: a wrong word, a field twice, or too many rows.
    """
    values: dict[str, tuple[str, ...]] = {}
    typed: dict[str, str] = {}
    for word in words:
        key, typed_word, texts = axis(word, reading)
        if key in values:
            raise InputError("--over", key, "each field once")
        values[key], typed[key] = texts, typed_word
    made = Grid(values, typed)
    if made.count > MOST_ROWS:
        raise InputError("--over", f"{made.count} rows", f"at most {MOST_ROWS:,} rows")
    return made


def axis(word: str, reading: Reading) -> tuple[str, str, tuple[str, ...]]:
    """Read one `--over` word, KEY=…; return the key, what stands after it, and the values, which are checked.

    Raises:
        InputError: unknown field, or a wrong value: field, got, expected.
    """
    key, sign, typed = (part.strip() for part in word.partition("="))
    if not sign or not typed:
        raise InputError("--over", word, f"KEY={FORMS}")
    check_key("--over", key)
    if ":" in typed and not typed.startswith("@"):
        texts = _range(key, typed)
        for text in (texts[0], texts[-1], *nsmallest(2, texts, key=lambda text: abs(float(text)))):
            checked_value(key, text, reading)  # between these lie the others
        return key, typed, texts
    listed = column_of_csv(Path(typed[1:]), key) if typed.startswith("@") else typed.split(",")
    texts = tuple(text.strip() for text in listed)
    seen = set()
    for text in texts:
        checked_value(key, text, reading)
        if text in seen:
            raise InputError("--over", word, "each value once", f"{text} stands there twice.")
        seen.add(text)
    return key, typed, texts


def _range(key: str, word: str) -> tuple[str, ...]:
    """Return the values of START:STOP:STEP, both ends in, exactly.

    Raises:
        InputError: no three numbers, no step, no value, or too many.
    """
    parts = word.split(":")
    if len(parts) != 3:
        raise InputError("--over", f"{key}={word}", f"{key}={FORMS}")
    start, stop, step = (_exactly(key, part.strip()) for part in parts)
    if step == 0 or (stop - start) / step < 0:
        raise InputError("--over", f"{key}={word}", "a STEP that leads from START to STOP")
    count = (stop - start) // step + 1
    if count > MOST_VALUES:
        raise InputError("--over", f"{key}={word}", f"at most {MOST_VALUES:,} values")
    decimals = max(_decimals(value) for value in (start, stop, step))
    first, by = int(start * 10**decimals), int(step * 10**decimals)
    texts = (with_decimal_point(first + i * by, decimals) for i in range(count))
    return tuple(text.rstrip("0").rstrip(".") if decimals else text for text in texts)


def _exactly(key: str, text: str) -> Fraction:
    """Return the exact value of a number that may lie beyond the field's range, as a step does."""
    try:
        checked_value("site.altitude", text, "decimal")  # which may be any number
    except InputError as error:
        raise InputError("--over", f"{key}={text}", error.expected, error.advice) from None
    return Fraction(text)


def _decimals(value: Fraction) -> int:
    """Return how many digits a decimal fraction has after the point."""
    decimals = 0
    while (value * 10**decimals).denominator != 1:
        decimals += 1
    return decimals
