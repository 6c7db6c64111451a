"""The rows of a sweep: all combinations of the values in `--over` words, or the lines of a file (CSV, Parquet)."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from heapq import nsmallest
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..numbers.precision import with_decimal_point
from ..scenes.scene import Reading, checked_value
from ..system.imports import missing
from .values import Table, check_key

MOST_ROWS = 10**8
MOST_VALUES = 10**7  # of a field: they are held as text
FORMS = "START:STOP:STEP, or values V1,V2,…, or @FILE.csv"
PARQUET = (".parquet", ".pq")


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


@dataclass(frozen=True)
class Listed(Table):
    """Rows of a file: of each field its values, one a row."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of rows."""
        return (len(next(iter(self.values.values()))),)

    def places(self, rows: Any) -> list[Any]:
        """Return, for each field, where among its values those of rows stand."""
        return [np.asarray(rows, np.int64)] * len(self.values)

    def wrong(self, rows: Any, reading: Reading) -> dict[int, str]:
        """Return what is wrong with the values of rows, each by itself, of those where something is."""
        found: dict[int, str] = {}
        for key, column in self.values.items():
            known: dict[str, str] = {}
            for row in rows:
                text = column[row]
                if text not in known:
                    known[text] = _refusal(key, text, reading)
                if known[text]:
                    found.setdefault(row, known[text])
        return found


def listed(path: Path) -> Listed:
    """Read a file of rows.

    Raises:
        InputError: it cannot be read, has no rows, or a column is no field that can be varied.
    """
    values = _parquet(path) if path.suffix.lower() in PARQUET else _csv(path)
    for key in values:
        check_key("--rows", key)
    if not values or not len(next(iter(values.values()))):
        raise InputError("--rows", str(path), "a line of names of fields, and rows below it")
    return Listed(values)


def column_of_csv(path: Path, key: str) -> list[str]:
    """Return the values of one field from a CSV file: its column of that name, or the only one.

    Raises:
        InputError: it cannot be read, or there is no such column.
    """
    table = _lines("--over", path)
    if key in table[0]:
        at = table[0].index(key)
        table = table[1:]
    elif len(table[0]) == 1:
        at = 0
    else:
        raise InputError("--over", f"{key}=@{path}", f"a column {key}", f"It has {', '.join(table[0])}.")
    return [line[at] for line in table]


def _refusal(key: str, text: str, reading: Reading) -> str:
    try:
        checked_value(key, text, reading)
    except InputError as error:
        return str(error)
    return ""


@contextmanager
def _readable(option: str, path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(option, str(path), "a readable file", f"{error.strerror}.") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(option, str(path), "a CSV file in UTF-8", f"{error}.") from None


def _lines(option: str, path: Path) -> list[list[str]]:
    """Return the lines of a CSV file, all of one length."""
    with _readable(option, path), path.open(newline="", encoding="utf-8-sig") as stream:
        lines = [line for line in csv.reader(stream) if line]
    if not lines:
        raise InputError(option, str(path), "a CSV file with a line at least")
    for number, line in enumerate(lines, 1):
        if len(line) != len(lines[0]):
            raise InputError(
                option, f"{path}, row {number}", f"{len(lines[0])} values as in the first", f"It has {len(line)}."
            )
    return lines


def _csv(path: Path) -> dict[str, tuple[str, ...]]:
    names, *lines = _lines("--rows", path)
    keys = [name.strip() for name in names]
    for key in keys:
        if keys.count(key) > 1:
            raise InputError("--rows", key, "each field once")
    columns = zip(*lines, strict=True)
    return {key: tuple(text.strip() for text in column) for key, column in zip(keys, columns, strict=False)}


def _parquet(path: Path) -> dict[str, tuple[str, ...]]:
    """Return the columns of a Parquet file; a double stands for exactly the number that it is."""
    if missing(["pyarrow"]):
        raise InputError(
            "--rows", str(path), "the package pyarrow", "Install it with pip install 'foucault-reference[sweep]'."
        )
    from .parquet import read_columns

    with _readable("--rows", path):
        columns: dict[str, list[Any]] = read_columns(path)
    return {key: tuple(map(_text, column)) for key, column in columns.items()}


def _text(value: Any) -> str:
    return format(Decimal(value), "f") if isinstance(value, float | int) else str(value)
