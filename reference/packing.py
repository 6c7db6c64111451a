"""Rows of large integers in words of 60 bits: made by numbers in digits, taken by FLINT, and cheap to send."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

WORD_BITS = 60  # fits an int64, and is below what FLINT has to allocate for


class Words(Sequence[list[int]]):
    """Rows of integers; a word is in [0, 2**60), but the highest has the sign.

    Attributes:
        table: shape (rows, words, length of a row), lowest word first.
    """

    def __init__(self, table: npt.NDArray[np.int64]) -> None:
        self.table = table

    def __len__(self) -> int:
        """The number of rows."""
        return len(self.table)

    def __getitem__(self, row: Any) -> Any:
        """The integers of a row."""
        *low, high = self.table[row].astype(object)
        for word in reversed(low):
            high = (high << WORD_BITS) + word
        return high.tolist()
