"""Lines of text out of a stream of bytes, chunk by chunk: bounded in bytes and in the length of a line."""

from __future__ import annotations

from collections.abc import Iterator
from typing import BinaryIO

from reference import InputError

MAX_BYTES = 1 << 30
MAX_LINE = 1 << 16
MAX_LINES = 4_000_000  # comments and empty ones included
CHUNK = 1 << 22
_BINARY = "Binary data is read from .npz only."


def chunks(stream: BinaryIO, name: str, head: bytes = b"") -> Iterator[tuple[list[str], bool]]:
    """Lists of whole lines, and whether the last of them ended with a newline.

    Args:
        stream: of bytes in UTF-8.
        name: what messages call it.
        head: bytes that were read from it before.

    Raises:
        InputError: too many bytes or lines, a line without end, or bytes that are not text.
    """
    left, total, count = head, len(head), 0
    while data := stream.read(CHUNK):
        total += len(data)
        if total > MAX_BYTES:
            raise InputError(name, f"more than {MAX_BYTES} bytes", f"at most {MAX_BYTES}", "Thin the output out.")
        count += data.count(b"\n")
        if count > MAX_LINES:
            raise InputError(name, f"more than {MAX_LINES} lines", f"at most {MAX_LINES}", "Thin the output out.")
        left += data
        whole, newline, left = left.rpartition(b"\n")
        if newline:
            yield _decoded(whole, name), True
        if len(left) > MAX_LINE:
            raise InputError(name, f"a line of more than {MAX_LINE} bytes", "lines of numbers", "Is it text?")
    if left.strip():
        yield _decoded(left, name), False


def _decoded(data: bytes, name: str) -> list[str]:
    if b"\0" in data:
        raise InputError(name, "a zero byte", "text", _BINARY)
    try:
        return data.decode().split("\n")
    except UnicodeDecodeError:
        raise InputError(name, "bytes that are not UTF-8", "text", _BINARY) from None


def is_number(text: str) -> bool:
    """True for what C and Fortran print as a number (with NaN and inf), and for nothing that only Python reads."""
    if "_" in text or not text.isascii():
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True
