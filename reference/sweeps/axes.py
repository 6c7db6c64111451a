"""The rows of a sweep: combinations of the values in `--over` words, or the lines of a file."""

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
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import Described, InputError, counted, unknown, usable
from ..numbers.double_double import DoubleDouble
from ..numbers.precision import with_decimal_point
from ..scenes.scene import Reading, checked_value, field_names, full_name
from ..system.documents import MAX_JSON_BYTES, regular
from ..system.imports import needed
from .parquet import read_columns

WORD_FIELDS = ("inputs", "site.gravity_is")  # the fields that can be varied and are not numbers
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
_MAX_ROWS = 10**8
MAX_VALUES = 10**7  # of a field: they are held as text
_MAX_BYTES = MAX_JSON_BYTES  # of a file of rows, whose values go to the plan
_FORMS = "START:STOP:STEP, or values V1,V2,…, or @FILE.csv"
_PARQUET = (".parquet", ".pq")
# thousands, or a decimal comma before three digits
_GROUPED = re.compile(r"[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+")
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+([eE][+-]?[0-9]+)?")
_EXACT = Context(prec=MAX_PREC, Emax=MAX_EMAX, Emin=MIN_EMIN)


@dataclass(frozen=True)
class AxisTable:
    """Rows of exact values: all combinations of values, the last field fastest, or a list.

    Attributes:
        values: of each field that is varied its values as text; in a list one a row.
        typed: of each field what a user typed after its name in `--over`; None for a list.
    """

    values: dict[str, tuple[str, ...]]
    typed: dict[str, str] | None = None

    @classmethod
    def restored(
        cls, typed: dict[str, str] | None, stored: Mapping[str, Sequence[str]], reading: Reading
    ) -> AxisTable:
        """Return the table that was written as `typed` and `stored`."""
        from_file = {key: tuple(texts) for key, texts in stored.items()}
        if typed is None:
            return cls(from_file)
        values = {}
        for key, word in typed.items():
            values[key] = from_file.get(key) or axis(f"{key}={word}", reading).values
        return cls(values, typed)

    @property
    def stored(self) -> dict[str, tuple[str, ...]]:
        """The values that come from a file, and so do not follow from what was typed."""
        return {
            key: texts
            for key, texts in self.values.items()
            if self.typed is None or self.typed[key].startswith("@")
        }

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """The shape of a column: the numbers of values of the fields, or the length of a list."""
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
        """Return the numerical values of rows by field; the rows must be valid."""
        columns = {}
        for key, texts, places in self._placed(rows):
            if key in WORD_FIELDS:
                continue
            distinct, place_among_distinct = np.unique(places, return_inverse=True)
            numbers = _numbers([texts[place] for place in distinct], reading)
            columns[key] = DoubleDouble(
                numbers.high[place_among_distinct], numbers.low[place_among_distinct]
            )
        return columns

    def words(self, rows: Any) -> dict[str, list[str]]:
        """Return the values of rows that are words, by field."""
        words = {}
        for key, texts, places in self._placed(rows):
            if key in WORD_FIELDS:
                words[key] = [texts[place] for place in places]
        return words

    def wrong(self, rows: Sequence[int], reading: Reading) -> dict[int, str]:
        """Return, by row of a list, what is wrong with its first invalid value.

        The values of `--over` words were checked when they were read.
        """
        reasons: dict[int, str] = {}
        if self.typed is not None:
            return reasons
        for key, texts in self.values.items():
            distinct = {texts[row] for row in rows}
            refusals = {text: _refusal(key, text, reading) for text in distinct}
            for row in rows:
                refusal = refusals[texts[row]]
                if refusal:
                    reasons.setdefault(row, refusal)
        return reasons

    def _placed(self, rows: Any) -> Iterator[tuple[str, tuple[str, ...], Any]]:
        """Yield each field, its values, and the place of each row's value among them."""
        numbers = np.asarray(rows, np.int64)
        if self.typed is None:
            places = [numbers] * len(self.values)
        else:
            places = list(np.unravel_index(numbers, self.shape))
        return zip(self.values, self.values.values(), places, strict=True)


def _numbers(texts: Sequence[str], reading: Reading) -> DoubleDouble:
    """Return decimal numbers, shape (texts,), as a scene with this reading takes them."""
    high = np.array([float(text) for text in texts])
    if reading == "binary64":
        return DoubleDouble(high, np.zeros(len(high)))
    low = [_rounded_off(text, nearest) for text, nearest in zip(texts, high.tolist(), strict=True)]
    return DoubleDouble(high, np.array(low))


