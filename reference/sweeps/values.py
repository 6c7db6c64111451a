"""The fields that a sweep can vary, and their values as numbers."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from ..errors import unknown
from ..numbers.double_double import DoubleDouble
from ..scenes.scene import Reading, field_names

TEXTS = ("inputs", "site.gravity_is")  # the fields that can be varied and are not numbers
_FIXED = ("id", "title", "source", "flags", "run.grid_step", "run.digits", "run.level", "run.transits")


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
    high = np.array([float(text) for text in texts])
    if reading == "binary64":
        return DoubleDouble(high, np.zeros(len(texts)))
    low = [0.0 if np.isinf(h) else float(Fraction(text) - Fraction(h)) for text, h in zip(texts, high, strict=True)]
    return DoubleDouble(high, np.array(low))
