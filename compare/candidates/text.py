"""Read a candidate from text: rows of numbers under a header that names the columns, or the output of foucPend.

- A line names the columns in any order: t, x, y and any of z, vx, vy, vz, in these words or others; see `header.py`.
- Without such a line three columns are t, x, y, four are t, x, y, z.
- foucPend (Mathar, appendix B): no header; t x y z X Y Z φ λ speed separated by white space, of which the first
  four are read; `# P n t f` names a transit.
"""

from __future__ import annotations

from typing import BinaryIO

import numpy as np

from reference import InputError

from .candidate import COLUMNS, Candidate, checked_transits
from .column_reader import ColumnReader
from .layout import Naming


def read_text(stream: BinaryIO, head: bytes, name: str, naming: Naming) -> Candidate:
    """Read a candidate from a stream of bytes, of which `head` has been read already.

    Raises:
        InputError: the text cannot be read; the message names the line.
    """
    transits: list[float] = []

    def read_transit(comment: str, line: int) -> None:
        words = comment.split()
        if words and words[0] == "P":
            try:
                transits.append(float(words[2]))
            except (IndexError, ValueError):
                expected = "# P, a count, a time in s, a frequency"
                raise InputError(f"{name}: line {line}", f"# {comment[:80]}", expected) from None

    expected = "a CSV file, foucPend's output, .npy or .npz"
    reader = ColumnReader(name, ("t", "x", "y"), COLUMNS[2:], naming, expected, read_transit)
    columns, low = reader.columns(stream, head)
    times = checked_transits(np.array(transits), f"{name}: # P") if transits else None
    notes = ("the last line does not end with a newline: it may be cut off",) if reader.cut_off else ()
    conventions = reader.conventions
    return Candidate.of(name, columns.pop("t"), columns, low=low, transits=times, notes=notes, conventions=conventions)
