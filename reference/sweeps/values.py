"""The fields that a sweep can vary, and rows of exact values of them: `Table`, of which there are two kinds."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import MAX_EMAX, MAX_PREC, MIN_EMIN, Context, Decimal
from typing import Any

import numpy as np

from ..errors import unknown
from ..numbers.double_double import DoubleDouble
from ..scenes.scene import Reading, field_names

TEXTS = ("inputs", "site.gravity_is")  # the fields that can be varied and are not numbers
_FIXED = ("id", "title", "source", "flags", "run.grid_step", "run.digits", "run.level", "run.transits")
_EXACT = Context(prec=MAX_PREC, Emax=MAX_EMAX, Emin=MIN_EMIN)


@dataclass(frozen=True)
class Table(ABC):
    """Rows of exact values.

    Attributes:
        values: of each field that is varied its values as text.
    """

    values: dict[str, tuple[str, ...]]

    @property
    @abstractmethod
    def shape(self) -> tuple[int, ...]:
        """The shape of a column as an array."""

    @abstractmethod
    def places(self, rows: Any) -> Sequence[Any]:
        """Return, for each field, where among its values those of rows stand."""

    @property
    def keys(self) -> tuple[str, ...]:
        """The fields that are varied."""
        return tuple(self.values)

    @property
    def count(self) -> int:
        """The number of rows."""
        return math.prod(self.shape)

    def texts(self, row: int) -> dict[str, str]:
        """Return the values of a row by field."""
        return {key: texts[place] for key, texts, (place,) in self._placed([row])}

    def numbers(self, rows: Any, reading: Reading) -> dict[str, DoubleDouble]:
        """Return the numbers of rows by field; only where nothing is wrong with them."""
        found = {}
        for key, texts, places in self._placed(rows):
            if key not in TEXTS:
                different, back = np.unique(places, return_inverse=True)
                numbers = numbers_of([texts[place] for place in different], reading)
                found[key] = DoubleDouble(numbers.high[back], numbers.low[back])
        return found

    def words(self, rows: Any) -> dict[str, list[str]]:
        """Return the values of rows by field, those that are words."""
        return {key: [texts[place] for place in places] for key, texts, places in self._placed(rows) if key in TEXTS}

    def _placed(self, rows: Any) -> Iterator[tuple[str, tuple[str, ...], Any]]:
        """Yield each field, its values, and where among them those of rows stand."""
        return zip(self.values, self.values.values(), self.places(rows), strict=True)


def varied_names() -> list[str]:
    """Return the names of the fields that a sweep can vary."""
    return [name for name in field_names() if name not in _FIXED]


def check_key(option: str, key: str) -> None:
    """Refuse what is no field of a scene, or none that a sweep can vary.

    Raises:
        InputError: it is not.
    """
    if key not in varied_names():
        raise unknown(option, key, "a field that a sweep can vary", varied_names(), "`foucault show SCENE` lists them.")


def numbers_of(texts: Sequence[str], reading: Reading) -> DoubleDouble:
    """Return decimal numbers, shape (texts,), as a scene with this reading takes them."""
    high = [float(text) for text in texts]
    if reading == "binary64":
        low = [0.0] * len(high)
    else:
        both = zip(texts, high, strict=True)
        low = [float(_EXACT.subtract(Decimal(text), Decimal(h))) if math.isfinite(h) else 0.0 for text, h in both]
    return DoubleDouble(np.array(high), np.array(low))
