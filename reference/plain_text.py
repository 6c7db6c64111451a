r"""Text for terminals and JSON: control characters written out, NaN and infinity as null.

Titles, file names and the output of programs come from strangers; an escape sequence among them
could rewrite a verdict on the screen. So control characters are written out, as in \\x1b, and never
obeyed: in messages, in documents, and in all that a command prints.
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO, cast

# controls, invisible and direction-changing characters, separators of lines, bytes that are not
# UTF-8 (surrogates), and the last two, which XML forbids
_UNSAFE = (
    r"\x00-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\ud800-\udfff"
    r"\ufffe\uffff\U000e0000-\U000e007f"
)
_CONTROL = re.compile(f"[{_UNSAFE}]")
_CONTROL_BUT_LINES = re.compile(rf"(?![\n\t])[{_UNSAFE}]")


def is_plain(text: str) -> bool:
    """Return whether a text is one line without control characters."""
    return _CONTROL.search(text) is None


def plain(text: str) -> str:
    """Return a text in one line, its control characters written out."""
    return _CONTROL.sub(_written_out, text)


def plain_lines(text: str) -> str:
    """Return a text of several lines, all control characters but newline and tab written out."""
    return _CONTROL_BUT_LINES.sub(_written_out, text)


def plain_json(document: Any) -> str:
    """Return a document as JSON, with its escapes for control characters.

    NaN and infinity, which JSON lacks, are null.
    """
    text = json.dumps(finite(document), indent=1, ensure_ascii=False, allow_nan=False)
    return _CONTROL_BUT_LINES.sub(lambda match: json.dumps(match[0])[1:-1], text)


def finite(value: Any) -> Any:
    """Return a document of dictionaries, lists and values with None for each NaN and infinity."""
    if isinstance(value, dict):
        return {key: finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _written_out(match: re.Match[str]) -> str:
    """Return a control character as an escape sequence of Python."""
    code = ord(match[0])
    if 0xDC80 <= code <= 0xDCFF:  # how Python holds a byte that is not UTF-8
        return f"\\x{code - 0xDC00:02x}"
    return match[0].encode("unicode_escape").decode()


def shortened(text: str, most: int) -> str:
    """Return a text of at most `most` characters, which ends in … if it was longer."""
    return text if len(text) <= most else f"{text[: most - 1]}…"


class PlainStream:
    """A stream of text that writes out control characters, and those that its encoding lacks."""

    encoding = "utf-8"  # every text can be written

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write a text, and return its length."""
        encoding = self._stream.encoding or "utf-8"
        self._stream.write(plain_lines(text).encode(encoding, "backslashreplace").decode(encoding))
        return len(text)

    def writelines(self, texts: Iterable[str]) -> None:
        """Write texts one after the other."""
        for text in texts:
            self.write(text)


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
            # a command line puts another in place when its reader has gone
            if getattr(sys, name) is stream:
                setattr(sys, name, before[name])


def terminal_of(stream: TextIO) -> TextIO:
    """Return the stream behind a `PlainStream`, for bars, which write escape sequences."""
    return cast("TextIO", getattr(stream, "_stream", stream))
