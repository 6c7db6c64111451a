"""The position error: the distance between two trajectories row by row, without cancellation in any number type."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from reference.numbers.precision import Array

Column: TypeAlias = Array | Sequence[Fraction]  # doubles, or exact numbers


def difference(one: Column, other: Column, low: Array | float = 0.0) -> Array:
    """Return one - other as doubles, shape (rows,), of two columns that may agree to nearly all their digits.

    Args:
        one: doubles, or exact numbers; exact numbers are subtracted exactly, and so are doubles from them.
        other: as `one`.
        low: the low parts of `one` minus those of `other`, where doubles have any.
    """
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.asarray(one - other + low)  # the difference of doubles that agree so far is exact
    return np.array([float(Fraction(p) - Fraction(q)) for p, q in zip(one, other, strict=True)])


def distance(components: Iterable[Array]) -> Array:
    """Return the lengths of vectors by their components, shape (rows,)."""
    return np.asarray(np.sqrt(sum(part**2 for part in components)))
