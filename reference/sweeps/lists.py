"""Rows listed in a file, CSV or Parquet, whose columns are fields of a scene: for Monte Carlo, Sobol points, pairs."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..scenes.scene import Reading, checked_value
from ..system.imports import missing
from .values import Table, check_key

PARQUET = (".parquet", ".pq")


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
