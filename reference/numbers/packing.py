"""Large integers as digits of radix 2^22, to hand on without making them: what limbs are, and what a proof sums."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

DIGIT_BITS = 22


class Digits(Sequence[list[int]]):
    """Rows of integers.

    Attributes:
        table: shape (rows, digits, length of a row), highest digit first; digits may be negative.
    """

    def __init__(self, table: npt.NDArray[np.int32]) -> None:
        self.table = table

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.table)

    def __getitem__(self, row: Any) -> Any:
        """Return the integers of a row."""
        high, *low = self.table[row].astype(object)
        for digit in low:
            high = (high << DIGIT_BITS) + digit
        return high.tolist()
