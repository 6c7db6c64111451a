"""The rows of a sweep: all combinations of the values in `--over` words, or the lines of a file (CSV, Parquet)."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from decimal import MAX_EMAX, MAX_PREC, MIN_EMIN, Context, Decimal
from fractions import Fraction
from functools import cached_property
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError, unknown, usable
from ..numbers.double_double import DoubleDouble
from ..numbers.precision import with_decimal_point
from ..scenes.scene import Reading, checked_value, field_names, full_name
from ..system.documents import MAX_JSON_BYTES, regular
from ..system.imports import needed
from .parquet import read_columns

TEXTS = ("inputs", "site.gravity_is")  # the fields that can be varied and are not numbers
_FIXED = (
    "id",
    "title",
    "source",
    "flags",
    "run.grid_step",
    "run.digits",
    "run.level",
    "run.transits",
    "run.sections",
)
MOST_ROWS = 10**8
MOST_VALUES = 10**7  # of a field: they are held as text
MOST_BYTES = MAX_JSON_BYTES  # of a file of rows, whose values go to the plan
FORMS = "START:STOP:STEP, or values V1,V2,…, or @FILE.csv"
PARQUET = (".parquet", ".pq")
# thousands, or a decimal comma before three digits
_GROUPED = re.compile(r"[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+")
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+([eE][+-]?[0-9]+)?")
_EXACT = Context(prec=MAX_PREC, Emax=MAX_EMAX, Emin=MIN_EMIN)


@dataclass(frozen=True)
class AxisTable:
    """Rows of exact values: all combinations of the values of fields, the last one fastest, or a list.

    Attributes:
        values: of each field that is varied its values as text; in a list one a row.
        typed: what stood after the fields' names in `--over` words; None for a list.
    """

    values: dict[str, tuple[str, ...]]
    typed: dict[str, str] | None = None

    @classmethod
    def of(
        cls, typed: dict[str, str] | None, stored: Mapping[str, Sequence[str]], reading: Reading
    ) -> AxisTable:
        """Return the rows of which `typed` and `stored` are written down."""
        values = {key: tuple(texts) for key, texts in stored.items()}
        if typed is None:
            return cls(values)
        return cls(
            {
                key: values.get(key) or axis(f"{key}={word}", reading)[-1]
                for key, word in typed.items()
            },
            typed,
        )

    @property
    def stored(self) -> dict[str, tuple[str, ...]]:
        """The values that do not follow from what was typed: those that come from a file."""
        return {
            key: texts
            for key, texts in self.values.items()
            if self.typed is None or self.typed[key].startswith("@")
        }

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """The shape of a column as an array: the numbers of values of the fields, or the length of a list."""
        sizes = tuple(map(len, self.values.values()))
        return sizes[:1] if self.typed is None else sizes

    @property
    def count(self) -> int:
        """The number of rows."""
        return math.prod(self.shape)

    def texts(self, row: int) -> dict[str, str]:
        """Return the values of a row by field."""
        return {key: texts[place] for key, texts, (place,) in self._placed([row])}

    def numbers(self, rows: Any, reading: Reading) -> dict[str, DoubleDouble]:
        """Return the numbers of rows by field; only where nothing is wrong with them."""
        columns = {}
        for key, texts, places in self._placed(rows):
            if key not in TEXTS:
                distinct, back = np.unique(places, return_inverse=True)
                numbers = _numbers([texts[place] for place in distinct], reading)
                columns[key] = DoubleDouble(numbers.high[back], numbers.low[back])
        return columns

    def words(self, rows: Any) -> dict[str, list[str]]:
        """Return the values of rows by field, those that are words."""
        return {
            key: [texts[place] for place in places]
            for key, texts, places in self._placed(rows)
            if key in TEXTS
        }

    def wrong(self, rows: Iterable[int], reading: Reading) -> dict[int, str]:
        """Return what is wrong with rows of a list, where one of the values is wrong by itself.

        Those of `--over` words were checked when they were read.
        """
        reasons: dict[int, str] = {}
        for key, texts in self.values.items() if self.typed is None else ():
            refusals = {text: _refusal(key, text, reading) for text in {texts[row] for row in rows}}
            for row in rows:
                if refusals[texts[row]]:
                    reasons.setdefault(row, refusals[texts[row]])
        return reasons

    def _placed(self, rows: Any) -> Iterator[tuple[str, tuple[str, ...], Any]]:
        """Yield each field, its values, and where among them those of rows stand."""
        numbers = np.asarray(rows, np.int64)
        listed = self.typed is None
        places = [numbers] * len(self.values) if listed else np.unravel_index(numbers, self.shape)
        return zip(self.values, self.values.values(), places, strict=True)


def _numbers(texts: Sequence[str], reading: Reading) -> DoubleDouble:
    """Return decimal numbers, shape (texts,), as a scene with this reading takes them."""
    high = [float(text) for text in texts]
    if reading == "binary64":
        low = [0.0] * len(high)
    else:
        pairs = zip(texts, high, strict=True)
        low = [
            float(_EXACT.subtract(Decimal(text), Decimal(h))) if math.isfinite(h) else 0.0
            for text, h in pairs
        ]
    return DoubleDouble(np.array(high), np.array(low))


def _refusal(key: str, text: str, reading: Reading) -> str:
    try:
        checked_value(key, text, reading)
    except InputError as error:
        return str(error)
    return ""


def varied_names() -> list[str]:
    """Return the names of the fields that a sweep can vary."""
    return [name for name in field_names() if name not in _FIXED]


def _check_key(option: str, key: str) -> None:
    """Raise InputError for what is no field of a scene, or none that a sweep can vary."""
    if full_name(key) not in varied_names():
        raise unknown(
            option,
            key,
            "a field that a sweep can vary",
            varied_names(),
            "`foucault show SCENE` lists them.",
        )


def grid(words: Iterable[str], reading: Reading) -> AxisTable:
    """Read `--over` words, and check their values.

    Raises:
        InputError: a wrong word, a field twice, or too many rows.
    """
    values: dict[str, tuple[str, ...]] = {}
    typed: dict[str, str] = {}
    for word in words:
        key, typed_values, texts = axis(word, reading)
        if key in values:
            raise InputError("--over", key, "each field once")
        values[key], typed[key] = texts, typed_values
    table = AxisTable(values, typed)
    if table.count > MOST_ROWS:
        raise InputError("--over", f"{table.count} rows", f"at most {MOST_ROWS:,} rows")
    return table


def axis(word: str, reading: Reading) -> tuple[str, str, tuple[str, ...]]:
    """Read one `--over` word, KEY=…; return the key, what stands after it, and the values, which are checked.

    Raises:
        InputError: unknown field, or a wrong value: field, got, expected.
    """
    key, sign, typed = (part.strip() for part in word.partition("="))
    if not sign or not typed:
        raise InputError("--over", word, f"KEY={FORMS}")
    key = full_name(key)
    _check_key("--over", key)
    if (":" in typed or ".." in typed) and not typed.startswith("@"):
        texts = _range(key, typed)
        for text in (texts[0], texts[-1]):
            checked_value(key, text, reading)  # between these lie the others
        return key, typed, texts
    listed: Iterable[str] = (
        _column_of_csv(Path(typed[1:]), key) if typed.startswith("@") else typed.split(",")
    )
    texts = tuple(text.strip() for text in listed)
    seen = set()
    for text in texts:
        checked_value(key, text, reading)
        if text in seen:
            raise InputError("--over", word, "each value once", f"{text} stands there twice.")
        seen.add(text)
    return key, typed, texts


def _range(key: str, word: str) -> tuple[str, ...]:
    """Return the values of START:STOP:STEP exactly, STOP among them if a step leads to it.

    Raises:
        InputError: no three numbers, no step, no value, or too many.
    """
    parts = [part.strip() for part in word.split(":")]
    if len(parts) != 3:
        raise InputError("--over", f"{key}={word}", f"{key}={FORMS}")
    start, stop, step = (_exactly(key, part) for part in parts)
    if step == 0 or (stop - start) / step < 0:
        raise InputError("--over", f"{key}={word}", "a STEP that leads from START to STOP")
    count = (stop - start) // step + 1
    if count > MOST_VALUES:
        raise InputError("--over", f"{key}={word}", f"at most {MOST_VALUES:,} values")
    decimals = max(0, *(-int(Decimal(part).as_tuple().exponent) for part in parts))
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


def listed(path: Path) -> AxisTable:
    """Read a file of rows.

    Raises:
        InputError: it cannot be read, has no rows, or a column is no field that can be varied.
    """
    columns = (
        _columns_of_parquet(path)
        if path.suffix.lower() in PARQUET
        else _columns_of_csv("--rows", path)
    )
    names = [name for name, _ in columns]
    for name in names:
        if names.count(name) > 1:
            raise InputError("--rows", name, "each field once")
        _check_key("--rows", name)
    if not columns or not columns[0][1]:
        raise InputError("--rows", str(path), "a line of names of fields, and rows below it")
    return AxisTable(dict(columns))


def _columns_of_parquet(path: Path) -> list[tuple[str, tuple[str, ...]]]:
    """Return the columns of a Parquet file; a double stands for exactly the number that it is."""
    needed("pyarrow", "sweep", "--rows", "reading Parquet")
    with _readable("--rows", path), regular(path, "--rows", MOST_BYTES, "a Parquet file") as stream:
        columns = read_columns(stream, _check_size)
    return [(full_name(key), tuple(map(_text, column))) for key, column in columns.items()]


def _check_size(names: Iterable[str], rows: int) -> None:
    """Refuse a file of rows by its columns, or their number."""
    for key in names:
        _check_key("--rows", key)
    if rows > MOST_VALUES:
        raise InputError("--rows", f"{rows} rows", f"at most {MOST_VALUES:,}")


def _text(value: Any) -> str:
    return format(Decimal(value), "f") if isinstance(value, float | int) else str(value)


def _columns_of_csv(option: str, path: Path) -> list[tuple[str, tuple[str, ...]]]:
    """Return the columns of a CSV file: of each its name, which may be a value, and the values below it.

    The first line tells whether commas, semicolons or tabs separate them. A first column without a name is the index
    of a data frame, and is left out.
    """
    with _readable(option, path), regular(path, option, MOST_BYTES, "a CSV file") as stream:
        text = io.TextIOWrapper(stream, "utf-8-sig", newline="")
        first = text.readline()
        separator = next((mark for mark in ";\t" if mark in first), ",")
        rows = csv.reader(chain([first], text), delimiter=separator)
        lines = list(islice((line for line in rows if any(line)), MOST_VALUES + 2))
    if not 0 < len(lines) <= MOST_VALUES + 1:
        raise InputError(option, str(path), f"a CSV file of 1 to {MOST_VALUES:,} rows")
    names, *below = lines
    for number, line in enumerate(lines, 1):
        if len(line) != len(names):
            expected = f"{len(names)} values as in the first"
            raise InputError(option, f"{path}, row {number}", expected, f"It has {len(line)}.")
    if len(names) > 1 and not names[0].strip():
        names, below = names[1:], [line[1:] for line in below]
    if separator != ",":
        below = [[_with_point(option, cell) for cell in line] for line in below]
    return [
        (full_name(name), tuple(line[i].strip() for line in below)) for i, name in enumerate(names)
    ]


def _with_point(option: str, cell: str) -> str:
    """Return a value with a point for its decimal comma.

    Raises:
        InputError: its comma may separate thousands.
    """
    if _GROUPED.fullmatch(cell.strip()):
        raise InputError(
            option, cell, "a point for the decimal mark", "Does its comma separate thousands?"
        )
    return cell.replace(",", ".") if _DECIMAL_COMMA.fullmatch(cell.strip()) else cell


def _column_of_csv(path: Path, key: str) -> tuple[str, ...]:
    """Return the values of one field from a CSV file: its column of that name, or the only one.

    Raises:
        InputError: it cannot be read, or there is no such column.
    """
    columns = _columns_of_csv("--over", path)
    for name, values in columns:
        if name == key:
            return values
    if len(columns) > 1:
        raise InputError(
            "--over", f"{key}=@{path}", f"a column {key}", f"It has {', '.join(dict(columns))}."
        )
    return (columns[0][0], *columns[0][1])


@contextmanager
def _readable(option: str, path: Path) -> Iterator[None]:
    try:
        with usable(option, path, "a readable file"):
            yield
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(option, str(path), "a CSV file in UTF-8", f"{error}.") from None
