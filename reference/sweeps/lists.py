"""Rows listed in a file, CSV or Parquet, whose columns are fields of a scene: for Monte Carlo, Sobol points, pairs."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..numbers.double_double import DoubleDouble
from ..scenes.scene import Reading, checked_value
from ..system.imports import missing
from .values import TEXTS, check_key, numbers_of

PARQUET = (".parquet", ".pq")


@dataclass(frozen=True)
class Listed:
    """Rows of a file: of each field its values as text, one a row."""

    values: dict[str, list[str]]

    @property
    def keys(self) -> tuple[str, ...]:
        """The fields that are varied."""
        return tuple(self.values)

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of rows."""
        return (self.count,)

    @property
    def count(self) -> int:
        """The number of rows."""
        return len(next(iter(self.values.values())))

    def texts(self, row: int) -> dict[str, str]:
        """Return the values of a row by field."""
        return {key: column[row] for key, column in self.values.items()}

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

    def numbers(self, rows: Any, reading: Reading) -> dict[str, DoubleDouble]:
        """Return the numbers of rows by field; only where nothing is wrong with them."""
        numeric = (key for key in self.values if key not in TEXTS)
        return {key: numbers_of([self.values[key][row] for row in rows], reading) for key in numeric}

    def words(self, rows: Any) -> dict[str, list[str]]:
        """Return the values of rows by field, those that are words."""
        return {key: [self.values[key][row] for row in rows] for key in self.values if key in TEXTS}


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
    return [line[at].strip() for line in table]


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


def _csv(path: Path) -> dict[str, list[str]]:
    names, *lines = _lines("--rows", path)
    keys = [name.strip() for name in names]
    for key in keys:
        if keys.count(key) > 1:
            raise InputError("--rows", key, "each field once")
    return {key: [text.strip() for text in column] for key, column in zip(keys, zip(*lines, strict=True), strict=False)}


def _parquet(path: Path) -> dict[str, list[str]]:
    """Return the columns of a Parquet file; a double stands for exactly the number that it is."""
    if missing(["pyarrow"]):
        raise InputError(
            "--rows", str(path), "the package pyarrow", "Install it with pip install 'foucault-reference[sweep]'."
        )
    from .parquet import read_columns

    with _readable("--rows", path):
        columns: dict[str, list[Any]] = read_columns(path)
    return {key: [_text(value) for value in column] for key, column in columns.items()}


def _text(value: Any) -> str:
    return format(Decimal(value), "f") if isinstance(value, float | int) else str(value)
