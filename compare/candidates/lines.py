"""Split a stream of bytes into lines of text, chunk by chunk, with limits on bytes, lines and line length."""

from __future__ import annotations

from collections.abc import Iterator
from typing import BinaryIO

from reference import InputError

MAX_BYTES = 1 << 30
MAX_LINE = 1 << 16
MAX_LINES = 4_000_000  # comments and empty lines included
CHUNK = 1 << 22
_BINARY = "Binary data is read from .npz only."


def chunks(stream: BinaryIO, name: str, head: bytes = b"") -> Iterator[tuple[list[str], bool]]:
    """Yield lists of complete lines, each with a flag: whether the last line ended with a newline.

    Args:
        stream: bytes in UTF-8.
        name: the stream's name in messages.
        head: bytes that have been read from it already.

    Raises:
        InputError: there are too many bytes or lines, a line is too long, or the bytes are not text.
    """
    remainder, total, count = head, len(head), 0
    while data := stream.read(CHUNK):
        total += len(data)
        if total > MAX_BYTES:
            raise InputError(name, f"more than {MAX_BYTES} bytes", f"at most {MAX_BYTES}", "Thin the output out.")
        count += data.count(b"\n")
        if count > MAX_LINES:
            raise InputError(name, f"more than {MAX_LINES} lines", f"at most {MAX_LINES}", "Thin the output out.")
        remainder += data
        complete, newline, remainder = remainder.rpartition(b"\n")
        if newline:
            yield _decoded(complete, name), True
        if len(remainder) > MAX_LINE:
            raise InputError(name, f"a line of more than {MAX_LINE} bytes", "lines of numbers", "Is it text?")
    if remainder.strip():
        yield _decoded(remainder, name), False


def _decoded(data: bytes, name: str) -> list[str]:
    if b"\0" in data:
        raise InputError(name, "a zero byte", "text", _BINARY)
    try:
        return data.decode().split("\n")
    except UnicodeDecodeError:
        raise InputError(name, "bytes that are not UTF-8", "text", _BINARY) from None


def is_number(text: str) -> bool:
    """Return True for a number as C and Fortran print it (NaN and inf too), not for forms that only Python reads."""
    if "_" in text or not text.isascii():
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True