def _rounded_off(text: str, nearest: float) -> float:
    """Return a decimal number minus its nearest double; 0 where that is not finite."""
    if not math.isfinite(nearest):
        return 0.0
    return float(_EXACT.subtract(Decimal(text), Decimal(nearest)))


def _refusal(key: str, text: str, reading: Reading) -> str:
    """Return why a value of a field is wrong; "" if it is right."""
    try:
        checked_value(key, text, reading)
    except InputError as error:
        return str(error)
    return ""


def varied_names() -> list[str]:
    """Return the names of the fields that a sweep can vary."""
    return [name for name in field_names() if name not in _FIXED]


def _check_key(option: str, key: str) -> None:
    """Raise InputError for a key that is not a field of a scene, or that a sweep cannot vary."""
    names = varied_names()
    if full_name(key) not in names:
        advice = "`foucault show SCENE` lists them."
        raise unknown(option, key, "a field that a sweep can vary", names, advice)


def combinations(words: Iterable[str], reading: Reading) -> AxisTable:
    """Return the table of all combinations of the values of `--over` words, which are checked.

    Raises:
        InputError: a wrong word, a field twice, or too many rows.
    """
    values: dict[str, tuple[str, ...]] = {}
    typed: dict[str, str] = {}
    for word in words:
        read = axis(word, reading)
        if read.key in values:
            raise InputError("--over", read.key, "each field at most once")
        values[read.key] = read.values
        typed[read.key] = read.typed
    table = AxisTable(values, typed)
    if table.count > _MAX_ROWS:
        raise InputError("--over", Described(f"{table.count} rows"), f"at most {_MAX_ROWS:,} rows")
    return table


@dataclass(frozen=True)
class Axis:
    """One `--over` word: a field and its values.

    Attributes:
        key: the full name of the field.
        typed: what was typed after KEY=.
        values: the values as text.
    """

    key: str
    typed: str
    values: tuple[str, ...]


def axis(word: str, reading: Reading) -> Axis:
    """Return the field and the values of one `--over` word, KEY=…, which are checked.

    Raises:
        InputError: unknown field, or a wrong value: field, got, expected.
    """
    key, sign, typed = (part.strip() for part in word.partition("="))
    if not sign or not typed:
        raise InputError("--over", word, f"KEY={_FORMS}")
    key = full_name(key)
    _check_key("--over", key)
    from_file = typed.startswith("@")
    if (":" in typed or ".." in typed) and not from_file:
        values = _range(key, typed)
        for text in (values[0], values[-1]):
            checked_value(key, text, reading)  # all others lie between these two
        return Axis(key, typed, values)

    texts = _column_of_csv(Path(typed[1:]), key) if from_file else typed.split(",")
    values = tuple(text.strip() for text in texts)
    seen = set()
    for text in values:
        checked_value(key, text, reading)
        value = _distinguished(key, text, reading)
        if value in seen:
            raise InputError("--over", word, "each value once", f"{text} is given twice.")
        seen.add(value)
    return Axis(key, typed, values)


def _distinguished(key: str, text: str, reading: Reading) -> str | float | Decimal:
    """Return what tells a value of a field from another: a word, or the number that a scene takes."""
    if key in WORD_FIELDS:
        return text
    return float(text) if reading == "binary64" else Decimal(text)


def _range(key: str, word: str) -> tuple[str, ...]:
    """Return the values of START:STOP:STEP exactly, STOP among them if a step leads to it.

    Raises:
        InputError: no three numbers, no step, no value, or too many.
    """
    parts = [part.strip() for part in word.split(":")]
    if len(parts) != 3:
        raise InputError("--over", f"{key}={word}", f"{key}={_FORMS}")
    start, stop, step = (_exactly(key, part) for part in parts)
    if step == 0 or (stop - start) / step < 0:
        raise InputError("--over", f"{key}={word}", "a STEP towards STOP")
    count = (stop - start) // step + 1
    if count > MAX_VALUES:
        raise InputError("--over", f"{key}={word}", f"at most {MAX_VALUES:,} values")
    exponents = [int(Decimal(part).as_tuple().exponent) for part in parts]
    decimals = max(0, -min(exponents))
    first_scaled = int(start * 10**decimals)
    step_scaled = int(step * 10**decimals)
    texts = []
    for i in range(count):
        text = with_decimal_point(first_scaled + i * step_scaled, decimals)
        texts.append(text.rstrip("0").rstrip(".") if decimals else text)
    return tuple(texts)


def _exactly(key: str, text: str) -> Fraction:
    """Return the exact value of a number that may lie beyond the field's range, as a step may."""
    try:
        checked_value("site.altitude", text, "decimal")  # a field that may be any number
    except InputError as error:
        raise InputError("--over", f"{key}={text}", error.expected, error.advice) from None
    return Fraction(text)


