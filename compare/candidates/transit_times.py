"""Read a candidate's transit times from a CSV file (--transits): only the column t is needed."""

from __future__ import annotations

import contextlib
import sys
from pathlib import Path

import numpy as np

from reference import InputError
from reference.precision import Array

from .lines import chunks, is_number

MAX_TRANSITS = 2_000_000


def read_transits(source: str | Path) -> Array:
    """Read times of xdot = 0 in s from a CSV file with a column t, or from standard input if `source` is "-".

    Raises:
        InputError: the file cannot be read; the message names the line.
    """
    name = "standard input" if str(source) == "-" else str(source)
    times: list[float] = []
    index: int | None = None
    line = 0
    try:
        with contextlib.ExitStack() as stack:
            stream = sys.stdin.buffer if str(source) == "-" else stack.enter_context(Path(source).open("rb"))
            for lines, _ in chunks(stream, name):
                for text in lines:
                    line += 1
                    if not text.strip() or text.startswith("#"):
                        continue
                    if index is None:
                        index = _index(text, name)
                        continue
                    times.append(_time(text, index, f"{name}: line {line}"))
                if len(times) > MAX_TRANSITS:
                    raise InputError(name, f"more than {MAX_TRANSITS} transits", f"at most {MAX_TRANSITS}")
    except OSError as error:
        raise InputError("--transits", str(source), "a readable CSV file", f"{error.strerror}.") from None
    if index is None:
        raise InputError(f"{name}: header", "nothing", "a column t", "The first line names the columns.")
    return checked_transits(np.array(times), name)


def _index(text: str, name: str) -> int:
    """Return the position of the column t in the header."""
    words = [word.strip().strip('"').lower() for word in text.removeprefix("\ufeff").split(",")]
    if words.count("t") != 1:
        raise InputError(f"{name}: header", text.strip()[:80], "one column t", "The first line names the columns.")
    return words.index("t")


def _time(text: str, index: int, field: str) -> float:
    fields = text.split(",")
    if len(fields) <= index or not is_number(fields[index]):
        raise InputError(field, text.strip()[:80], "a number in the column t")
    return float(fields[index])


def checked_transits(times: Array, name: str) -> Array:
    """Check transit times and return them as doubles.

    Raises:
        InputError: they are not one-dimensional, not finite, negative, or do not increase.
    """
    if times.ndim != 1:
        raise InputError(name, f"shape {times.shape}", "one-dimensional times in s")
    if not np.isfinite(times).all():
        row = int(np.argmin(np.isfinite(times)))
        raise InputError(name, f"{times[row]} as transit {row + 1}", "finite times in s")
    if len(times) and times[0] < 0:
        raise InputError(name, f"{times[0]:.17g} as transit 1", "times from 0 on, in s")
    unordered = np.diff(times) <= 0
    if unordered.any():
        row = int(np.argmax(unordered))
        raise InputError(
            name,
            f"{times[row + 1]:.17g} as transit {row + 2} after {times[row]:.17g}",
            "strictly increasing times in s",
        )
    return np.asarray(times, dtype=np.float64)
