"""Large integers as words of 60 bits, to send through a pipe and to hand to FLINT: cheaper than Python's integers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

WORD_BITS = 60  # of a word: it fits an int64, and FLINT holds it without allocating memory


class Words(Sequence[list[int]]):
    """Rows of integers; every word is in [0, 2**60), but the highest carries the sign.

    Attributes:
        table: shape (rows, words, length of a row), lowest word first.
    """

    def __init__(self, table: npt.NDArray[np.int64]) -> None:
        self.table = table

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.table)

    def __getitem__(self, row: Any) -> Any:
        """Return the integers of a row."""
        *low, high = self.table[row].astype(object)
        for word in reversed(low):
            high = (high << WORD_BITS) + word
        return high.tolist()