def rows_of_file(path: Path) -> AxisTable:
    """Return the table of the rows of a file, whose values are not checked.

    Raises:
        InputError: it cannot be read, has no rows, or a column is no field that can be varied.
    """
    if path.suffix.lower() in _PARQUET:
        columns = _columns_of_parquet(path)
    else:
        columns = _columns_of_csv("--rows", path)
    names = [name for name, _ in columns]
    for name in names:
        if names.count(name) > 1:
            raise InputError("--rows", name, "each field in at most one column")
        _check_key("--rows", name)
    if not columns or not columns[0][1]:
        raise InputError(
            "--rows", str(path), "a header line with names of fields, and rows below it"
        )
    return AxisTable(dict(columns))


def _columns_of_parquet(path: Path) -> list[tuple[str, tuple[str, ...]]]:
    """Return the columns of a Parquet file; a double stands for exactly the number that it is."""
    needed("pyarrow", "sweep", "--rows", "reading Parquet")
    with (
        _readable("--rows", path),
        regular(path, "--rows", _MAX_BYTES, "a Parquet file") as stream,
    ):
        columns = read_columns(stream, _check_size)
    return [(full_name(key), tuple(map(_text, column))) for key, column in columns.items()]


def _check_size(names: Iterable[str], rows: int) -> None:
    """Refuse a file of rows by its columns, or their number."""
    for key in names:
        _check_key("--rows", key)
    if rows > MAX_VALUES:
        raise InputError("--rows", Described(f"{rows} rows"), f"at most {MAX_VALUES:,}")


def _text(value: Any) -> str:
    """Return a value of a Parquet file as text, a number in full."""
    if isinstance(value, float | int):
        return format(Decimal(value), "f")
    return str(value)


def _columns_of_csv(option: str, path: Path) -> list[tuple[str, tuple[str, ...]]]:
    """Return the columns of a CSV file: a name, which may be a value, and the values below it.

    The separator is a semicolon or a tab if the first line has one, else a comma. A first column
    without a name is the index of a data frame, and is left out.
    """
    with _readable(option, path), regular(path, option, _MAX_BYTES, "a CSV file") as stream:
        decoded = io.TextIOWrapper(stream, "utf-8-sig", newline="")
        first = decoded.readline()
        separator = next((mark for mark in ";\t" if mark in first), ",")
        rows = csv.reader(chain([first], decoded), delimiter=separator)
        lines: list[list[str]] = []
        for cells in filter(any, rows):
            if lines and len(cells) != len(lines[0]):
                got = Described(f"{counted(len(cells), 'value')} in line {rows.line_num} of {path}")
                raise InputError(option, got, f"{len(lines[0])}, as in the first line")
            lines.append(cells)
            if len(lines) > MAX_VALUES + 1:
                break
    if not 0 < len(lines) <= MAX_VALUES + 1:
        raise InputError(option, str(path), f"a CSV file of 1 to {MAX_VALUES:,} rows")

    names, *below = lines

    is_indexed = len(names) > 1 and not names[0].strip()
    columns = []
    for column, name in enumerate(names):
        if column == 0 and is_indexed:
            continue
        texts = [line[column] for line in below]
        if separator != ",":
            texts = [_with_point(option, text) for text in texts]
        columns.append((full_name(name), tuple(text.strip() for text in texts)))
    return columns


def _with_point(option: str, cell: str) -> str:
    """Return a value with a point for its decimal comma.

    Raises:
        InputError: its comma may separate thousands.
    """
    number = cell.strip()
    if _GROUPED.fullmatch(number):
        advice = "Does the comma separate thousands?"
        raise InputError(option, cell, "a point as the decimal mark", advice)
    if _DECIMAL_COMMA.fullmatch(number):
        return cell.replace(",", ".")
    return cell


def _column_of_csv(path: Path, key: str) -> tuple[str, ...]:
    """Return the values of one field from a CSV file: the column of its name, or the only column.

    A file of a single column may have no name above it: then its first line is a value.

    Raises:
        InputError: it cannot be read, or there is no such column.
    """
    columns = _columns_of_csv("--over", path)
    for name, values in columns:
        if name == key:
            return values
    if len(columns) > 1:
        advice = f"It has {', '.join(dict(columns))}."
        raise InputError("--over", f"{key}=@{path}", f"a column {key}", advice)
    ((first, below),) = columns
    return (first, *below)


@contextmanager
def _readable(option: str, path: Path) -> Iterator[None]:
    """Have a file that cannot be read raise InputError."""
    try:
        with usable(option, path, "a readable file"):
            yield
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(option, str(path), "a CSV file in UTF-8", f"{error}.") from None
