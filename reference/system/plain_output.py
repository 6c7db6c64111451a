"""Plain text on stdout and stderr: control characters in all that is printed are written out, and never obeyed."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, TextIO, cast

from ..errors import plain_lines


class PlainStream(io.TextIOBase):
    """A stream of text that writes control characters out, and characters that its encoding lacks."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    @property
    def encoding(self) -> str:  # type: ignore[override]  # the base class declares a variable
        """UTF-8: every text can be written."""
        return "utf-8"

    def write(self, text: str) -> int:
        """Write a text, and return its length."""
        encoding = self._stream.encoding or "utf-8"
        self._stream.write(plain_lines(text).encode(encoding, "backslashreplace").decode(encoding))
        return len(text)

    def flush(self) -> None:
        """Flush the stream."""
        self._stream.flush()

    def isatty(self) -> bool:
        """Return whether the stream is a terminal."""
        return self._stream.isatty()

    def fileno(self) -> int:
        """Return the descriptor of the stream's file."""
        return self._stream.fileno()

    def writable(self) -> bool:
        """Return True."""
        return True


@contextmanager
def plain_output() -> Iterator[None]:
    """Write control characters out, in all that this process prints on stdout and stderr."""
    before = {name: getattr(sys, name) for name in ("stdout", "stderr")}
    during = {name: PlainStream(stream) for name, stream in before.items()}
    for name, stream in during.items():
        setattr(sys, name, stream)
    try:
        yield
    finally:
        for name, stream in during.items():
            if getattr(sys, name) is stream:  # a command line puts another in place when its reader has gone
                setattr(sys, name, before[name])


def terminal_of(stream: TextIO) -> TextIO:
    """Return the stream behind a `PlainStream`, for those who write their own escape sequences, such as bars."""
    return cast("TextIO", getattr(stream, "_stream", stream))
