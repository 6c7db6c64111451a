"""The axes of a sweep: `--over` words as exact values, and the values of any row without the others in memory."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError
from ..numbers.double_double import DoubleDouble
from ..numbers.precision import with_decimal_point
from ..scenes.scene import Reading, checked_value
from .lists import column_of_csv
from .values import TEXTS, check_key, numbers_of

MOST_ROWS = 10**12
FORMS = "START:STOP:STEP, or values V1,V2,…, or @FILE.csv"
_DOUBLES = 2**53, 22  # integers, and powers of ten, up to these are doubles


class Axis(ABC):
    """The values of one field: `key` is its name, `word` what was typed after it, `len` the number of values."""

    key: str
    word: str

    @abstractmethod
    def __len__(self) -> int: ...

    @abstractmethod
    def text(self, index: int) -> str:
        """Return a value as a decimal number, exactly."""

    @abstractmethod
    def numbers(self, indices: Any, reading: Reading) -> DoubleDouble:
        """Return values, shape (indices,), as the scene reads them."""

    @abstractmethod
    def ends(self) -> Iterable[int]:
        """Return the indices of values of which all are right if these are."""


@dataclass(frozen=True)
class Range(Axis):
    """START:STOP:STEP, both ends in: (first + index step)/10**decimals."""

    key: str
    word: str
    first: int
    step: int
    count: int
    decimals: int

    @classmethod
    def of(cls, key: str, word: str) -> Range:
        """Read START:STOP:STEP.

        Raises:
            InputError: no three numbers, no step, or no value.
        """
        parts = word.split(":")
        if len(parts) != 3:
            raise InputError("--over", f"{key}={word}", f"{key}={FORMS}")
        start, stop, step = (_exactly(key, part.strip()) for part in parts)
        if step == 0 or (stop - start) / step < 0:
            raise InputError("--over", f"{key}={word}", "a STEP that leads from START to STOP")
        decimals = max(_decimals(value) for value in (start, stop, step))
        count = (stop - start) // step + 1
        if count > MOST_ROWS:
            raise InputError("--over", f"{key}={word}", f"at most {MOST_ROWS:.0e} values")
        return cls(key, word, int(start * 10**decimals), int(step * 10**decimals), int(count), decimals)

    def __len__(self) -> int:
        return self.count

    def text(self, index: int) -> str:
        """Return a value, exactly."""
        text = with_decimal_point(self.first + index * self.step, self.decimals)
        return text.rstrip("0").rstrip(".") if self.decimals else text

    def numbers(self, indices: Any, reading: Reading) -> DoubleDouble:
        """Return values."""
        largest = max(abs(self.first), abs(self.first + self.count * self.step))
        if largest >= _DOUBLES[0] or self.decimals > _DOUBLES[1]:
            return numbers_of([self.text(int(index)) for index in indices], reading)
        whole = (self.first + np.asarray(indices, np.int64) * self.step).astype(np.float64)
        value = DoubleDouble(whole, np.zeros(len(whole))) / 10.0**self.decimals
        return DoubleDouble(value.high, np.zeros(len(whole))) if reading == "binary64" else value

    def ends(self) -> Iterable[int]:
        """Return the first and the last, between which the others lie, and the one next to zero."""
        near = -self.first // self.step
        return sorted({0, self.count - 1, *(i for i in (near, near + 1) if 0 <= i < self.count)})


@dataclass(frozen=True)
class Values(Axis):
    """Values one by one."""

    key: str
    word: str
    values: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.values)

    def text(self, index: int) -> str:
        """Return a value as it was written."""
        return self.values[index]

    def numbers(self, indices: Any, reading: Reading) -> DoubleDouble:
        """Return values."""
        return numbers_of([self.values[int(index)] for index in indices], reading)

    def ends(self) -> Iterable[int]:
        """Return all indices."""
        return range(len(self.values))


def axis(word: str, reading: Reading) -> Axis:
    """Read one `--over` word, KEY=…, and check its values.

    Raises:
        InputError: unknown field, or a wrong value: field, got, expected.
    """
    key, sign, spec = (part.strip() for part in word.partition("="))
    if not sign or not spec:
        raise InputError("--over", word, f"KEY={FORMS}")
    check_key("--over", key)
    made: Axis
    if spec.startswith("@"):
        made = Values(key, spec, tuple(column_of_csv(Path(spec[1:]), key)))
    elif ":" in spec:
        made = Range.of(key, spec)
    else:
        made = Values(key, spec, tuple(part.strip() for part in spec.split(",")))
    seen = set()
    for index in made.ends():
        text = made.text(index)
        checked_value(key, text, reading)
        if isinstance(made, Values) and text in seen:
            raise InputError("--over", word, "each value once", f"{text} stands there twice.")
        seen.add(text)
    return made


@dataclass(frozen=True)
class Grid:
    """All combinations of the values of axes, the last axis fastest."""

    axes: tuple[Axis, ...]

    def __post_init__(self) -> None:
        keys = [axis.key for axis in self.axes]
        for key in keys:
            if keys.count(key) > 1:
                raise InputError("--over", key, "each field once")
        if self.count > MOST_ROWS:
            raise InputError("--over", f"{self.count} rows", f"at most {MOST_ROWS:.0e} rows")

    @property
    def listed(self) -> dict[str, tuple[str, ...]]:
        """The values of the axes that come from a file."""
        return {one.key: one.values for one in self.axes if isinstance(one, Values) and one.word.startswith("@")}

    @property
    def keys(self) -> tuple[str, ...]:
        """The fields that are varied."""
        return tuple(axis.key for axis in self.axes)

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """The numbers of values of the axes."""
        return tuple(len(axis) for axis in self.axes)

    @property
    def count(self) -> int:
        """The number of rows."""
        count = 1
        for length in self.shape:
            count *= length
        return count

    def texts(self, row: int) -> dict[str, str]:
        """Return the values of a row by field, as exact decimals."""
        return {axis.key: axis.text(index) for axis, (index,) in zip(self.axes, self._indices([row]), strict=True)}

    def numbers(self, rows: Any, reading: Reading) -> dict[str, DoubleDouble]:
        """Return the numbers of rows by field, those that are not words."""
        found = {}
        for axis, indices in zip(self.axes, self._indices(rows), strict=True):
            if axis.key not in TEXTS:
                different, place = np.unique(indices, return_inverse=True)
                numbers = axis.numbers(different, reading)
                found[axis.key] = DoubleDouble(numbers.high[place], numbers.low[place])
        return found

    def wrong(self, rows: Any, reading: Reading) -> dict[int, str]:
        """Return nothing: the values were checked when the axes were read."""
        return {}

    def words(self, rows: Any) -> dict[str, list[str]]:
        """Return the values of rows by field, those that are words."""
        both = zip(self.axes, self._indices(rows), strict=True)
        return {axis.key: [axis.text(int(i)) for i in indices] for axis, indices in both if axis.key in TEXTS}

    def _indices(self, rows: Any) -> Iterator[Any]:
        """Return, for each axis, the indices of the values of rows."""
        rest = np.asarray(rows, np.int64)
        indices = []
        for length in reversed(self.shape):
            rest, index = np.divmod(rest, length)
            indices.append(index)
        return reversed(indices)


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
